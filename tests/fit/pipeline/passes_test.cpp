// passes_test.cpp: what is refined, and what is said of photographs that differ from the model.
#include "fit/pipeline/fit_passes.h"

#include <gmock/gmock.h>

#include <iostream>

#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::Not;

// "1.0 times what is expected" would say that nothing is wrong.
TEST(FitPasses, SayByHowMuchPhotographsDiffer) {
    EXPECT_EQ(beyond_expected(1.004), "1 % more than is expected (in the median)");
    EXPECT_EQ(beyond_expected(1.06), "6 % more than is expected (in the median)");
    EXPECT_EQ(beyond_expected(1.9), "90 % more than is expected (in the median)");
    EXPECT_EQ(beyond_expected(1.96), "2.0 times what is expected (in the median)");
    EXPECT_EQ(beyond_expected(2.34), "2.3 times what is expected (in the median)");
}

// Most pixels are in shadow of some light, of which the first pass only knows what each pixel shows by
// itself: its height casts the shadows that the photographs show, however much light reaches them from all
// around.
TP_LONG TEST(FitPasses, HeavyImpastoIsRefinedByTheShadowsItCasts) {
    for (const double ambient : {0.0, 0.06}) {
        const TestDir folder;
        const PaintingTruth truth =
            procedural_painting({.seed = 51, .width = 120, .height = 96, .mm_per_pixel = 0.2, .impasto = 3});
        const GeneratorOptions generator{.lights = 32, .held_out = 4, .ambient = ambient};
        write_stack(folder.path(), truth, generator);
        const auto fitted = [&](bool refine) {
            return fit_painting(
                open_stack(folder.path()),
                {.white_level = generator.white_level, .mm_per_pixel = 0.2, .refine = refine});
        };
        const FitResult once = fitted(false), twice = fitted(true);
        EXPECT_FALSE(once.report.refined);
        EXPECT_TRUE(twice.report.refined);
        EXPECT_LT(twice.report.median_rms_residual, 0.75 * once.report.median_rms_residual);
        const double before = held_out_psnr_db(once.surface, folder.path(), generator.transfer),
                     after = held_out_psnr_db(twice.surface, folder.path(), generator.transfer),
                     error_before = mean_normal_error_deg(once.surface, truth),
                     error_after = mean_normal_error_deg(twice.surface, truth);
        std::cout << fmt::format(
            "ambient {}: median residual {:.2f}, then {:.2f}; shadows darker by ln {:.2f}; held out {:.2f}, "
            "then {:.2f} "
            "dB; normals {:.2f}, then {:.2f} deg\n",
            ambient, once.report.median_rms_residual, twice.report.median_rms_residual,
            twice.report.shadow_signs.contrast, before, after, error_before, error_after);
        const HeightChoice& choice = twice.report.height_choice;
        EXPECT_TRUE(choice.carving_kept);
        EXPECT_GT(choice.carved.contradicted, 1000);
        EXPECT_LT(choice.carved.left, 0.75 * static_cast<double>(choice.carved.contradicted));
        EXPECT_EQ(once.report.height_choice.carved.lights, 0);
        EXPECT_GT(after, before + 1);
        EXPECT_LT(error_after, error_before);
        for (const std::string& warning : twice.report.warnings)
            EXPECT_THAT(warning, Not(HasSubstr("refined")));
    }
}

// Gold under few lights is predicted badly by a pass that asks no neighbours.
TP_LONG TEST(FitPasses, MetalUnderFewLightsIsRefined) {
    const TestDir folder;
    const PaintingTruth truth = procedural_painting(
        {.seed = 10, .width = 180, .height = 140, .mm_per_pixel = 0.2, .impasto = 0.5, .gilding = true});
    const Transfer srgb{Transfer::Kind::srgb};
    const GeneratorOptions generator{.lights = 7,
                                     .held_out = 6,
                                     .arrangement = Arrangement::spiral,
                                     .transfer = srgb,
                                     .format = GeneratorFormat::jpg};
    write_stack(folder.path(), truth, generator);
    const auto fitted = [&](bool refine) {
        return fit_painting(open_stack(folder.path(), {.transfer = srgb}),
                            {.white_level = generator.white_level, .mm_per_pixel = 0.2, .refine = refine});
    };
    const FitResult once = fitted(false), twice = fitted(true);
    EXPECT_TRUE(twice.report.refined);
    const double before = held_out_psnr_db(once.surface, folder.path(), srgb),
                 after = held_out_psnr_db(twice.surface, folder.path(), srgb);
    std::cout << fmt::format("median residual {:.2f}, held out {:.2f}, then {:.2f} dB\n",
                             once.report.median_rms_residual, before, after);
    EXPECT_GT(after, before + 0.3);
}

}  // namespace
}  // namespace tangi
