// light_calibration_test.cpp: lights, ambient light and camera are found again in generated stacks, and
// are left alone where there is nothing to find.
#include "fit/calibration/light_calibration.h"

#include <gtest/gtest.h>

#include <iostream>

#include "datasets/generator.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/base/json_reading.h"
#include "surface/base/parallel.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/photography_json.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/fit/light_errors.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

// A stack on disk, opened, and what the generator knows of it.
struct LightScene {
    TestDir folder;
    Stack stack;
    Survey surveyed;
    Photography truth;
    explicit LightScene(GeneratorOptions options, int size = 160) {
        options.held_out = 0;
        const PaintingTruth painting =
            procedural_painting({.seed = 5, .width = size, .height = size, .mm_per_pixel = kMmPerPixel});
        write_stack(folder.path(), painting, options);
        stack = open_stack(folder.path(), {.transfer = Transfer{}});
        surveyed = survey(stack);
        truth = photography_from_json(read_json(bytes_of(folder / "gt/lights.json"), "JSON"));
    }
    double width_mm() const { return stack.width() * kMmPerPixel; }
    double mean_height_mm() const {
        const Image<Rgb> height = read_picture(folder / "gt/height.exr");
        double sum = 0;
        for (const Rgb& value : height.pixels()) sum += value.g;
        return sum / static_cast<double>(height.size());
    }
    LightCalibration calibrated() const {
        return calibrate_lights(
            {stack, surveyed, Transfer{}, NoiseModel(Transfer{}, 0.002, true), kMmPerPixel},
            {stack.lights(), {}, 0.75}, {});
    }
};

struct GainErrors {
    double mean = 0, worst = 0;  // relative
    double rms_in_sigmas = 0;    // of the errors, in units of what is stated
};
GainErrors gain_errors(const LightCalibration& found, const Photography& truth) {
    const std::vector<double> of_lights = errors_of_gains(found, truth);
    const auto count = static_cast<double>(of_lights.size());
    GainErrors errors;
    EXPECT_EQ(found.gain_sigma.size(), of_lights.size());
    for (std::size_t i = 0; i < of_lights.size(); ++i) {
        errors.mean += of_lights[i] / count;
        errors.worst = std::max(errors.worst, of_lights[i]);
        errors.rms_in_sigmas += std::pow(of_lights[i] / found.gain_sigma[i], 2) / count;
    }
    errors.rms_in_sigmas = std::sqrt(errors.rms_in_sigmas);
    return errors;
}

TP_LONG TEST(LightCalibration, FindsStrengthAndDistanceOfNearLightsThatDifferSevenfold) {
    for (const Reflectance reflectance : {Reflectance::ggx, Reflectance::lambert}) {
        const LightScene scene(
            {.lights = 40, .distance = 1.5, .gain_min = 0.3, .gain_max = 2, .reflectance = reflectance});
        const LightCalibration found = scene.calibrated();
        const GainErrors errors = gain_errors(found, scene.truth);
        const double distance = found.lighting.rig.light_distance_mm.value_or(0) / scene.width_mm();
        std::cout << fmt::format(
            "{}: gains off by {:.2f} % on average, {:.2f} % at most, {:.2f} of the stated errors; distance "
            "{:.3f} "
            "widths ± {:.3f}\n",
            name_of(reflectance), 100 * errors.mean, 100 * errors.worst, errors.rms_in_sigmas, distance,
            distance * found.rig_sigma.light_distance);
        EXPECT_EQ(found.model.lights, LightFreedom::rig_and_gains);
        EXPECT_LE(errors.mean, 0.012);
        EXPECT_LE(errors.worst, 0.03);
        EXPECT_NEAR(distance, 1.5, 0.05);
    }
}

// Few pixels, few lights, and a third of them so low that a degree of tilt is 6 % of their light: what is
// stated says so.
TP_LONG TEST(LightCalibration, StatesErrorsOfStrengthThatHoldTheTruthForATinyPicture) {
    const LightScene scene({.lights = 24, .distance = 1.5, .gain_min = 0.3, .gain_max = 2}, 96);
    const LightCalibration found = scene.calibrated();
    ASSERT_EQ(found.model.lights, LightFreedom::rig_and_gains);
    const GainErrors errors = gain_errors(found, scene.truth);
    std::cout << fmt::format(
        "[  FIGURE  ] gains of a tiny picture off by {:.1f} % on average, {:.1f} % at most, {:.2f} of the "
        "stated errors\n",
        100 * errors.mean, 100 * errors.worst, errors.rms_in_sigmas);
    EXPECT_LE(errors.mean, 0.03);
    EXPECT_LE(errors.rms_in_sigmas, 1.6);
    EXPECT_GE(errors.rms_in_sigmas, 0.3);
}

