// height_test.cpp: known surfaces come back from their normals: shapes, sizes, holes, borders,
// convergence.
#include "fit/height/height.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>

#include "surface/base/parallel.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A surface as a function of x, y in pixels from the centre, y up: its height [pixels] and slope.
struct Shape {
    std::function<double(double, double)> height;
    std::function<glm::dvec2(double, double)> slope;
};

struct Sampled {
    Image<Vec3> normal;
    Image<float> confidence, height;  // [1], [pixels] of mean 0
};

Sampled sampled(const Shape& shape, int width, int height) {
    Sampled s{Image<Vec3>(width, height), Image<float>(width, height, 1.0f), Image<float>(width, height)};
    double mean = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double px = x - (width - 1) / 2.0, py = (height - 1) / 2.0 - y;
            const glm::dvec2 slope = shape.slope(px, py);
            s.normal(x, y) = normal_of({static_cast<float>(slope.x), static_cast<float>(slope.y)});
            s.height(x, y) = static_cast<float>(shape.height(px, py));
            mean += shape.height(px, py) / (double(width) * height);
        }
    for (float& z : s.height.pixels()) z -= static_cast<float>(mean);
    return s;
}

struct Deviation {
    double rms = 0, worst = 0;
};

// Of the two from each other, apart from a constant.
Deviation deviation(const Image<float>& a, const Image<float>& b) {
    double mean = 0, square = 0;
    const auto n = static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) mean += (a.pixels()[i] - b.pixels()[i]) / n;
    Deviation d;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double e = a.pixels()[i] - b.pixels()[i] - mean;
        square += e * e / n;
        d.worst = std::max(d.worst, std::abs(e));
    }
    d.rms = std::sqrt(square);
    return d;
}

// A cap of a sphere of radius R plus sines of wavelength 40 pixels.
Shape cap_and_sines() {
    constexpr double R = 400, amplitude = 2, k = 2 * std::numbers::pi / 40;
    return {[=](double x, double y) {
                return std::sqrt(R * R - x * x - y * y) + amplitude * std::sin(k * x) * std::cos(0.7 * k * y);
            },
            [=](double x, double y) {
                const double z = std::sqrt(R * R - x * x - y * y);
                return glm::dvec2(-x / z + amplitude * k * std::cos(k * x) * std::cos(0.7 * k * y),
                                  -y / z - amplitude * 0.7 * k * std::sin(k * x) * std::sin(0.7 * k * y));
            }};
}

Shape ramp() {
    return {[](double x, double y) { return 0.3 * x - 0.2 * y; },
            [](double, double) { return glm::dvec2(0.3, -0.2); }};
}

// As high on one side as it is not on the other; no period fits it.
Shape paraboloid() {
    return {[](double x, double y) { return 1e-3 * (x * x + 0.5 * y * y + x * y) + 0.1 * x; },
            [](double x, double y) { return glm::dvec2(1e-3 * (2 * x + y) + 0.1, 1e-3 * (y + x)); }};
}

Image<float> integrated(const Sampled& s, double mm_per_pixel = 1, HeightReport* report = nullptr,
                        const HeightOptions& options = {}) {
    Image<float> height;
    const HeightReport r = integrate_normals({s.normal, s.confidence, mm_per_pixel}, height, options);
    if (report) *report = r;
    return height;
}

TEST(Height, RecoversASphereCapWithSines) {
    const Sampled s = sampled(cap_and_sines(), 300, 220);
    HeightReport report;
    const Deviation d = deviation(integrated(s, 1, &report), s.height);
    std::cout << fmt::format("300 x 220 sphere cap and sines: {:.4f} px rms, {:.4f} px at most, {} cycles\n",
                             d.rms, d.worst, report.cycles);
    EXPECT_TRUE(report.converged);
    // The trapezoid rule is off by z'''' / 12 a step's slope: it scales sines by 1 - (k h)^2 / 12, which is
    // 0.2 % of their amplitude 2; half of that in rms, the slower cap less. Solver and floats may take as
    // much again.
    EXPECT_LT(d.rms, 0.01);
    EXPECT_LT(d.worst, 0.03);
}

// Differences of quadratics are the means of their slopes exactly; what is left is the solver's residual of
// 1e-5.
TEST(Height, RampsAndParaboloidsComeBackUpToAConstantWithoutPeriodicity) {
    for (const auto& [width, height] : {std::pair{200, 150}, {127, 255}}) {
        const Sampled tilted = sampled(ramp(), width, height);
        EXPECT_LT(deviation(integrated(tilted), tilted.height).worst, 1e-3) << width;
        const Sampled bowl = sampled(paraboloid(), width, height);
        const Deviation d = deviation(integrated(bowl), bowl.height);
        std::cout << fmt::format("{} x {} paraboloid: {:.5f} px rms, {:.5f} px at most of {:.1f} px\n", width,
                                 height, d.rms, d.worst,
                                 deviation(bowl.height, Image<float>(width, height)).worst);
        EXPECT_LT(d.worst, 5e-3) << width;
    }
}

