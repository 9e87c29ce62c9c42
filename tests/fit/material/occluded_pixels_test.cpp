// occluded_pixels_test.cpp: pixels that few lights reach are part of what is around them; lines of gold and
// of black paint are not.
#include "fit/material/occluded_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "fit/pipeline/fit_painting.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

float brightness(const Rgb& c) { return (c.r + c.g + c.b) / 3; }

// [1] Part of the pixels that are black where the paint is not.
double part_black(const Surface& surface, const PaintingTruth& truth) {
    int black = 0, all = 0;
    for (std::size_t i = 0; i < truth.diffuse.size(); ++i) {
        const float real = brightness(truth.diffuse.pixels()[i]);
        if (!truth.valid.pixels()[i] || real < 0.1f) continue;
        ++all;
        black += brightness(surface.diffuse.pixels()[i]) < 0.15f * real;
    }
    return static_cast<double>(black) / all;
}

FitResult fitted(const TestDir& folder, const PaintingTruth& truth, const GeneratorOptions& generator,
                 const FitOptions& options = {}) {
    write_stack(folder.path(), truth, generator);
    FitOptions all = options;
    all.white_level = generator.white_level;
    all.mm_per_pixel = truth.mm_per_pixel;
    return fit_painting(open_stack(folder.path()), all);
}

// Two lights overhead and 14 low ones: between thick strokes only the former are seen.
TP_LONG TEST(Crevices, AreNoBlackMirrors) {
    for (const Solver solver : {Solver::batch, Solver::ceres}) {
        const PaintingTruth truth = procedural_painting(
            {.seed = 62, .width = 120, .height = 90, .mm_per_pixel = 0.2, .impasto = 1.5});
        const GeneratorOptions generator{.lights = 16, .held_out = 4};
        const TestDir folder;
        FitOptions options;
        options.solver = solver;
        const FitResult fit = fitted(folder, truth, generator, options);
        ASSERT_TRUE(fit.report.refined);
        const double black = part_black(fit.surface, truth),
                     held_out = held_out_psnr_db(fit.surface, folder.path(), generator.transfer);
        std::cout << fmt::format("{}: black {:.4f}, held out {:.2f} dB\n",
                                 solver == Solver::batch ? "batches" : "Ceres", black, held_out);
        EXPECT_LT(black, 0.01);
        EXPECT_GT(held_out, 30);
    }
}

// A trench from whose floor few lights are seen, wider than what neighbours tell of: its floor is the paint
// that the lit photographs show, no black mirror. Without that, a quarter of it is right.
TP_LONG TEST(Crevices, ShowWhatLitPhotographsShow) {
    PaintingTruth truth(60, 20, 0.2);
    const auto is_floor = [](int x) { return x >= 22 && x < 38; };
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < truth.width(); ++x) {
            truth.diffuse(x, y) = Rgb(0.6f, 0.5f, 0.4f);
            truth.specular(x, y) = 0.04f;
            truth.roughness(x, y) = 0.25f;
            if (is_floor(x)) truth.height_mm(x, y) = -4;
        }
    for (const Solver solver : {Solver::batch, Solver::ceres}) {
        const TestDir folder;
        FitOptions options;
        options.solver = solver;
        const FitResult fit =
            fitted(folder, truth, {.lights = 42, .reflectance = Reflectance::ward_bounded}, options);
        int right = 0, all = 0;
        for (int y = 2; y < truth.height() - 2; ++y)
            for (int x = 24; x < 36; ++x, ++all)
                right += std::abs(brightness(fit.surface.diffuse(x, y)) - 0.5f) < 0.05f &&
                         fit.surface.normal(x, y).z > 0.995f;
        std::cout << fmt::format("{}: {:.3f} right\n", solver == Solver::batch ? "batches" : "Ceres",
                                 static_cast<double>(right) / all);
        EXPECT_GT(right, 0.5 * all);
    }
}

// Lines two pixels wide on flat paint: burnished gold, and glossy black.
TP_LONG TEST(Crevices, LinesOfGoldAndOfBlackStayWhatTheyAre) {
    PaintingTruth truth(72, 60, 0.2);
    truth.specular_colour = Image<Rgb>(truth.width(), truth.height(), Rgb(1));
    const auto is_gold = [](int x) { return x % 24 == 8 || x % 24 == 9; };
    const auto is_black = [](int x) { return x % 24 == 18 || x % 24 == 19; };
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < truth.width(); ++x) {
            truth.diffuse(x, y) = Rgb(0.6f, 0.5f, 0.4f);
            truth.specular(x, y) = 0.04f;
            truth.roughness(x, y) = 0.25f;
            if (is_gold(x)) {
                truth.diffuse(x, y) = Rgb(0.03f, 0.02f, 0.01f);
                truth.specular(x, y) = 0.6f;
                truth.roughness(x, y) = 0.2f;
                truth.specular_colour(x, y) = Rgb(1, 0.78f, 0.4f);
            } else if (is_black(x)) {
                truth.diffuse(x, y) = Rgb(0.015f);
                truth.roughness(x, y) = 0.12f;
            }
        }
    const TestDir folder;
    const FitResult fit = fitted(folder, truth, {.lights = 24, .reflectance = Reflectance::ward_bounded});
    ASSERT_TRUE(fit.report.refined);
    double gold = 0, black = 0;
    int of_gold = 0, of_black = 0;
    for (int y = 2; y < truth.height() - 2; ++y)
        for (int x = 2; x < truth.width() - 2; ++x) {
            if (is_gold(x)) gold += fit.surface.specular(x, y) > 0.3f, ++of_gold;
            if (is_black(x)) black += brightness(fit.surface.diffuse(x, y)) < 0.05f, ++of_black;
        }
    std::cout << fmt::format("gold {:.3f}, black {:.3f}\n", gold / of_gold, black / of_black);
    EXPECT_GT(gold / of_gold, 0.95);
    EXPECT_GT(black / of_black, 0.98);
}

