// large_pictures_test.cpp: reduced photographs stand in for a first pass over large ones where that is as
// good, and for all in a preview.
#include <gmock/gmock.h>

#include <iostream>
#include <set>

#include "fit/pipeline/fit_painting.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

struct LargeStack {
    TestDir folder;
    PaintingTruth truth;
    GeneratorOptions generator{.lights = 12, .held_out = 3, .ambient = 0.02};

    explicit LargeStack(double impasto)
        : truth(procedural_painting({.seed = 7, .width = 1100, .height = 950, .impasto = impasto})) {
        write_stack(folder.path(), truth, generator);
    }
    FitResult fit(const FitOptions& asked, std::set<std::string>* stages = nullptr) const {
        FitOptions options = asked;
        options.white_level = generator.white_level;
        options.mm_per_pixel = truth.mm_per_pixel;
        return fit_painting(open_stack(folder.path()), options, [&](std::string_view stage, double) {
            if (stages) stages->insert(std::string(stage));
            return true;
        });
    }
};

// Normals of blocks, by their mean slopes.
double error_of_blocks_deg(const Surface& small, const PaintingTruth& truth, int reduction) {
    double sum = 0;
    long count = 0;
    for (int y = 0; (y + 1) * reduction <= truth.normal.height(); ++y)
        for (int x = 0; (x + 1) * reduction <= truth.normal.width(); ++x) {
            Slope mean;
            for (int v = y * reduction; v < (y + 1) * reduction; ++v)
                for (int u = x * reduction; u < (x + 1) * reduction; ++u) {
                    const Slope slope = slope_of(truth.normal(u, v));
                    mean.x += slope.x / static_cast<float>(reduction * reduction);
                    mean.y += slope.y / static_cast<float>(reduction * reduction);
                }
            sum += std::acos(std::min(glm::dot(small.normal(x, y), normal_of(mean)), 1.0f)) * 180 / M_PI;
            ++count;
        }
    return sum / static_cast<double>(count);
}

TP_LONG TEST(LargePictures, AreFittedOnceWhereReliefHidesNothing) {
    const LargeStack large(0.3);
    std::set<std::string> stages;
    const FitResult once = large.fit({}, &stages);
    EXPECT_TRUE(once.report.refined);
    EXPECT_TRUE(stages.contains("reduced photographs: fit"));
    EXPECT_FALSE(stages.contains("fit"));
    EXPECT_EQ(once.surface.width(), 1100);
    const double normals = mean_normal_error_deg(once.surface, large.truth),
                 held_out = held_out_psnr_db(once.surface, large.folder.path(), large.generator.transfer);
    std::cout << fmt::format("normals {:.3f} deg, held out {:.2f} dB\n", normals, held_out);
    EXPECT_LT(normals, 0.25);
    EXPECT_GT(held_out, 46);

    const FitResult preview = large.fit({.preview = true});
    EXPECT_EQ(preview.report.reduction, 2);
    EXPECT_EQ(preview.surface.width(), 550);
    EXPECT_EQ(preview.surface.height(), 475);
    EXPECT_NEAR(preview.surface.mm_per_pixel, 2 * large.truth.mm_per_pixel, 1e-9);
    const double blocks = error_of_blocks_deg(preview.surface, large.truth, 2);
    std::cout << fmt::format("preview {:.3f} deg\n", blocks);
    EXPECT_LT(blocks, 0.45);
}

TP_LONG TEST(LargePictures, AreFittedTwiceWhereReliefHidesLights) {
    const LargeStack large(2);
    std::set<std::string> stages;
    const FitResult twice = large.fit({}, &stages);
    EXPECT_TRUE(twice.report.refined);
    EXPECT_TRUE(stages.contains("fit"));
    EXPECT_TRUE(stages.contains("refine"));
}

// There is nothing to reduce.
TEST(LargePictures, APreviewOfASmallOneIsTheFit) {
    const SmallStack small;
    const FitResult whole = fit_painting(small.open(), {}),
                    preview = fit_painting(small.open(), {.preview = true});
    EXPECT_EQ(preview.report.reduction, 1);
    EXPECT_EQ(hash_of(preview.surface), hash_of(whole.surface));
}

}  // namespace
}  // namespace tangi