TEST(Height, WorksForPicturesOfAnySize) {
    for (const auto& [width, height] : {std::pair{1, 1},
                                        {2, 2},
                                        {1, 2},
                                        {2, 1},
                                        {3, 3},
                                        {1, 37},
                                        {64, 1},
                                        {5, 2},
                                        {33, 17},
                                        {129, 3},
                                        {101, 97}}) {
        const Sampled s = sampled(paraboloid(), width, height);
        HeightReport report;
        const Image<float> z = integrated(s, 1, &report);
        EXPECT_TRUE(report.converged) << width << " x " << height;
        // Rounding of floats walks at random along a strip: 129 steps of heights around 12 come to 2e-3.
        EXPECT_TRUE(images_near(z, s.height, 3e-3)) << width << " x " << height;
    }
}

TEST(Height, HasAMeanOfZero) {
    const Image<float> z = integrated(sampled(cap_and_sines(), 90, 71));
    double mean = 0;
    for (const float value : z.pixels()) mean += value / static_cast<double>(z.size());
    EXPECT_NEAR(mean, 0, 1e-4);
}

TEST(Height, BridgesHolesOfNoConfidence) {
    const Sampled whole = sampled(paraboloid(), 160, 120);
    Sampled holed = whole;
    for (int y = 40; y < 70; ++y)
        for (int x = 50; x < 90; ++x) {
            holed.confidence(x, y) = 0;
            holed.normal(x, y) = normal_of({3, -2});  // nonsense
        }
    HeightReport report;
    const Image<float> z = integrated(holed, 1, &report);
    EXPECT_TRUE(report.converged);
    // Outside the hole: nonsense of slope 3 over 40 pixels, weighing 1e-3, moves its rim by some 1e-3 * 3 *
    // 40 px.
    double worst = 0, mean = 0;
    int count = 0;
    const auto outside = [](int x, int y) { return y < 40 || y >= 70 || x < 50 || x >= 90; };
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x)
            if (outside(x, y)) {
                mean += z(x, y) - whole.height(x, y);
                ++count;
            }
    mean /= count;
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x)
            if (outside(x, y)) worst = std::max(worst, std::abs(z(x, y) - whole.height(x, y) - mean));
    std::cout << fmt::format("outside a hole of 40 x 30 px full of nonsense: {:.3f} px at most\n", worst);
    EXPECT_LT(worst, 0.12);
    // Two halves that only unmeasured pixels connect keep their shapes, and stay finite.
    Sampled split = whole;
    for (int y = 0; y < 120; ++y)
        for (int x = 78; x < 82; ++x) {
            split.confidence(x, y) = 0;
            split.normal(x, y) = Vec3(0, 0, 1);
        }
    const Image<float> halves = integrated(split);
    EXPECT_NEAR(halves(10, 10) - halves(60, 100), whole.height(10, 10) - whole.height(60, 100), 0.05);
    EXPECT_NEAR(halves(100, 10) - halves(150, 100), whole.height(100, 10) - whole.height(150, 100), 0.05);
}

TEST(Height, IsFlatWhereNothingWasMeasured) {
    const Sampled nothing{Image<Vec3>(20, 20, Vec3(0, 0, 1)), Image<float>(20, 20), {}};
    EXPECT_TRUE(images_near(integrated(nothing), Image<float>(20, 20), 0));
}

TEST(Height, ScalesWithTheSizeOfAPixel) {
    const Sampled s = sampled(cap_and_sines(), 80, 60);
    Image<float> expected = integrated(s, 1);
    for (float& z : expected.pixels()) z *= 0.25f;
    EXPECT_TRUE(
        images_near(integrated(s, 0.25), expected, 0));  // 0.25 is a power of two: not even rounding differs
}

TEST(Height, DoesNotDependOnTheNumberOfThreads) {
    const Sampled s = sampled(cap_and_sines(), 301, 203);
    set_thread_count(1);
    const Image<float> one = integrated(s);
    set_thread_count(2);
    const Image<float> two = integrated(s);
    set_thread_count(0);
    EXPECT_TRUE(images_identical(one, two));
}