Surface even_paint(int size) {
    Surface surface(size, size);
    for (std::size_t i = 0; i < surface.diffuse.size(); ++i) {
        surface.diffuse.pixels()[i] = Rgb(0.5f);
        surface.specular.pixels()[i] = 0.04f;
        surface.roughness.pixels()[i] = 0.2f;
        surface.confidence.pixels()[i] = 0.99f;
    }
    return surface;
}

TEST(Crevices, AreDarkAndUncertainOrMirrors) {
    Surface surface = even_paint(21);
    const auto set = [&](int x, float diffuse, float specular, float roughness, float confidence) {
        surface.diffuse(x, 10) = Rgb(diffuse);
        surface.specular(x, 10) = specular;
        surface.roughness(x, 10) = roughness;
        surface.confidence(x, 10) = confidence;
    };
    set(3, 0.01f, 0.8f, 0.1f, 0.99f);   // a black mirror
    set(5, 0.01f, 0.05f, 0.1f, 0.5f);   // black and uncertain
    set(7, 0.01f, 0.05f, 0.1f, 0.99f);  // black paint
    set(9, 0.4f, 0.8f, 0.1f, 0.99f);    // a glint
    set(11, 0.01f, 0.8f, 0.5f, 0.99f);  // dull metal
    set(13, 0.5f, 0.04f, 0.2f, 0.01f);  // of no known slope
    set(15, 0.01f, 0.8f, 0.1f, 0);      // was not measured
    const Image<unsigned char> occluded = find_occluded_pixels(surface);
    std::vector<int> found;
    for (int y = 0; y < 21; ++y)
        for (int x = 0; x < 21; ++x)
            if (occluded(x, y)) found.push_back(y == 10 ? x : -1);
    EXPECT_EQ(found, (std::vector{3, 5, 13}));

    FitErrors errors(21, 21);
    const std::vector<float> before = distrust(occluded, surface);
    EXPECT_LT(surface.confidence(3, 10), 0.01f);
    EXPECT_EQ(surface.confidence(7, 10), 0.99f);
    EXPECT_EQ(surface.confidence(15, 10), 0);
    trust_again(occluded, before, surface);
    EXPECT_EQ(surface.confidence(3, 10), 0.99f);
    EXPECT_EQ(surface.confidence(5, 10), 0.5f);
    EXPECT_EQ(surface.confidence(13, 10), 0.01f);
    // Lobes twice as wide along one axis as along the other.
    surface.lobe_axes = Image<LobeAxes>(21, 21);
    for (std::size_t i = 0; i < surface.lobe_axes.size(); ++i)
        surface.lobe_axes.pixels()[i].roughness_v = surface.roughness.pixels()[i] / 2;
    fill_from_neighbours(occluded, surface, errors);
    EXPECT_NEAR(brightness(surface.diffuse(13, 10)), 0.5, 0.06);
    EXPECT_LT(surface.specular(3, 10), 0.2f);
    EXPECT_GT(errors.specular(3, 10), 1);
    for (const int x : {3, 5, 7, 13})
        EXPECT_NEAR(surface.lobe_axes(x, 10).roughness_v, surface.roughness(x, 10) / 2, 1e-6) << x;
    EXPECT_EQ(surface.diffuse(7, 10), Rgb(0.01f));
}

TEST(Crevices, HideTheDarkPhotographsThatTheReliefDoesNotExplain) {
    PixelSamples samples;
    samples.resize(3, 1);
    for (std::size_t i = 0; i < 3; ++i) {
        samples.light[i] = {0, 0, 1};
        samples.irradiance[i] = 1;
        samples.sigma[i] = 0.01;
        samples.visible[i] = 1;
    }
    samples.value = {0.5, 0.1, 0.1};
    samples.visible[2] = 0;
    const WardStart start{.slope = {0, 0}, .diffuse = glm::dvec3(0.5)};
    const double cost = hide_dark(start, samples);
    EXPECT_EQ(samples.sigma[0], 0.01);
    EXPECT_NEAR(samples.sigma[1], 0.5, 0.001);
    EXPECT_NEAR(samples.sigma[2], 0.5, 0.001);
    EXPECT_GT(cost, 1);
    samples.visible = {1, 1, 1};
    samples.sigma = {0.01, 0.01, 0.01};
    EXPECT_EQ(hide_dark(start, samples), 2 * cost);
    // What is not in the picture is not dark.
    samples.value = {0.5, std::numeric_limits<double>::quiet_NaN(), 0.1};
    samples.sigma = {0.01, 0, 0.01};
    EXPECT_EQ(hide_dark(start, samples), cost);
    EXPECT_EQ(samples.sigma[1], 0);
    // What hides a light hides lower ones in its direction: one of which such a one is seen is not hidden.
    samples.light = {glm::normalize(glm::dvec3(1, 0, 0.5)), glm::normalize(glm::dvec3(1, 0.1, 1)),
                     glm::normalize(glm::dvec3(-1, 0, 1))};
    samples.value = {0.22, 0.01, 0.01};
    samples.sigma = {0.01, 0.01, 0.01};
    hide_dark(start, samples);
    EXPECT_EQ(samples.sigma[1], 0.01);
    EXPECT_GT(samples.sigma[2], 0.3);
}

}  // namespace
}  // namespace tangi
