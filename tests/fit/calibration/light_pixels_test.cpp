// light_pixels_test.cpp: lights are found, or left alone, where part of the picture is brushed gold, which
// outweighs the paint beside it in every mean over pixels.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "datasets/generator.h"
#include "fit/calibration/light_calibration.h"
#include "surface/base/json_reading.h"
#include "surface/maps/photography_json.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/fit/light_errors.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

constexpr int kPanelSize = 120;

struct GildedPanel {
    TestDir folder;
    Stack stack;
    LightCalibration found;

    explicit GildedPanel(GeneratorOptions options, double brushed = 0.5, std::uint64_t seed = 3) {
        options.held_out = 0;
        options.seed = seed;
        write_stack(folder.path(),
                    procedural_painting({.seed = seed,
                                         .width = kPanelSize,
                                         .height = kPanelSize,
                                         .mm_per_pixel = kMmPerPixel,
                                         .gilding = true,
                                         .brushed = brushed}),
                    options);
        stack = open_stack(folder.path(), {.transfer = Transfer{}});
        found = calibrate_lights(
            {stack, survey(stack), Transfer{}, NoiseModel(Transfer{}, 0.002, true), kMmPerPixel},
            {stack.lights(), {}, 0.75}, {});
        for (const LightCalibration::Trial& trial : found.trials)
            std::cout << fmt::format("{}: {:.2f} dB; ", name_of(trial.model), trial.cv_psnr_db);
        std::cout << "\n" << name_of(found.model) << "\n";
    }
    Photography truth() const {
        return photography_from_json(read_json(bytes_of(folder / "gt/lights.json"), "JSON"));
    }
};

// Whatever is taken for free: distant lights of equal strength, from where they are listed.
void expect_as_listed(const GildedPanel& panel) {
    const LightCalibration& found = panel.found;
    const float width_mm = static_cast<float>(kPanelSize * kMmPerPixel);
    for (const Light& light : found.lighting.lights) EXPECT_NEAR(light.gain.g, 1, 0.01) << light.name;
    for (const LightCalibration::Turn& turn : found.turns) EXPECT_LT(turn.changed_deg, 0.5);
    EXPECT_FALSE(found.model.beams);
    EXPECT_LT(found.lighting.rig.ambient, 0.01);
    EXPECT_GT(found.lighting.rig.light_distance_mm.value_or(1e6f), 20 * width_mm);
    EXPECT_LT(std::abs(found.lighting.rig.bend_per_mm) * width_mm / 2, 0.3 * kDegree);
}

TP_LONG TEST(LightPixels, LightsThatAreRightAreLeftAloneBesideGold) {
    for (const std::uint64_t seed : {3u, 4u}) expect_as_listed(GildedPanel({.lights = 36}, 0.5, seed));
}

TP_LONG TEST(LightPixels, NearLightsAreFoundBesideGold) {
    const GildedPanel panel({.lights = 32,
                             .arrangement = Arrangement::spiral,
                             .distance = 2.9,
                             .nominal_direction_error_deg = 1.1,
                             .reflectance = Reflectance::ward_bounded,
                             .ambient = 0.08},
                            0.3);
    EXPECT_EQ(panel.found.model, LightingModel{LightFreedom::rig});
    ASSERT_TRUE(panel.found.lighting.rig.light_distance_mm);
    EXPECT_NEAR(*panel.found.lighting.rig.light_distance_mm / (2.9 * kPanelSize * kMmPerPixel), 1, 0.1);
    EXPECT_NEAR(panel.found.lighting.rig.ambient, 0.08, 0.01);
}

TP_LONG TEST(LightPixels, StrengthsAreFoundBesideGold) {
    const GildedPanel panel(
        {.lights = 32, .distance = 1.5, .gain_min = 0.7, .gain_max = 1.4, .ambient = 0.04}, 0.8, 4);
    EXPECT_EQ(panel.found.model, LightingModel{LightFreedom::rig_and_gains});
    const std::vector<double> errors = errors_of_gains(panel.found, panel.truth());
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.1);
}

TP_LONG TEST(LightPixels, DirectionsAreFoundBesideGold) {
    const GildedPanel panel({.lights = 40, .nominal_direction_error_deg = 5});
    EXPECT_EQ(panel.found.model.directions, DirectionFreedom::own);
    EXPECT_NE(panel.found.model.lights, LightFreedom::rig_and_gains);
    EXPECT_LT(panel.found.lighting.rig.ambient, 0.01);
}

}  // namespace
}  // namespace tangi
