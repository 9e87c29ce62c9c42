// shadow_carving_test.cpp: shadows in photographs say how high a wall is that no slope shows.
#include "fit/shadows/shadow_carving.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/base/parallel.h"
#include "tests/support/fit/fit_test_support.h"

namespace tangi {
namespace {

constexpr int kColumns = 90, kRows = 200;
constexpr double kRadiusDeg = 0.25;
const WardPrior kPrior;

// Flat and matt, whatever the height.
Surface flat(int rows = kRows) {
    Surface s(kColumns, rows);
    s.mm_per_pixel = 0.5;
    std::fill(s.normal.pixels().begin(), s.normal.pixels().end(), Vec3(0, 0, 1));
    std::fill(s.diffuse.pixels().begin(), s.diffuse.pixels().end(), Rgb(0.5f));
    std::fill(s.confidence.pixels().begin(), s.confidence.pixels().end(), 0.9f);
    std::fill(s.height_mm.pixels().begin(), s.height_mm.pixels().end(), 0.0f);
    return s;
}

// A flake in the middle, this thick; its edges are between pixels.
Image<float> flake(float mm, int rows = kRows) {
    Image<float> z(kColumns, rows);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < kColumns; ++x)
            z(x, y) = std::abs(x - kColumns / 2) < 15 && std::abs(y - rows / 2) < rows / 5 ? mm : 0.0f;
    return z;
}

std::vector<float> values(const Image<float>& image) {
    return {image.pixels().begin(), image.pixels().end()};
}

Lighting lights(int around, std::initializer_list<double> elevations_deg) {
    Lighting lighting;
    for (const double elevation : elevations_deg)
        for (int i = 0; i < around; ++i) {
            const double azimuth = (i + 0.3) * 2 * std::numbers::pi / around, e = elevation * kDegree;
            lighting.lights.push_back(distant_light(
                Vec3(std::cos(azimuth) * std::cos(e), std::sin(azimuth) * std::cos(e), std::sin(e))));
        }
    return lighting;
}

// A batch of pixels from (x0, y) on, as photographs of a matt surface with this height, of which the picture
// shows what is right of `left`.
WardBatch photographed(const Surface& s, const CastShadows& shadows, const Lighting& lighting, int x0, int y,
                       int count, int left = 0) {
    WardBatch batch;
    batch.resize(static_cast<int>(lighting.lights.size()), 3, kPrior);
    PixelSamples samples;
    for (int lane = 0; lane < count; ++lane) {
        const int x = x0 + lane;
        illuminate(lighting, s.point_mm(x, y), 3, samples);
        for (std::size_t at = 0; at < samples.value.size(); ++at) {
            const auto c = static_cast<int>(at % 3);
            const Vec3 l(samples.light[at / 3]);
            samples.value[at] =
                samples.irradiance[at] *
                static_cast<double>(s.diffuse(x, y)[c] * std::max(glm::dot(s.normal(x, y), l), 0.0f) *
                                    shadows.visible_part(left + x, y, l));
            samples.sigma[at] = 0.005;
        }
        batch.set(lane, lane, samples);
    }
    return batch;
}

LightVisibility seen(const Surface& s, const Image<float>& height_mm, const Lighting& lighting,
                     int left = 0) {
    LightVisibility result(s.width(), s.height(), static_cast<int>(lighting.lights.size()));
    const CastShadows known(s.height_mm, s.mm_per_pixel, kRadiusDeg),
        true_ones(height_mm, s.mm_per_pixel, kRadiusDeg);
    for (int y = 0; y < s.height(); ++y)
        for (int x0 = 0; x0 < s.width(); x0 += kWardLanes) {
            const int count = std::min(kWardLanes, s.width() - x0);
            result.look(photographed(s, true_ones, lighting, x0, y, count, left), s, known, x0, y, count);
        }
    result.find_runs(s, lighting);
    return result;
}

SlopeEdges edges_of(const Surface& s) {
    SlopeEdges edges(s.normal, s.confidence, s.mm_per_pixel, 1e-3);
    edges.weigh(nullptr);
    return edges;
}

// Flat slopes right to its edges are believed as well.
TEST(ShadowCarving, FindsMostOfHowThickAFlakeIs) {
    for (const float mm : {1.0f, 2.0f}) {
        Surface s = flat();
        const Image<float> truth = flake(mm);
        const Lighting lighting = lights(16, {15, 20, 25, 30, 35, 45});
        const CarveReport report = carve_shadows(seen(s, truth, lighting), lighting, edges_of(s), s);
        EXPECT_GT(report.contradicted, 5000);
        EXPECT_LT(report.left, report.contradicted / 2);
        float edge = 0;
        for (int y = kRows / 2 - 30; y <= kRows / 2 + 30; ++y)
            edge += (s.height_mm(kColumns / 2 + 14, y) - s.height_mm(kColumns / 2 + 16, y)) / 61;
        EXPECT_GT(edge, 0.5f * mm);
        EXPECT_LT(edge, mm);
        EXPECT_LT(rms_difference(s.height_mm, truth), 0.8 * rms_difference(flat().height_mm, truth));
    }
}

TEST(ShadowCarving, TakesOffWhatWouldHideLitPixels) {
    Surface s = flat();
    s.height_mm = flake(1);
    const Lighting lighting = lights(16, {15, 25, 35});
    const CarveReport report = carve_shadows(seen(s, flat().height_mm, lighting), lighting, edges_of(s), s);
    EXPECT_GT(report.contradicted, 1000);
    EXPECT_LT(report.left, report.contradicted / 4);
    const float edge = s.height_mm(kColumns / 2 + 14, kRows / 2) - s.height_mm(kColumns / 2 + 15, kRows / 2);
    EXPECT_LT(edge, 0.3f);
}

TEST(ShadowCarving, LeavesWhatShadowsAgreeWith) {
    Surface s = flat();
    s.height_mm = flake(1);
    const Lighting lighting = lights(16, {15, 25, 35});
    const CarveReport report = carve_shadows(seen(s, flake(1), lighting), lighting, edges_of(s), s);
    EXPECT_GT(report.lights, 1000);
    EXPECT_EQ(report.contradicted, 0);
    EXPECT_EQ(values(s.height_mm), values(flake(1)));
}

// The frame of a painting is not in the picture.
TEST(ShadowCarving, LeavesShadowsThatComeFromBeyondTheBorder) {
    Surface s = flat();
    const auto with_wall = [](int column) {
        Image<float> z(kColumns + 3, kRows);
        for (int y = 0; y < kRows; ++y)
            for (int x = 0; x < 3; ++x) z(column + x, y) = 3;
        return z;
    };
    const Lighting lighting = lights(16, {25});
    const LightVisibility shown = seen(s, with_wall(0), lighting, 3);
    const CarveReport report = carve_shadows(shown, lighting, edges_of(s), s);
    EXPECT_LT(report.contradicted, 30);  // at the corners, where rays are between pixels
    // The same wall inside the picture is believed.
    EXPECT_GT(carve_shadows(seen(s, with_wall(20), lighting, 3), lighting, edges_of(s), s).contradicted, 500);
}

TEST(ShadowCarving, IsTheSameOnAnyNumberOfThreads) {
    constexpr int kTall = 900;  // strips of rows enough for all threads
    std::vector<float> heights;
    for (const int threads : {1, 2, 5}) {
        set_thread_count(threads);
        Surface s = flat(kTall);
        const Lighting lighting = lights(8, {20});
        EXPECT_GT(carve_shadows(seen(s, flake(1.5f, kTall), lighting), lighting, edges_of(s), s).contradicted,
                  0);
        if (heights.empty()) heights = values(s.height_mm);
        EXPECT_EQ(values(s.height_mm), heights) << threads;
    }
    set_thread_count(0);
}

TEST(ShadowCarving, MirroredShadowsMakeAMirroredHeight) {
    const Lighting lighting = lights(16, {20, 35});
    Lighting mirrored = lighting;
    for (Light& light : mirrored.lights) light.direction.x = -light.direction.x;
    Surface a = flat(), b = flat();
    carve_shadows(seen(a, flake(1), lighting), lighting, edges_of(a), a);
    Image<float> other = flake(1);
    for (int y = 0; y < kRows; ++y) std::reverse(other.row(y).begin(), other.row(y).end());
    carve_shadows(seen(b, other, mirrored), mirrored, edges_of(b), b);
    for (int y = 0; y < kRows; ++y) std::reverse(b.height_mm.row(y).begin(), b.height_mm.row(y).end());
    EXPECT_LT(rms_difference(a.height_mm, b.height_mm), 0.01 * rms_difference(a.height_mm, flat().height_mm));
}

TEST(ShadowCarving, TinyPicturesStayAsTheyAre) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}}) {
        Surface s(width, height);
        std::fill(s.confidence.pixels().begin(), s.confidence.pixels().end(), 0.9f);
        const Lighting lighting = lights(8, {20});
        const Image<float> fins = [width = width, height = height] {
            Image<float> z(width, height);
            for (int i = 0; i < width * height; i += 3) z.pixels()[static_cast<std::size_t>(i)] = 2;
            return z;
        }();
        EXPECT_EQ(carve_shadows(seen(s, fins, lighting), lighting, edges_of(s), s).contradicted, 0);
    }
}

