// light_model_test.cpp: unseen lights are predicted from those that were photographed.
#include "surface/maps/light_model.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <numeric>

#include "surface/maps/light_direction.h"
#include "surface/maps/surface.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

template <class Gain>
std::vector<Light> lights_of(int count, Gain&& gain) {
    std::vector<Light> lights = dome_lights(count);
    for (Light& light : lights) light.gain = Rgb(static_cast<float>(gain(light.direction)));
    return lights;
}

double worst_error(const LightModel& model, const std::vector<Light>& lights, auto&& gain) {
    Random random(3);
    double worst = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec3 direction = random.direction(0.3);
        worst = std::max(worst, std::abs(predicted_gain(model, lights, direction) / gain(direction) - 1));
    }
    return worst;
}

TEST(LightModel, OfEqualLightsPredictsTheSame) {
    const auto gain = [](const Vec3&) { return 0.8; };
    const std::vector<Light> lights = lights_of(40, gain);
    EXPECT_LE(worst_error(fit_light_model(lights), lights, gain), 1e-3);
}

TEST(LightModel, FollowsASmoothTrend) {
    const auto gain = [](const Vec3& l) { return std::exp(0.3 * l.x - 0.2 * l.y + 0.4 * l.x * l.x); };
    const std::vector<Light> lights = lights_of(60, gain);
    EXPECT_LE(worst_error(fit_light_model(lights), lights, gain), 0.05);
}

TEST(LightModel, PredictsColoursAsItDoesStrengths) {
    std::vector<Light> lights = lights_of(60, [](const Vec3&) { return 0.8; });
    EXPECT_EQ(predicted_colour(fit_light_model(lights), lights, {0, 0, 1}), Rgb(1))
        << "of lights without colour";
    const auto red = [](const Vec3& l) { return std::exp(0.3f * l.x); };
    for (Light& light : lights) light.gain *= Rgb(red(light.direction), 1, 0.9f);
    const LightModel model = fit_light_model(lights);
    Random random(5);
    for (int i = 0; i < 50; ++i) {
        const Vec3 direction = random.direction(0.3);
        const Rgb colour = predicted_colour(model, lights, direction);
        EXPECT_NEAR(colour.r, red(direction), 0.05);
        EXPECT_EQ(colour.g, 1);
        EXPECT_NEAR(colour.b, 0.9, 0.005);
    }
}

TEST(LightModel, FollowsWhatNeighboursHaveInCommon) {
    // A light that was nearer on one side of the arc: no quadratic has that shape.
    const auto gain = [](const Vec3& l) {
        return 1 + 0.6 * std::exp(-12 * ((l.x - 0.5) * (l.x - 0.5) + l.y * l.y));
    };
    const std::vector<Light> lights = lights_of(150, gain);
    const LightModel model = fit_light_model(lights);
    EXPECT_LE(std::abs(predicted_gain(model, lights, glm::normalize(Vec3(0.5, 0.05, 0.8))) /
                           gain(glm::normalize(Vec3(0.5, 0.05, 0.8))) -
                       1),
              0.1);
    EXPECT_LE(worst_error(model, lights, gain), 0.25);
}

TEST(LightModel, OfRandomStrengthsPredictsTheMiddleAndNoNeighbour) {
    Random random(11);
    const std::vector<Light> lights =
        lights_of(60, [&](const Vec3&) { return std::exp(random.uniform(-0.5, 0.5)); });
    const LightModel model = fit_light_model(lights);
    for (int i = 0; i < 100; ++i) {
        const double gain = predicted_gain(model, lights, random.direction(0.3));
        EXPECT_GE(gain, 0.7);
        EXPECT_LE(gain, 1.45);
    }
}

// Of many ways to follow directions, one fits a few lights of random strengths by chance.
TEST(LightModel, OfFewRandomStrengthsPredictsTheirMean) {
    double squares = 0;
    constexpr int stacks = 40, looks = 40;
    constexpr double sigma = 0.25;
    for (int seed = 1; seed <= stacks; ++seed) {
        Random random(static_cast<std::uint64_t>(seed));
        std::vector<double> logs;
        const std::vector<Light> lights = lights_of(8 + seed % 17, [&](const Vec3&) {
            logs.push_back(sigma * random.normal());
            return std::exp(logs.back());
        });
        const double mean = std::accumulate(logs.begin(), logs.end(), 0.0) / static_cast<double>(logs.size());
        const LightModel model = fit_light_model(lights);
        for (int i = 0; i < looks; ++i)
            squares += std::pow(std::log(predicted_gain(model, lights, random.direction(0.3))) - mean, 2);
    }
    const double off = std::sqrt(squares / (stacks * looks));
    std::cout << fmt::format("[  FIGURE  ] ln gain off the mean by {:.3f} rms, lights by {}\n", off, sigma);
    EXPECT_LE(off, 0.4 * sigma);
}

