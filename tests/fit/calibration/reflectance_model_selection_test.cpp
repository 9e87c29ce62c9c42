// reflectance_model_selection_test.cpp: the law that a painting's photographs follow is found, and none where
// there is none.
#include "fit/calibration/reflectance_model_selection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/pipeline/fit_painting.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kPatchSize = 20;

// Waves of semi-gloss paint that follow this law.
Surface waves(const ReflectanceModel& reflectance_model, float roughness = 0.15f) {
    Surface s(kPatchSize, kPatchSize);
    s.reflectance_model = reflectance_model;
    Random random(9);
    for (int y = 0; y < kPatchSize; ++y)
        for (int x = 0; x < kPatchSize; ++x) {
            s.normal(x, y) = normal_of({static_cast<float>(0.7 * std::sin(0.9 * x + 0.3)),
                                        static_cast<float>(0.7 * std::cos(0.7 * y))});
            s.diffuse(x, y) = Rgb(0.5f, 0.4f, 0.3f) * static_cast<float>(random.uniform(0.8, 1.2));
            s.specular(x, y) = 0.06f;
            s.roughness(x, y) = roughness;
            s.confidence(x, y) = 1;
        }
    return s;
}

FitResult fitted(const Surface& truth, int count, const FitOptions& options) {
    const TestDir folder;
    std::vector<Light> lights = dome_lights(count, 25);
    Random random(10);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        lights[i].name = fmt::format("photo{:02}.tif", i);
        Image<Rgb> picture = relight(truth, {&lights[i], 1});
        for (Rgb& value : picture.pixels())
            for (int c = 0; c < 3; ++c)
                value[c] = std::clamp(value[c] + 0.001f * static_cast<float>(random.normal()), 0.0f, 1.0f);
        write_picture(folder / lights[i].name, picture, {}, {.bits = 16});
    }
    write_lights(folder / "lights.lp", lights);
    FitOptions given = options;
    given.register_photos = false;
    return fit_painting(open_stack(folder.path(), {.transfer = Transfer{}}), given);
}

FitResult fitted(const ReflectanceModel& reflectance_model, const FitOptions& options = {.refine = false}) {
    return fitted(waves(reflectance_model), 30, options);
}

// A few lights leave much of a lobe to what is taken for likely: second lobe must not stand in for a wider
// one.
TP_LONG TEST(ReflectanceModelSelection, OfAFewLightsFindsNoSecondLobeWhereLobesAreWide) {
    const ReflectanceModelSelection choice =
        fitted(waves({}, 0.33f), 12, {.refine = false}).report.reflectance_model;
    EXPECT_EQ(choice.reflectance_model, ReflectanceModel{});
}

TP_LONG TEST(ReflectanceModelSelection, FindsNoneWhereLambertAndOneLobeAreTrue) {
    const ReflectanceModelSelection choice = fitted({}).report.reflectance_model;
    EXPECT_EQ(choice.reflectance_model, ReflectanceModel{});
    EXPECT_GE(choice.trials.size(), 3u);
    EXPECT_FALSE(choice.colours.chosen);
}

TP_LONG TEST(ReflectanceModelSelection, FindsRoughDiffuseReflection) {
    const FitResult fit = fitted({.diffuse_roughness = 0.5});
    EXPECT_NEAR(fit.report.reflectance_model.reflectance_model.diffuse_roughness, 0.5, 0.21);
    EXPECT_EQ(fit.report.reflectance_model.reflectance_model.second_lobe_weight, 0);
    EXPECT_EQ(fit.surface.reflectance_model, fit.report.reflectance_model.reflectance_model);
}

TP_LONG TEST(ReflectanceModelSelection, FindsASecondLobe) {
    const ReflectanceModelSelection choice = fitted({.second_lobe_weight = 0.6}).report.reflectance_model;
    EXPECT_EQ(choice.reflectance_model.second_lobe_weight, 0.6);
    EXPECT_LE(choice.reflectance_model.diffuse_roughness, 0.15);
}

TP_LONG TEST(ReflectanceModelSelection, LeavesWhatIsGiven) {
    const FitResult fit = fitted({.second_lobe_weight = 0.6},
                                 {.diffuse_roughness = 0.3, .second_lobe_weight = 0.1, .refine = false});
    EXPECT_EQ(fit.surface.reflectance_model,
              (ReflectanceModel{.diffuse_roughness = 0.3, .second_lobe_weight = 0.1}));
    EXPECT_TRUE(fit.report.reflectance_model.trials.empty());
}

}  // namespace
}  // namespace tangi