// One row of pixels, one light: what is remembered of them.
std::vector<SeenLight> looked_at(const Surface& s, WardBatch& batch) {
    LightVisibility result(s.width(), s.height(), batch.photos);
    const CastShadows shadows(s.height_mm, s.mm_per_pixel, kRadiusDeg);
    result.look(batch, s, shadows, 0, 0, kWardLanes);
    const auto row = result.row(0);
    return {row.begin(), row.end()};
}

TEST(LightVisibility, AreHiddenWhereLittleIsLeft) {
    const Surface s = flat();
    const Lighting lighting = lights(1, {30});
    WardBatch batch =
        photographed(s, CastShadows(s.height_mm, s.mm_per_pixel, kRadiusDeg), lighting, 0, 0, kWardLanes);
    // All lit, and nothing near that could hide the light.
    EXPECT_TRUE(looked_at(s, batch).empty());
    const float full = batch.value[0][0];
    for (std::size_t c = 0; c < 3; ++c) {
        batch.value[c][1] = 0.02f * full;
        batch.value[c][2] = 0.5f * full;  // half a light
        batch.value[c][3] = 0.02f * full;
        batch.sigma[c][3] = 0.2f;  // noise
        batch.value[c][4] = std::nanf("");
        batch.sigma[c][4] = 0;
        batch.value[c][5] = 3 * full;     // gloss
        batch.value[c][6] = 0.1f * full;  // clipped: at least that
        batch.sigma[c][6] *= -1;
    }
    const std::vector<SeenLight> shown = looked_at(s, batch);
    ASSERT_EQ(shown.size(), 1u);
    EXPECT_EQ(shown[0].x, 1u);
    EXPECT_EQ(shown[0].photo, 0u);
    EXPECT_FALSE(shown[0].lit);
}

