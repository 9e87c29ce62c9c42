// light_test.cpp: distant and near lights: direction, falloff, unit vectors.
#include "surface/maps/light.h"

#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(DistantLight, NormalisesItsDirection) {
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        const Vec3 direction = random.direction(-1);
        const Light light = distant_light(direction * random.real(0.01, 100), "a.jpg");
        EXPECT_LE(glm::length(light.direction - direction), 1e-6f);
        EXPECT_EQ(light.name, "a.jpg");
        EXPECT_FALSE(light.position_mm);
        EXPECT_EQ(light.gain, Rgb(1));
    }
}

TEST(DistantLight, WithoutDirectionBreaksTheContract) {
    EXPECT_THROW(distant_light({0, 0, 0}), ContractError);
    EXPECT_THROW(distant_light(Vec3(std::nanf(""))), ContractError);
    EXPECT_THROW(near_light({0, 0, 0}), ContractError);
}

TEST(DistantLight, IsTheSameEverywhere) {
    Light light = distant_light({1, 2, 2});
    light.gain = {0.5f, 1, 2};
    const Incidence in = incidence(light, {100, -50, 3});
    EXPECT_EQ(in.direction, light.direction);
    EXPECT_EQ(in.irradiance, light.gain);
}

// A light of which the direction and distance are from a point below the paint lights it as one that stands
// there.
TEST(NearLight, IsPlacedAsFarBelowAsTheSurfaceIsAbove) {
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const Rig rig{.light_distance_mm = random.real(150, 900), .surface_above_mm = random.real(-20, 20)};
        Light listed = distant_light(random.direction(0.2));
        listed.gain = {0.5f, 1, 2};
        Light placed = listed;
        place(placed, rig);
        ASSERT_TRUE(placed.position_mm);
        EXPECT_LE(glm::length(placed.direction - glm::normalize(*placed.position_mm)), 1e-6f);
        Light there = near_light(listed.direction * *rig.light_distance_mm);
        there.gain = listed.gain;
        const Vec3 point(random.real(-60, 60), random.real(-60, 60), 0);
        const Incidence seen = incidence(placed, point),
                        true_one = incidence(there, point + Vec3(0, 0, rig.surface_above_mm));
        EXPECT_LE(glm::length(seen.direction - true_one.direction), 1e-6f);
        EXPECT_LE(glm::length(seen.irradiance - true_one.irradiance),
                  1e-5f * glm::length(true_one.irradiance));
    }
    Light far = distant_light({1, 2, 2});
    place(far, {.surface_above_mm = 5});
    EXPECT_FALSE(far.position_mm);
    EXPECT_EQ(far.gain, Rgb(1));
}

TEST(NearLight, HasItsGainAtTheOrigin) {
    Light light = near_light({300, -400, 1200});
    light.gain = {0.5f, 1, 2};
    const Incidence in = incidence(light, {0, 0, 0});
    EXPECT_LE(glm::length(in.direction - Vec3(3 / 13.0f, -4 / 13.0f, 12 / 13.0f)), 1e-6f);
    EXPECT_LE(glm::length(in.direction - light.direction), 1e-6f);
    EXPECT_LE(glm::length(in.irradiance - light.gain), 1e-6f);
}

TEST(NearLight, FallsOffWithTheSquareOfTheDistance) {
    const Light light = near_light({0, 0, 100});
    EXPECT_NEAR(incidence(light, {0, 0, 50}).irradiance.g, 4, 1e-5);
    EXPECT_NEAR(incidence(light, {0, 0, -100}).irradiance.g, 0.25, 1e-6);
    EXPECT_NEAR(incidence(light, {100, 0, 0}).irradiance.g, 0.5, 1e-6);
}

