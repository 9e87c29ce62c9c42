// Balls as a camera sees them: tangents, reflection, and the way back.
#include "capture/spheres/ball_geometry.h"

#include <gtest/gtest.h>

#include "capture/sphere_lights/light_position.h"
#include "capture/spheres/highlight_lobe.h"
#include "tests/support/ball_pictures.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;

const BallCamera kFar{{}, {400, 300}};
const BallCamera kNear{1200.0, {400, 300}};
const BallImage kBall{{620, 120}, 33, 0.05, 0.05};

TEST(BallGeometry, RaysToTheOutlineTouchTheBall) {
    for (const BallCamera& camera : {kFar, kNear})
        for (int i = 0; i < 12; ++i) {
            const dvec2 pixel = outline_point(kBall, camera, i * 0.5236);
            const dvec3 centre = centre_in_radius_units(kBall, camera), ray = camera.ray(pixel);
            const dvec3 from = camera.focal_px ? dvec3(0) : dvec3(pixel.x - 400, 300 - pixel.y, 0);
            EXPECT_NEAR(glm::length(glm::cross(ray, centre - from)), kBall.radius_px, 1e-3);
            EXPECT_NEAR(outside_px(kBall, camera, pixel), 0, 1e-3);
        }
}

TEST(BallGeometry, OutlineInPerspectiveIsLongerAwayFromTheMiddle) {
    const dvec2 outwards = glm::normalize(kBall.centre_px - kNear.principal_px);
    const double angle = std::atan2(-outwards.y, outwards.x);
    const double along =
        glm::length(outline_point(kBall, kNear, angle) - outline_point(kBall, kNear, angle + 3.14159265));
    const double across = glm::length(outline_point(kBall, kNear, angle + 1.5707963) -
                                      outline_point(kBall, kNear, angle - 1.5707963));
    EXPECT_GT(along, across + 0.5);
    EXPECT_NEAR(along / across,
                1 / std::cos(std::atan(glm::length(kBall.centre_px - kNear.principal_px) / 1200)), 2e-3);
}

TEST(BallGeometry, HighlightMirrorsItsLight) {
    Random random(5);
    for (const BallCamera& camera : {kFar, kNear})
        for (int i = 0; i < 50; ++i) {
            const dvec3 light(random.direction(0.1));
            const auto pixel = highlight_of_direction(kBall, camera, light);
            ASSERT_TRUE(pixel);
            const auto point = ball_point(kBall, camera, *pixel);
            ASSERT_TRUE(point);
            EXPECT_LT(degrees_between(point->mirrored(), light), 1e-4);
            const dvec3 lamp = centre_in_radius_units(kBall, camera) + 700.0 * light;
            const auto near_pixel = highlight_of_position(kBall, camera, lamp);
            ASSERT_TRUE(near_pixel);
            const auto near_point = ball_point(kBall, camera, *near_pixel);
            EXPECT_LT(degrees_between(near_point->mirrored(), lamp - near_point->position), 1e-4);
        }
}

TEST(BallGeometry, ErrorOfADirectionIsThatOfDifferences) {
    // At the ball's middle a highlight that is off by s turns the normal by s / R and the light by twice
    // that.
    BallImage ball = kBall;
    ball.centre_sigma_px = ball.radius_sigma_px = 0;
    EXPECT_NEAR(direction_sigma(ball, kFar, ball.centre_px, 0.2), 2 * 0.2 / 33, 1e-4);
    EXPECT_GT(direction_sigma(kBall, kFar, ball.centre_px + dvec2(25, 0), 0.2), 2 * 0.2 / 33);
}

TEST(BallGeometry, NothingIsSeenOfABallBesideIt) {
    EXPECT_FALSE(ball_point(kBall, kNear, kBall.centre_px + dvec2(60, 0)));
    EXPECT_FALSE(highlight_of_direction(kBall, kFar, {0, 0, -1}));
}

TEST(HighlightLobe, IsFoundThoughItsTopIsClipped) {
    for (const dvec2 centre : {dvec2(0.13, -0.41), dvec2(-0.3, 0.22)}) {
        std::vector<LobeSample> samples;
        for (int y = -6; y <= 6; ++y)
            for (int x = -6; x <= 6; ++x) {
                const double q = std::pow((x - centre.x) / 1.5, 2) + std::pow((y - centre.y) / 1.9, 2);
                samples.push_back({dvec2(x, y), std::min(1.0, 0.01 + 9 / std::pow(1 + q, 2))});
            }
        const auto lobe = fit_lobe(samples, {0, 0}, 2, 0.99, 1e-3);
        ASSERT_TRUE(lobe);
        EXPECT_LT(glm::length(lobe->centre_px - centre), 0.01);
        EXPECT_NEAR(lobe->peak, 9, 0.5);
        // Something bright beside it does not lead astray.
        for (LobeSample& sample : samples)
            if (sample.place_px.x < -3.5) sample.value = 0.8;
        const auto disturbed = fit_lobe(samples, {0, 0}, 2, 0.99, 1e-3);
        ASSERT_TRUE(disturbed);
        EXPECT_LT(glm::length(disturbed->centre_px - centre), 0.05);
    }
}