TEST(Height, MirroredNormalsGiveTheMirroredHeight) {
    for (const auto& [width, height] : {std::pair{201, 131}, {200, 130}}) {
        const Sampled s = sampled(paraboloid(), width, height);
        const Image<float> z = integrated(s);
        Sampled flipped = s;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const Vec3& n = s.normal(width - 1 - x, y);
                flipped.normal(x, y) = Vec3(-n.x, n.y, n.z);
            }
        const Image<float> mirrored = integrated(flipped);
        Image<float> expected(width, height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) expected(x, y) = z(width - 1 - x, y);
        // Grids halve from the left, so only solutions agree: within twice the error of one (see the
        // paraboloid's).
        EXPECT_TRUE(images_near(mirrored, expected, 1e-2)) << width;
    }
}

TEST(Height, ConvergesInAFewCyclesAtTheSizeOfAPhotograph) {
    const Sampled s = sampled({[](double x, double y) { return std::sin(x / 20) * std::cos(y / 31) * 5; },
                               [](double x, double y) {
                                   return glm::dvec2(std::cos(x / 20) * std::cos(y / 31) / 4,
                                                     -std::sin(x / 20) * std::sin(y / 31) * 5 / 31);
                               }},
                              1000, 700);
    HeightReport report;
    const Deviation d = deviation(integrated(s, 1, &report), s.height);
    std::cout << fmt::format("1000 x 700: {} cycles, residual {:.1e}, {:.4f} px rms\n", report.cycles,
                             report.residual, d.rms);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.cycles, 12);
    EXPECT_LT(d.rms, 0.02);
}

// Patches of 1 and 1e-3 side by side, as confident paint between losses.
Sampled patchy(int width, int height, int patch) {
    Sampled s = sampled(cap_and_sines(), width, height);
    Random random(31);
    const int columns = width / patch + 1;
    std::vector<float> level(static_cast<std::size_t>(columns * (height / patch + 1)));
    for (float& value : level) value = random.uniform() < 0.5 ? 1.0f : 1e-3f;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            s.confidence(x, y) = level[static_cast<std::size_t>(y / patch * columns + x / patch)];
    return s;
}

// Short waves make weights uneven, and a bulge over the whole picture has to come right all the same.
TP_LONG TEST(Height, LongWavesComeRightBesideShortOnes) {
    constexpr int width = 3060, height = 2290;
    constexpr double k = 2 * std::numbers::pi / 12, bulge = 0.05 / width;
    const Sampled s =
        sampled({[](double x, double y) {
                     return 0.5 * std::sin(k * x) * std::cos(0.6 * k * y) - bulge * (x * x + y * y);
                 },
                 [](double x, double y) {
                     return glm::dvec2(0.5 * k * std::cos(k * x) * std::cos(0.6 * k * y) - 2 * bulge * x,
                                       -0.3 * k * std::sin(k * x) * std::sin(0.6 * k * y) - 2 * bulge * y);
                 }},
                width, height);
    HeightReport report;
    const Deviation d = deviation(integrated(s, 1, &report), s.height);
    std::cout << fmt::format("{} x {}: {} cycles, {:.4f} px rms\n", width, height, report.cycles, d.rms);
    EXPECT_TRUE(report.converged);
    EXPECT_LT(d.rms, 0.02);
}

TEST(Height, ConvergesWhereConfidenceVariesAThousandfold) {
    for (const int patch : {7, 32}) {
        const Sampled s = patchy(400, 300, patch);
        HeightReport report;
        const Deviation d = deviation(integrated(s, 1, &report), s.height);
        std::cout << fmt::format(
            "400 x 300, confidence 1 and 1e-3 in patches of {} px: {} cycles, residual {:.1e}, "
            "converged {}, {:.4f} px rms\n",
            patch, report.cycles, report.residual, report.converged, d.rms);
        // Small patches are the hardest case: the last digits of the residual come slowly, and the report
        // says so.
        EXPECT_TRUE(report.converged || patch == 7) << patch;
        EXPECT_LT(report.residual, 1e-3) << patch;
        EXPECT_LT(d.rms, 0.05) << patch;
    }
}

TEST(Height, StopsAtItsLimitAndSaysThatItHasNotConverged) {
    HeightReport report;
    integrated(sampled(cap_and_sines(), 200, 150), 1, &report, {.max_cycles = 1, .tolerance = 1e-9});
    EXPECT_EQ(report.cycles, 1);
    EXPECT_FALSE(report.converged);
    EXPECT_GT(report.residual, 1e-9);
}

TEST(Height, StopsWhenAsked) {
    const Sampled s = sampled(cap_and_sines(), 64, 64);
    Image<float> height;
    EXPECT_THROW(integrate_normals({s.normal, s.confidence, 1}, height, {},
                                   [](std::string_view, double) { return false; }),
                 Cancelled);
}

}  // namespace
}  // namespace tangi
