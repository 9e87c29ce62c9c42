// height_coverage_test.cpp: the stated errors of whole fits hold the truth: of the height, and, as
// figures, of the other maps.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>

#include "fit/height/height.h"
#include "fit/height/height_error.h"
#include "fit/height/slope_edges.h"
#include "fit/height/subpixel_slopes.h"
#include "fit/pipeline/fit_painting.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

// Part of the measured pixels for which |off(i)| is within 1.96 of the stated error.
double coverage(const FitResult& fit, const Image<HalfError>& error,
                const std::function<float(std::size_t)>& off) {
    double inside = 0, count = 0;
    for (std::size_t i = 0; i < error.size(); ++i) {
        if (!(fit.surface.confidence.pixels()[i] > 0)) continue;
        inside += std::abs(off(i)) <= 1.96f * error.pixels()[i];
        ++count;
    }
    return inside / count;
}

// With the lights as they are.
FitResult fit_of(const PaintingTruth& truth, const GeneratorOptions& generator) {
    const TestDir folder;
    write_stack(folder.path(), truth, generator);
    return fit_painting(open_stack(folder.path(), {.transfer = Transfer{}}),
                        {.white_level = 0.75,
                         .mm_per_pixel = truth.mm_per_pixel,
                         .register_photos = false,
                         .lights_as_given = true});
}

// Generates, fits, prints. Returns the part of the pixels whose height is inside.
double height_coverage(const PaintingOptions& painting, const GeneratorOptions& generator) {
    const PaintingTruth truth = procedural_painting(painting);
    const FitResult fit = fit_of(truth, generator);
    const Surface& s = fit.surface;
    Image<float> off = s.height_mm;
    for (std::size_t i = 0; i < off.size(); ++i) off.pixels()[i] -= truth.height_mm.pixels()[i];
    Image<float> mean = off;
    box_mean(off, kHeightErrorWindow / 2, mean);
    const auto slope_off = [&](std::size_t i, bool y) {
        const Slope a = slope_of(s.normal.pixels()[i]), b = slope_of(truth.normal.pixels()[i]);
        return y ? a.y - b.y : a.x - b.x;
    };
    const FitErrors& e = fit.errors;
    const double height =
        coverage(fit, e.height, [&](std::size_t i) { return off.pixels()[i] - mean.pixels()[i]; });
    const double slope = (coverage(fit, e.slope, [&](std::size_t i) { return slope_off(i, false); }) +
                          coverage(fit, e.slope, [&](std::size_t i) { return slope_off(i, true); })) /
                         2;
    double diffuse = 0;
    for (int c = 0; c < 3; ++c)
        diffuse +=
            coverage(fit, e.diffuse,
                     [&](std::size_t i) { return s.diffuse.pixels()[i][c] - truth.diffuse.pixels()[i][c]; }) /
            3;
    const auto difference = [](const Image<float>& a, const Image<float>& b) {
        return [&](std::size_t i) { return a.pixels()[i] - b.pixels()[i]; };
    };
    std::cout << fmt::format(
        "[  FIGURE  ] seed {}, impasto {}, {} mm a pixel, {} lights, {}: inside the 95 % interval {:.3f} of "
        "height, "
        "{:.3f} slope, {:.3f} rho_d, {:.3f} rho_s, {:.3f} alpha\n",
        painting.seed, painting.impasto, painting.mm_per_pixel, generator.lights,
        name_of(generator.reflectance), height, slope, diffuse,
        coverage(fit, e.specular, difference(s.specular, truth.specular)),
        coverage(fit, e.roughness, difference(s.roughness, truth.roughness)));
    return height;
}

// How far the integral of these slopes is from the height, of the spread of the true ones.
double part_of_spread(const Image<Vec3>& normal, const PaintingTruth& truth, double mm) {
    const Image<float> known(normal.width(), normal.height(), 1.0f);
    Image<float> off;
    integrate_normals({normal, known, mm}, off, {.robust_sweeps = 0});
    for (std::size_t i = 0; i < off.size(); ++i) off.pixels()[i] -= truth.height_mm.pixels()[i];
    Image<float> mean = off;
    box_mean(off, kHeightErrorWindow / 2, mean);
    double square = 0, spread2 = 0;
    for (int y = 0; y < off.height(); ++y)
        for (int x = 0; x < off.width(); ++x) {
            square += std::pow((off(x, y) - mean(x, y)) / mm, 2);
            spread2 += std::pow(slope_spread(truth.normal, known, x, y), 2);
        }
    return std::sqrt(square / spread2);
}

TEST(SlopeEdges, HeightsOfTrueSlopesAreOffByThePartOfTheSpreadThatIsAssumed) {
    for (const double mm : {0.1, 0.25}) {
        const PaintingTruth truth =
            procedural_painting({.seed = 9, .width = 160, .height = 160, .mm_per_pixel = mm});
        const double part = part_of_spread(truth.normal, truth, mm);
        // Of mean slopes; those of a fit are flatter still, and shadows ask for more.
        constexpr double kRight = 0.05;
        const double steepened =
            part_of_spread(steepened_normals(truth.normal, Image<float>(160, 160, 1.0f), kRight), truth, mm);
        std::cout << fmt::format(
            "[  FIGURE  ] heights of true slopes, {} mm a pixel: off by {:.3f} of the spread, unmixed "
            "{:.3f}\n",
            mm, part, steepened);
        EXPECT_GT(part, 0.7 * kOffset);
        EXPECT_LT(part, 1.15 * kOffset);
        EXPECT_GT(steepened, 0.7 * kSteepenedOffset);
        EXPECT_LT(steepened, 1.15 * kSteepenedOffset);
    }
}