TEST(HighlightLobe, IsNotFoundInTooFewSamples) {
    EXPECT_FALSE(fit_lobe({{{0, 0}, 1}, {{1, 0}, 0.5}}, {0, 0}, 2, 0.99, 1e-3));
}

TEST(LightPosition, RaysMeetWhereTheyCameFrom) {
    const dvec3 lamp(100, -50, 400);
    std::vector<LightRay> rays;
    for (const dvec3 from : {dvec3(0), dvec3(90, 10, 0), dvec3(-20, 70, 5)})
        rays.push_back({from, glm::normalize(lamp - from), 0.01});
    const auto point = nearest_point(rays);
    ASSERT_TRUE(point);
    EXPECT_LT(glm::length(*point - lamp), 1e-6);
    for (LightRay& ray : rays) ray.direction = {0, 0, 1};
    EXPECT_FALSE(nearest_point(rays));  // parallel
    rays[0].direction = glm::normalize(dvec3(-1, 0, 1));
    rays[1].direction = glm::normalize(dvec3(1, 0, 1));
    rays.resize(2);
    EXPECT_FALSE(nearest_point(rays));  // meet behind the balls
}

// Highlights computed from lamps give those lamps back, with errors that fit the noise put in.
TEST(LightPosition, IsRecoveredWithHonestErrors) {
    Random random(3);
    PositionInput input{.camera = {1400.0, {350, 260}}, .ball_radius_mm = 12, .balls = {}, .highlights = {}};
    const std::vector<dvec3> centres = {{120, 80, -590}, {120, -70, -590}, {-110, 10, -590}};
    for (const dvec3& c : centres)
        input.balls.push_back(
            {{350 + 1400 * c.x / -c.z, 260 - 1400 * c.y / -c.z}, 1400 * 12 / -c.z, 0.05, 0.05});
    std::vector<dvec3> lamps;
    constexpr double sigma = 0.05;
    for (int i = 0; i < 20; ++i) {
        lamps.push_back(dvec3(0, 0, -600) + 550.0 * dvec3(random.direction(0.35)));
        input.highlights.emplace_back();
        for (std::size_t b = 0; b < centres.size(); ++b) {
            const auto pixel = highlight_of_position(input.balls[b], input.camera,
                                                     lamps.back() * (input.balls[b].radius_px / 12));
            ASSERT_TRUE(pixel);
            input.highlights.back().push_back(
                MeasuredHighlight{*pixel + sigma * dvec2(random.normal(), random.normal()), sigma});
        }
    }
    input.highlights[4][1].reset();
    input.highlights[7] = {std::nullopt, input.highlights[7][1], std::nullopt};
    const PositionResult result = lamp_positions(input);
    EXPECT_TRUE(result.converged);
    double squares = 0;
    int count = 0;
    for (std::size_t i = 0; i < lamps.size(); ++i) {
        EXPECT_EQ(result.lamps[i].has_value(), i != 7);
        if (!result.lamps[i]) continue;
        const dvec3 error = result.lamps[i]->position_mm - (lamps[i] - dvec3(0, 0, -590));
        squares += glm::dot(error, glm::inverse(result.lamps[i]->covariance_mm2) * error) / 3;
        ++count;
        EXPECT_LT(glm::length(error), 40);
    }
    EXPECT_GT(std::sqrt(squares / count), 0.5);
    EXPECT_LT(std::sqrt(squares / count), 1.6);
    EXPECT_NEAR(result.residual_sigma, 1, 0.4);
    // Nor need the focal length be known: rays turned by a wrong one do not meet.
    input.camera.focal_px.reset();
    input.inverse_focal = Known{0, 1e-3};
    const PositionResult unknown = lamp_positions(input);
    EXPECT_TRUE(unknown.converged);
    EXPECT_LT(unknown.inverse_focal.sigma, 0.1 / 1400);
    EXPECT_NEAR(unknown.inverse_focal.value, 1 / 1400.0, 3 * unknown.inverse_focal.sigma);
    EXPECT_GT(unknown.lamps[0]->covariance_mm2[2][2], result.lamps[0]->covariance_mm2[2][2]);
}

}  // namespace
}  // namespace tangi