TP_LONG TEST(LightCalibration, FindsAmbientLight) {
    // The generator's interreflection grows with the light's elevation; its ambient light does not.
    const LightScene scene({.lights = 40, .reflectance = Reflectance::ward_bounded, .ambient = 0.1});
    const LightCalibration found = scene.calibrated();
    EXPECT_NE(found.model.lights, LightFreedom::none);
    EXPECT_NEAR(found.lighting.rig.ambient, 0.1, 0.02);
    EXPECT_GT(found.trials[1].cv_psnr_db, found.trials[0].cv_psnr_db + 3);
}

TP_LONG TEST(LightCalibration, LeavesLightsAloneThatAreRight) {
    const LightScene scene({.lights = 40});
    const LightCalibration found = scene.calibrated();
    EXPECT_EQ(found.model.lights, LightFreedom::none);
    EXPECT_EQ(found.lighting.rig, Rig{});
    for (const Light& light : found.lighting.lights) EXPECT_EQ(light.gain, Rgb(1));
    EXPECT_EQ(found.model.directions, DirectionFreedom::listed);
    EXPECT_FALSE(found.model.beams);
}

TP_LONG TEST(LightCalibration, OfSixPhotographsOnFindsStrengths) {
    for (const int lights : {6, 8, 11}) {
        const LightScene scene(
            {.lights = lights, .arrangement = Arrangement::spiral, .gain_min = 0.5, .gain_max = 2}, 96);
        const LightCalibration found = scene.calibrated();
        ASSERT_EQ(found.model.lights, LightFreedom::rig_and_gains) << lights;
        EXPECT_EQ(found.trials[1].photos_db.size(), static_cast<std::size_t>(lights));  // each was left out
        const GainErrors errors = gain_errors(found, scene.truth);
        std::cout << fmt::format(
            "[  FIGURE  ] {} lights, fourfold: gains off by {:.1f} % on average, {:.1f} % at most, {:.2f} of "
            "the "
            "stated errors\n",
            lights, 100 * errors.mean, 100 * errors.worst, errors.rms_in_sigmas);
        EXPECT_LE(errors.mean, 0.02) << lights;
        EXPECT_LE(errors.rms_in_sigmas, 2) << lights;
    }
}

// One unknown a photograph is one too many of five: strengths are not tried.
TP_LONG TEST(LightCalibration, OfFivePhotographsTakesDistantLightsAsGiven) {
    const LightScene scene({.lights = 5, .gain_min = 0.3, .gain_max = 2}, 64);
    const LightCalibration found = scene.calibrated();
    EXPECT_EQ(found.model.lights, LightFreedom::none);
    EXPECT_EQ(found.lighting.rig, Rig{});
    ASSERT_EQ(found.trials.size(), 2u);
    EXPECT_EQ(found.trials[1].model.lights, LightFreedom::rig);
    EXPECT_EQ(to_json(found)["gains"], nlohmann::json::object());
}

// Taken for distant, near lights make a bulge of the painting that is many times its relief.
TP_LONG TEST(LightCalibration, OfAFewPhotographsTellsHowNearTheirLightsAre) {
    for (const int lights : {5, 6, 8, 11}) {
        const LightScene scene({.lights = lights, .arrangement = Arrangement::spiral, .distance = 3}, 96);
        const LightCalibration found = scene.calibrated();
        const double distance = found.lighting.rig.light_distance_mm.value_or(0) / scene.width_mm();
        std::cout << fmt::format("[  FIGURE  ] {} lights 3 widths away: found {:.2f} ± {:.2f}\n", lights,
                                 distance, distance * found.rig_sigma.light_distance);
        EXPECT_EQ(found.model.lights, LightFreedom::rig) << lights;
        EXPECT_NEAR(distance, 3, 0.5) << lights;
    }
    const LightScene four({.lights = 4, .arrangement = Arrangement::spiral, .distance = 3}, 64);
    EXPECT_TRUE(four.calibrated().trials.empty());  // leaving one out leaves nothing to judge by
}

// Lights light paint that lies above the plane which their directions are from as if they were nearer, the
// steep ones most. A bend of their directions would make much the same of the photographs, and bow the
// painting.
TP_LONG TEST(LightCalibration, OfNearLightsTellsTheHeightOfThePaintFromABend) {
    for (const Reflectance reflectance : {Reflectance::ward_bounded, Reflectance::lambert}) {
        const LightScene scene({.lights = 24, .distance = 1.5, .reflectance = reflectance});
        const LightCalibration found = scene.calibrated();
        const Rig& rig = found.lighting.rig;
        const double bend_deg = rig.bend_per_mm * scene.width_mm() / 2 / kDegree,
                     distance = rig.light_distance_mm.value_or(0) / scene.width_mm();
        const double height_mm = scene.mean_height_mm();
        std::cout << fmt::format(
            "[  FIGURE  ] {}: distance {:.3f} widths, paint {:.2f} mm high, found {:.2f} ± {:.2f}, a bend of "
            "{:.2f}° at "
            "the border\n",
            name_of(reflectance), distance, height_mm, rig.surface_above_mm, found.rig_sigma.surface_above_mm,
            bend_deg);
        EXPECT_EQ(found.model.lights, LightFreedom::rig);
        EXPECT_NEAR(distance, 1.5, 0.02);
        EXPECT_NEAR(rig.surface_above_mm, height_mm, 3 * found.rig_sigma.surface_above_mm);
        EXPECT_LE(std::abs(bend_deg), 0.4);
    }
}