TEST(NearLight, IsSeenInAnotherDirectionFromEachPoint) {
    const Light light = near_light({0, 0, 100});
    EXPECT_LE(glm::length(incidence(light, {100, 0, 0}).direction - glm::normalize(Vec3(-1, 0, 1))), 1e-6f);
    EXPECT_LE(glm::length(incidence(light, {0, -100, 0}).direction - glm::normalize(Vec3(0, 1, 1))), 1e-6f);
    EXPECT_NEAR(glm::length(incidence(light, {33, 44, 5}).direction), 1, 1e-6);
}

TEST(NearLight, FarAwayIsADistantOne) {
    const Vec3 direction = glm::normalize(Vec3(1, 1, 2));
    const Incidence in = incidence(near_light(direction * 1e6f), {100, -100, 0});
    // 141 mm at 1 km: 1.4e-4 in direction, twice that in strength.
    EXPECT_LE(glm::length(in.direction - direction), 2e-4f);
    EXPECT_NEAR(in.irradiance.r, 1, 4e-4);
}

TEST(Beam, IsAPolynomialOfThePlaceInTheLogarithm) {
    Light light = distant_light({0.3f, 0.2f, 0.9f});
    light.gain = Rgb(2);
    light.beam.terms = {0.01f, -0.02f, 1e-4f, -2e-4f, 3e-4f};
    EXPECT_FALSE(light.beam.even());
    EXPECT_EQ(incidence(light, {0, 0, 0}).irradiance, Rgb(2)) << "strength is that of the origin";
    // 0.01 * 30 + 0.02 * 10 + 1e-4 * 900 + 2e-4 * 300 + 3e-4 * 100
    EXPECT_NEAR(incidence(light, {30, -10, 5}).irradiance.g, 2 * std::exp(0.68f), 1e-5);
    EXPECT_EQ(incidence(light, {30, -10, 5}).direction, light.direction);
    light.position_mm = light.direction * 400.0f;
    Light even = light;
    even.beam = {};
    EXPECT_NEAR(incidence(light, {30, -10, 5}).irradiance.g,
                incidence(even, {30, -10, 5}).irradiance.g * std::exp(0.68f), 1e-5);
}

TEST(Incidence, BendsDirectionsWithTheDistanceFromTheCentre) {
    const Rig rig{.bend_per_mm = 0.001f};
    const Light above = distant_light({0, 0, 1});
    EXPECT_LE(glm::length(incidence(above, {0, 0, 0}, rig).direction - Vec3(0, 0, 1)), 1e-7f);
    // 50 mm to the right, a turn of 0.05 (to second order) towards +x.
    EXPECT_NEAR(incidence(above, {50, 0, 0}, rig).direction.x, 0.05, 1e-4);
    EXPECT_NEAR(incidence(above, {0, -50, 0}, rig).direction.y, -0.05, 1e-4);
    // All lights turn alike: angles between them stay, to second order in the turn.
    Random random(2);
    for (int i = 0; i < 50; ++i) {
        const Light a = distant_light(random.direction(0.1)), b = near_light(random.direction(0.1) * 1e6f);
        const Vec3 point(random.real(-50, 50), random.real(-50, 50), 0);
        EXPECT_NEAR(glm::dot(incidence(a, point, rig).direction, incidence(b, point, rig).direction),
                    glm::dot(a.direction, b.direction), 6e-3);
        EXPECT_NEAR(glm::length(incidence(a, point, rig).direction), 1, 1e-6);
    }
}

TEST(ViewDirection, PointsToTheCamera) {
    EXPECT_EQ(view_direction({}, {100, 50, 3}), Vec3(0, 0, 1));
    const Rig rig{.camera_distance_mm = 500.0f};
    EXPECT_LE(glm::length(view_direction(rig, {0, 0, 0}) - Vec3(0, 0, 1)), 1e-7f);
    EXPECT_LE(glm::length(view_direction(rig, {375, 0, 0}) - Vec3(-0.6f, 0, 0.8f)), 1e-6f);
}

}  // namespace
}  // namespace tangi