TEST(LightVisibility, AreRememberedLitWhereMoreReliefWouldHideThem) {
    Surface s = flat();
    for (int y = 0; y < kRows; ++y)
        for (int x = 20; x < 25; ++x) s.height_mm(x, y) = 1;
    const Lighting lighting{.lights = {distant_light(Vec3(1, 0, 0.3f))}, .rig = {}};
    const Image<float> none = flat().height_mm;
    WardBatch batch =
        photographed(s, CastShadows(none, s.mm_per_pixel, kRadiusDeg), lighting, 0, 0, kWardLanes);
    const std::vector<SeenLight> shown = looked_at(s, batch);
    ASSERT_FALSE(shown.empty());
    for (const SeenLight& light : shown) {
        EXPECT_TRUE(light.lit);
        // The ridge is 2 pixels high: its shadow ends 7 pixels from it, with a tangent of 0.2 it would at 10.
        EXPECT_GE(light.x, 10u);
    }
    EXPECT_EQ(shown.back().x, 15u);
}

TEST(LightVisibility, SayNothingOfMetalOfUnknownSlopesAndUnderLightsThatGraze) {
    Surface s = flat();
    const Lighting lighting = lights(1, {30});
    WardBatch dark =
        photographed(s, CastShadows(s.height_mm, s.mm_per_pixel, kRadiusDeg), lighting, 0, 0, kWardLanes);
    for (std::size_t c = 0; c < 3; ++c)
        for (int lane = 0; lane < kWardLanes; ++lane) dark.value[c][lane] = 0;
    EXPECT_EQ(looked_at(s, dark).size(), static_cast<std::size_t>(kWardLanes));
    for (int x = 0; x < kWardLanes; ++x) s.confidence(x, 0) = x % 2 == 0 ? 0.0f : 0.9f;
    EXPECT_EQ(looked_at(s, dark).size(), static_cast<std::size_t>(kWardLanes) / 2);
    s = flat();
    for (int x = 0; x < 4; ++x) s.specular(x, 0) = 0.3f;
    EXPECT_EQ(looked_at(s, dark).size(), static_cast<std::size_t>(kWardLanes) - 4);
    s = flat();
    const Vec3 l = lighting.lights[0].direction;
    for (int x = 0; x < kWardLanes; ++x) s.normal(x, 0) = glm::normalize(Vec3(-l.z, 0, l.x) + 0.05f * l);
    EXPECT_TRUE(looked_at(s, dark).empty());
}

}  // namespace
}  // namespace tangi