// What an exposure that is too short makes of the same photographs.
TP_LONG TEST(LightCalibration, FindsNearLightsInDarkPhotographs) {
    const LightScene scene({.lights = 24, .distance = 2, .white_level = 0.03}, 96);
    const LightCalibration found = calibrate_lights(
        {scene.stack, scene.surveyed, Transfer{}, NoiseModel(Transfer{}, 0.006, true), kMmPerPixel},
        {scene.stack.lights(), {}, 1}, {});
    EXPECT_EQ(found.model.lights, LightFreedom::rig);
    EXPECT_NEAR(found.lighting.rig.light_distance_mm.value_or(0) / scene.width_mm(), 2, 0.3);
}

TP_LONG TEST(LightCalibration, HasTheSameBitsOnOneThreadAndOnTwo) {
    const LightScene scene({.lights = 16, .distance = 2, .gain_min = 0.5}, 64);
    const int before = thread_count();
    set_thread_count(1);
    const LightCalibration one = scene.calibrated();
    set_thread_count(2);
    const LightCalibration two = scene.calibrated();
    set_thread_count(before);
    EXPECT_EQ(to_json(one), to_json(two));
    EXPECT_EQ(one.light_model, two.light_model);
}

// By less than the last bit of any file.
void disturb(Survey& surveyed) {
    std::uint32_t state = 1;
    for (float& value : surveyed.values) {
        state = state * 1664525u + 1013904223u;  // Numerical Recipes' generator
        value *= 1 + 1e-6f * (static_cast<float>(state >> 8) / 8388608.0f - 1);
    }
}

// Where the search is cut short of its minimum, other lights come out, 27 % apart, and another model of them.
TP_LONG TEST(LightCalibration, IsThatOfTheMinimumAndNotOfRounding) {
    LightScene scene({.seed = 2,
                      .lights = 40,
                      .distance = 1.5,
                      .gain_min = 0.5,
                      .gain_max = 2,
                      .nominal_direction_error_deg = 3,
                      .ambient = 0.15,
                      .interreflection = 0.1});
    const LightCalibration found = scene.calibrated();
    disturb(scene.surveyed);
    const LightCalibration again = scene.calibrated();
    EXPECT_EQ(found.model, again.model);
    EXPECT_NEAR(found.lighting.rig.ambient, again.lighting.rig.ambient, 0.002);
    for (std::size_t i = 0; i < found.lighting.lights.size(); ++i)
        EXPECT_NEAR(found.lighting.lights[i].gain.g / again.lighting.lights[i].gain.g, 1, 0.005) << i;
}

TP_LONG TEST(FitPainting, WithNearUnequalLightsIsAboutAsGoodAsWithDistantEqualOnes) {
    TestDir folder;
    const PaintingTruth truth =
        procedural_painting({.seed = 5, .width = 128, .height = 128, .mm_per_pixel = kMmPerPixel});
    write_stack(folder.path(), truth,
                {.lights = 32, .held_out = 0, .distance = 1.5, .gain_min = 0.5, .gain_max = 1.5});
    const auto error_deg = [&](const FitOptions& options) {
        const Surface s = fit_painting(open_stack(folder.path(), {.transfer = Transfer{}}), options).surface;
        double sum = 0;
        for (std::size_t i = 0; i < s.normal.size(); ++i)
            sum += std::acos(std::min(1.0f, glm::dot(s.normal.pixels()[i], truth.normal.pixels()[i])));
        return sum / static_cast<double>(s.normal.size()) * 180 / std::numbers::pi;
    };
    FitOptions options{.white_level = 0.75, .mm_per_pixel = kMmPerPixel};
    const double calibrated = error_deg(options);
    options.lights_as_given = true;
    const double as_given = error_deg(options);
    std::cout << fmt::format("normals off by {:.2f} deg, lights as given {:.2f}\n", calibrated, as_given);
    EXPECT_LE(calibrated, 1.6);
    EXPECT_GE(as_given, 4);
}

}  // namespace
}  // namespace tangi
