// Spheres as a camera sees them: tangents, reflection, and the way back.
#include "capture/spheres/sphere_geometry.h"

#include <gtest/gtest.h>

#include "capture/sphere_lights/light_position.h"
#include "capture/spheres/highlight_lobe.h"
#include "tests/support/capture/sphere_pictures.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;

const SphereCamera kFar{{}, {400, 300}};
const SphereCamera kNear{1200.0, {400, 300}};
const SphereImage kSphere{{620, 120}, 33, 0.05, 0.05};

TEST(SphereGeometry, RaysToTheOutlineTouchTheSphere) {
    for (const SphereCamera& camera : {kFar, kNear})
        for (int i = 0; i < 12; ++i) {
            const dvec2 pixel = outline_point(kSphere, camera, i * 0.5236);
            const dvec3 centre = centre_in_radius_units(kSphere, camera), ray = camera.ray(pixel);
            const dvec3 from = camera.focal_px ? dvec3(0) : dvec3(pixel.x - 400, 300 - pixel.y, 0);
            EXPECT_NEAR(glm::length(glm::cross(ray, centre - from)), kSphere.radius_px, 1e-3);
            EXPECT_NEAR(outside_px(kSphere, camera, pixel), 0, 1e-3);
        }
}

TEST(SphereGeometry, OutlineInPerspectiveIsLongerAwayFromTheMiddle) {
    const dvec2 outwards = glm::normalize(kSphere.centre_px - kNear.principal_px);
    const double angle = std::atan2(-outwards.y, outwards.x);
    const double along =
        glm::length(outline_point(kSphere, kNear, angle) - outline_point(kSphere, kNear, angle + 3.14159265));
    const double across = glm::length(outline_point(kSphere, kNear, angle + 1.5707963) -
                                      outline_point(kSphere, kNear, angle - 1.5707963));
    EXPECT_GT(along, across + 0.5);
    EXPECT_NEAR(along / across,
                1 / std::cos(std::atan(glm::length(kSphere.centre_px - kNear.principal_px) / 1200)), 2e-3);
}

TEST(SphereGeometry, HighlightMirrorsItsLight) {
    Random random(5);
    for (const SphereCamera& camera : {kFar, kNear})
        for (int i = 0; i < 50; ++i) {
            const dvec3 light(random.direction(0.1));
            const auto pixel = highlight_of_direction(kSphere, camera, light);
            ASSERT_TRUE(pixel);
            const auto point = sphere_point(kSphere, camera, *pixel);
            ASSERT_TRUE(point);
            EXPECT_LT(degrees_between(point->mirrored(), light), 1e-4);
            const dvec3 near = centre_in_radius_units(kSphere, camera) + 700.0 * light;
            const auto near_pixel = highlight_of_position(kSphere, camera, near);
            ASSERT_TRUE(near_pixel);
            const auto near_point = sphere_point(kSphere, camera, *near_pixel);
            EXPECT_LT(degrees_between(near_point->mirrored(), near - near_point->position), 1e-4);
        }
}

TEST(SphereGeometry, ErrorOfADirectionIsThatOfDifferences) {
    // At the sphere's middle a highlight that is off by s turns the normal by s / R and the light by twice
    // that.
    SphereImage sphere = kSphere;
    sphere.centre_sigma_px = sphere.radius_sigma_px = 0;
    EXPECT_NEAR(direction_sigma(sphere, kFar, sphere.centre_px, 0.2), 2 * 0.2 / 33, 1e-4);
    EXPECT_GT(direction_sigma(kSphere, kFar, sphere.centre_px + dvec2(25, 0), 0.2), 2 * 0.2 / 33);
}

TEST(SphereGeometry, NothingIsSeenOfASphereBesideIt) {
    EXPECT_FALSE(sphere_point(kSphere, kNear, kSphere.centre_px + dvec2(60, 0)));
    EXPECT_FALSE(highlight_of_direction(kSphere, kFar, {0, 0, -1}));
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
    const dvec3 light(100, -50, 400);
    std::vector<LightRay> rays;
    for (const dvec3 from : {dvec3(0), dvec3(90, 10, 0), dvec3(-20, 70, 5)})
        rays.push_back({from, glm::normalize(light - from), 0.01});
    const auto point = nearest_point(rays);
    ASSERT_TRUE(point);
    EXPECT_LT(glm::length(*point - light), 1e-6);
    for (LightRay& ray : rays) ray.direction = {0, 0, 1};
    EXPECT_FALSE(nearest_point(rays));  // parallel
    rays[0].direction = glm::normalize(dvec3(-1, 0, 1));
    rays[1].direction = glm::normalize(dvec3(1, 0, 1));
    rays.resize(2);
    EXPECT_FALSE(nearest_point(rays));  // meet behind the spheres
}

// Highlights computed from lights give those lights back, with errors that fit the noise put in.
TEST(LightPosition, IsRecoveredWithHonestErrors) {
    Random random(3);
    PositionInput input{
        .camera = {1400.0, {350, 260}}, .sphere_radius_mm = 12, .spheres = {}, .highlights = {}};
    const std::vector<dvec3> centres = {{120, 80, -590}, {120, -70, -590}, {-110, 10, -590}};
    for (const dvec3& c : centres)
        input.spheres.push_back(
            {{350 + 1400 * c.x / -c.z, 260 - 1400 * c.y / -c.z}, 1400 * 12 / -c.z, 0.05, 0.05});
    std::vector<dvec3> lights;
    constexpr double sigma = 0.05;
    for (int i = 0; i < 20; ++i) {
        lights.push_back(dvec3(0, 0, -600) + 550.0 * dvec3(random.direction(0.35)));
        input.highlights.emplace_back();
        for (std::size_t b = 0; b < centres.size(); ++b) {
            const auto pixel = highlight_of_position(input.spheres[b], input.camera,
                                                     lights.back() * (input.spheres[b].radius_px / 12));
            ASSERT_TRUE(pixel);
            input.highlights.back().push_back(
                MeasuredHighlight{*pixel + sigma * dvec2(random.normal(), random.normal()), sigma});
        }
    }
    input.highlights[4][1].reset();
    input.highlights[7] = {std::nullopt, input.highlights[7][1], std::nullopt};
    const PositionResult result = light_positions(input);
    EXPECT_TRUE(result.converged);
    double squares = 0;
    int count = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        EXPECT_EQ(result.lights[i].has_value(), i != 7);
        if (!result.lights[i]) continue;
        const dvec3 error = result.lights[i]->position_mm - (lights[i] - dvec3(0, 0, -590));
        squares += glm::dot(error, glm::inverse(result.lights[i]->covariance_mm2) * error) / 3;
        ++count;
        EXPECT_LT(glm::length(error), 40);
    }
    EXPECT_GT(std::sqrt(squares / count), 0.5);
    EXPECT_LT(std::sqrt(squares / count), 1.6);
    EXPECT_NEAR(result.residual_sigma, 1, 0.4);
    // Nor need the focal length be known: rays turned by a wrong one do not meet.
    input.camera.focal_px.reset();
    input.inverse_focal = Known{0, 1e-3};
    const PositionResult unknown = light_positions(input);
    EXPECT_TRUE(unknown.converged);
    EXPECT_LT(unknown.inverse_focal.sigma, 0.1 / 1400);
    EXPECT_NEAR(unknown.inverse_focal.value, 1 / 1400.0, 3 * unknown.inverse_focal.sigma);
    EXPECT_GT(unknown.lights[0]->covariance_mm2[2][2], result.lights[0]->covariance_mm2[2][2]);
}

}  // namespace
}  // namespace tangi