TEST(LightModel, IsNotBentByALampThatFailed) {
    int index = 0;
    const std::vector<Light> lights = lights_of(60, [&](const Vec3&) { return index++ == 20 ? 0.1 : 1.0; });
    const LightModel model = fit_light_model(lights);
    EXPECT_NEAR(predicted_gain(model, lights, -lights[20].direction * Vec3(1, 1, -1)), 1, 0.03);
}

// Each term goes its own way over the directions; what is small a millimetre is large at the border.
TEST(BeamModel, FollowsSmoothTrendsOfAllTerms) {
    constexpr double kRadius_mm = 150;
    const auto beam = [](const Vec3& l) {
        const float k = 1.0f / 150;
        return Beam{{0.2f * l.x * k, 0.1f * k, -0.3f * l.x * l.x * k * k, 0.2f * l.x * l.y * k * k,
                     (0.1f - 0.2f * l.y) * k * k}};
    };
    std::vector<Light> lights = dome_lights(60);
    for (Light& light : lights) light.beam = beam(light.direction);
    const BeamModel model = fit_beam_model(lights, kRadius_mm);
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const Vec3 direction = random.direction(0.3),
                   place(random.real(-150, 150), random.real(-100, 100), 0);
        EXPECT_NEAR(predicted_beam(model, lights, direction).part(place), beam(direction).part(place), 0.05);
    }
    EXPECT_TRUE(predicted_beam(fit_beam_model({}, 1), {}, {0, 0, 1}).even());
}

TEST(LightModel, OfNoLightsIsOne) { EXPECT_EQ(predicted_gain(fit_light_model({}), {}, {0, 0, 1}), 1); }

TEST(AsPhotographed, PredictsLightsThatNoPhotographHad) {
    Photography photography;
    const auto gain = [](const Vec3& l) { return std::exp(0.3 * l.x); };
    for (const Light& light : lights_of(60, gain)) photography.photos.push_back({light, true});
    photography.photos.push_back({distant_light({0, 0, 1}, "held out"), false});
    photography.photos.back().light.gain = Rgb(50);  // must not count
    photography.light_model = fit_light_model(lights_of(60, gain));
    photography.rig.light_distance_mm = 700.0f;
    const Light unseen = as_photographed(distant_light({0.6f, 0, 0.8f}), photography);
    EXPECT_NEAR(unseen.gain.g, std::exp(0.18), 0.03);
    ASSERT_TRUE(unseen.position_mm);
    EXPECT_NEAR(glm::length(*unseen.position_mm), 700, 1e-3);
}

// Where a lights file lists a light that is tilted the more the farther it is to the right.
Vec3 listed_for(const Vec3& direction) {
    const glm::dvec3 d(direction);
    return Vec3(turned(d, {0.1 * d.x * d.y, -0.08 * d.x}));
}

TEST(DirectionModel, FollowsASmoothFieldOfErrors) {
    const std::vector<Light> lights = dome_lights(60);
    std::vector<Vec3> listed;
    for (const Light& light : lights) listed.push_back(listed_for(light.direction));
    const DirectionModel model = fit_direction_model(listed, lights);
    Random random(5);
    for (int i = 0; i < 100; ++i) {
        const Vec3 direction = random.direction(0.4);
        const Vec3 found = predicted_direction(model, listed, listed_for(direction));
        EXPECT_LT(glm::distance(found, direction), 0.005f);
    }
}

TEST(AsPhotographed, MovesListedLightsAsThoseOfTheStackWere) {
    Photography photography;
    for (const Light& light : dome_lights(60))
        photography.photos.push_back({light, true, {}, listed_for(light.direction)});
    const Vec3 direction = glm::normalize(Vec3(0.5f, 0.3f, 0.8f)), listed = listed_for(direction);
    EXPECT_EQ(as_photographed(distant_light(listed), photography).direction, listed);
    photography.directions =
        fit_direction_model(directions_as_listed(photography), fitted_lights(photography));
    EXPECT_LT(glm::distance(as_photographed(distant_light(listed), photography).direction, direction),
              0.005f);
    const Light near = as_photographed(near_light(listed * 300.0f), photography);
    EXPECT_LT(glm::distance(near.position_mm.value(), direction * 300.0f), 2);
    // One of a photograph is where that one's was.
    const Photography::Photo& photo = photography.photos[7];
    Light again = photo.light;
    again.direction = *photo.listed_direction;
    EXPECT_EQ(as_photographed(again, photography).direction, photo.light.direction);
}

TEST(AsPhotographed, LeavesLightsAloneWhereNothingIsKnown) {
    const Light light = as_photographed(distant_light({0.6f, 0, 0.8f}), {});
    EXPECT_EQ(light.gain, Rgb(1));
    EXPECT_FALSE(light.position_mm);
}

}  // namespace
}  // namespace tangi
