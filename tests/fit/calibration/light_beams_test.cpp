// light_beams_test.cpp: lights that light the picture unevenly are found again in generated stacks, and
// even ones are left alone.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "datasets/generator.h"
#include "fit/calibration/light_calibration.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/base/median.h"
#include "surface/maps/photography_json.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

constexpr int kPaintingSize = 128;

struct BeamScene {
    TestDir folder;
    GeneratorOptions options;
    Stack stack;
    Survey surveyed;
    PaintingTruth painting;
    Photography truth;
    explicit BeamScene(const GeneratorOptions& o) : options(o) {
        options.arrangement = Arrangement::spiral;
        painting = procedural_painting(
            {.seed = 5, .width = kPaintingSize, .height = kPaintingSize, .mm_per_pixel = kMmPerPixel});
        truth = write_stack(folder.path(), painting, options);
        stack = open_stack(folder.path(), {.transfer = Transfer{}});
        surveyed = survey(stack);
    }
    LightCalibration calibrated() const {
        return calibrate_lights(
            {stack, surveyed, Transfer{}, NoiseModel(Transfer{}, 0.006, true), kMmPerPixel},
            {stack.lights(), {}, 0.75}, {});
    }
    const Light& true_light(const std::string& name) const {
        for (const Photography::Photo& photo : truth.photos)
            if (photo.light.name == name) return photo.light;
        throw Error("no such light");
    }
    // [1] rms of ln(found / true) irradiance over picture and lights, less what is the same for all lights at
    // a place (albedo), and less each light's strength.
    double error(const std::vector<Light>& lights, const Rig& rig) const {
        constexpr int kGrid = 7;
        const auto count = static_cast<double>(lights.size());
        std::vector<std::vector<double>> errors(lights.size());
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const Light& real = true_light(lights[i].name);
            double sum = 0;
            for (int k = 0; k < kGrid * kGrid; ++k) {
                const auto at = [](int j) {
                    return static_cast<float>((j / (kGrid - 1.0) - 0.5) * kPaintingSize * kMmPerPixel);
                };
                const Vec3 place(at(k % kGrid), at(k / kGrid), 0);
                const double shown = incidence(lights[i], place, rig).irradiance.g /
                                     (incidence(real, place).irradiance.g *
                                      beam_part(real, place, kPaintingSize * kMmPerPixel, options));
                errors[i].push_back(std::log(shown));
                sum += errors[i].back() / (kGrid * kGrid);
            }
            for (double& e : errors[i]) e -= sum;
        }
        double squares = 0;
        for (std::size_t k = 0; k < errors[0].size(); ++k) {
            double common = 0;
            for (const auto& light : errors) common += light[k] / count;
            for (const auto& light : errors)
                squares += std::pow(light[k] - common, 2) / (count * static_cast<double>(light.size()));
        }
        return std::sqrt(squares);
    }
};

LightCalibration without_beams(LightCalibration c) {
    for (Light& light : c.lighting.lights) light.beam = {};
    return c;
}

// Reflectors that are half as strong 25 degrees from their axis, carried around by hand.
TP_LONG TEST(LightBeams, OfReflectorsThatAreAimedByHandAreFound) {
    const BeamScene scene({.lights = 30, .held_out = 0, .distance = 1.5, .beam_deg = 25, .aim_error = 0.15});
    const LightCalibration found = scene.calibrated();
    ASSERT_TRUE(found.model.beams) << name_of(found.model);
    const double left = scene.error(found.lighting.lights, found.lighting.rig);
    const double even = scene.error(without_beams(found).lighting.lights, found.lighting.rig);
    std::cout << fmt::format("[  FIGURE  ] beams: ln irradiance off by {:.3f} rms, taken as even by {:.3f}\n",
                             left, even);
    EXPECT_GE(even, 0.05);
    EXPECT_LE(left, 0.35 * even);
    std::vector<double> rms, sigma;
    for (const LightCalibration::Unevenness& u : found.unevenness) {
        rms.push_back(u.rms);
        sigma.push_back(u.sigma);
    }
    EXPECT_GT(median(rms), 3 * median(sigma)) << "and known to be there";
    EXPECT_GT(median(sigma), 0.0005);
    const nlohmann::json written = to_json(found);
    EXPECT_EQ(written["beams"].size(), 30u);
    EXPECT_TRUE(written["beams"]["img_000.png"].contains("terms"));
}

// Lights of a dome, all aimed at the middle: their beams are a smooth function of the direction, so that of a
// light that no photograph had can be told.
TP_LONG TEST(LightBeams, OfADomeArePredictedForOtherLights) {
    const BeamScene scene(
        {.lights = 30, .held_out = 8, .min_elevation_deg = 20, .distance = 1.5, .beam_deg = 30});
    const LightCalibration found = scene.calibrated();
    ASSERT_TRUE(found.model.beams) << name_of(found.model);
    ASSERT_TRUE(found.beams);
    std::vector<Light> held_out;
    for (const Photography::Photo& photo : scene.truth.photos) {
        if (photo.fitted) continue;
        Light light = photo.light;
        light.position_mm.reset();
        light.beam = predicted_beam(*found.beams, found.lighting.lights, light.direction);
        if (found.lighting.rig.light_distance_mm)
            light.position_mm = light.direction * *found.lighting.rig.light_distance_mm;
        held_out.push_back(light);
    }
    const double predicted = scene.error(held_out, found.lighting.rig);
    for (Light& light : held_out) light.beam = {};
    const double even = scene.error(held_out, found.lighting.rig);
    std::cout << fmt::format(
        "[  FIGURE  ] lights of a dome: ln irradiance off by {:.3f} rms, taken as even by {:.3f}\n",
        predicted, even);
    EXPECT_LE(predicted, 0.6 * even);
}

TP_LONG TEST(LightBeams, OfEvenLightsAreLeftAlone) {
    const BeamScene scene({.lights = 30, .held_out = 0, .distance = 1.5, .gain_min = 0.5, .gain_max = 1.5});
    const LightCalibration found = scene.calibrated();
    EXPECT_EQ(found.model.lights, LightFreedom::rig_and_gains);
    EXPECT_FALSE(found.model.beams) << name_of(found.model);
    EXPECT_FALSE(found.beams);
    for (const Light& light : found.lighting.lights) EXPECT_TRUE(light.beam.even());
    EXPECT_EQ(to_json(found)["beams"], nlohmann::json::object());
}

}  // namespace
}  // namespace tangi