struct Case {
    PaintingOptions painting;
    int lights;
    Reflectance reflectance;
};

TP_LONG TEST(HeightCoverage, OfGeneratedPaintingsIs95Percent) {
    const Case cases[] = {
        {{.seed = 3, .width = 200, .height = 150}, 24, Reflectance::ward_bounded},
        {{.seed = 3, .width = 200, .height = 150, .impasto = 0.3}, 24, Reflectance::ward_bounded},
        {{.seed = 7, .width = 160, .height = 140, .impasto = 2}, 40, Reflectance::ward_bounded},
        {{.seed = 11,
          .width = 160,
          .height = 140,
          .weave_mm = 0,
          .impasto = 0.15,
          .craquelure = 0,
          .losses = false},
         60,
         Reflectance::ward_bounded},
        {{.seed = 21, .width = 160, .height = 140}, 16, Reflectance::ggx},
        {{.seed = 23, .width = 160, .height = 140, .mm_per_pixel = 0.15, .craquelure = 0, .losses = false},
         20,
         Reflectance::lambert},
    };
    for (const Case& c : cases) {
        const double inside = height_coverage(
            c.painting,
            {.seed = c.painting.seed, .lights = c.lights, .held_out = 0, .reflectance = c.reflectance});
        EXPECT_GE(inside, 0.90) << c.painting.seed;
        EXPECT_LE(inside, 0.98) << c.painting.seed;
    }
}

// 16 lights over cracks as wide as pixels leave slopes that are off by more than they say, and heights with
// them; and a height whose slopes were made steeper, as shadows ask for, is better than its error says.
TP_LONG TEST(HeightCoverage, OfHardGeneratedPaintingsIsNotFarFromIt) {
    EXPECT_GE(height_coverage({.seed = 12, .width = 160, .height = 140, .mm_per_pixel = 0.1},
                              {.seed = 12, .lights = 16, .held_out = 0, .reflectance = Reflectance::ggx}),
              0.80);
    EXPECT_GE(
        height_coverage({.seed = 22, .width = 160, .height = 140, .mm_per_pixel = 0.4},
                        {.seed = 22, .lights = 32, .held_out = 0, .reflectance = Reflectance::ward_bounded}),
        0.90);
}

// A wide, weak lobe is hardly told from matt reflection: what is said of it is little, but it holds.
TP_LONG TEST(LobeCoverage, OfAMattRetouchInAPictureOfGlossSaysThatItsLobeIsHardlyKnown) {
    const PaintingTruth truth = procedural_painting({.seed = 3, .width = 200, .height = 150});
    const FitResult fit =
        fit_of(truth, {.seed = 3, .lights = 24, .held_out = 0, .reflectance = Reflectance::ward_bounded});
    double alpha = 0, rho_s = 0, rho_d = 0, count = 0, mean_alpha = 0, true_alpha = 0;
    for (std::size_t i = 0; i < truth.retouch.size(); ++i) {
        if (!truth.retouch.pixels()[i] || !truth.valid.pixels()[i] ||
            !(fit.surface.confidence.pixels()[i] > 0))
            continue;
        const auto inside = [i](const Image<float>& is, const Image<float>& was,
                                const Image<HalfError>& error) {
            return std::abs(is.pixels()[i] - was.pixels()[i]) <= 1.96f * error.pixels()[i];
        };
        alpha += inside(fit.surface.roughness, truth.roughness, fit.errors.roughness);
        rho_s += inside(fit.surface.specular, truth.specular, fit.errors.specular);
        rho_d += std::abs(fit.surface.diffuse.pixels()[i].g - truth.diffuse.pixels()[i].g) <=
                 1.96f * fit.errors.diffuse.pixels()[i];
        mean_alpha += fit.surface.roughness.pixels()[i];
        true_alpha += truth.roughness.pixels()[i];
        ++count;
    }
    std::cout << fmt::format(
        "[  FIGURE  ] matt retouch: alpha {:.3f}, in truth {:.3f}; inside the 95 % interval {:.3f} of alpha, "
        "{:.3f} "
        "rho_s, {:.3f} rho_d\n",
        mean_alpha / count, true_alpha / count, alpha / count, rho_s / count, rho_d / count);
    EXPECT_GT(mean_alpha / count, 0.38);  // 0.29 by neighbours that bear witness to the prior
    EXPECT_GT(alpha / count, 0.6);
    EXPECT_GT(rho_s / count, 0.45);  // 0.01 by the Gaussian around the solution
    EXPECT_GT(rho_d / count, 0.95);
}

}  // namespace
}  // namespace tangi
