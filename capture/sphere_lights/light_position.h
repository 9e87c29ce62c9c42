// light_position.h: where a light is, from its reflections in two or more mirror spheres of one radius, and
// how wide the camera sees, which the reflections tell as well.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "capture/spheres/sphere_geometry.h"

namespace tangi {

struct MeasuredHighlight {
    glm::dvec2 place_px{0, 0};
    double sigma_px = 0.1;
};

struct PositionInput {
    SphereCamera camera;  // with which the spheres were measured; without a focal length they are far away
    double sphere_radius_mm = 1;
    std::vector<SphereImage> spheres;
    std::vector<std::vector<std::optional<MeasuredHighlight>>> highlights;  // [photograph][sphere]
    // [1/px] What is known of 1 / focal length beforehand. Empty: it is that of `camera`.
    std::optional<Known> inverse_focal{};
    // [mm] How far below the camera the spheres' centres lie, where it is known.
    std::optional<Known> depth_mm{};
};

struct LocatedLight {
    glm::dvec3 position_mm{0};  // spheres' frame
    glm::dmat3 covariance_mm2{0};
    double residual_px = 0;  // rms of the highlights
};

// In the spheres' frame: axes of the camera frame, but z = 0 where the spheres lie, straight below the
// camera.
struct PositionResult {
    std::vector<std::optional<LocatedLight>>
        lights;                                 // nothing for photographs with fewer than two highlights
    std::vector<glm::dvec3> sphere_centres_mm;  // refined
    Known inverse_focal;                        // [1/px] refined
    double px_per_mm = 1;                       // at z = 0
    double residual_px = 0;                     // rms of all highlights
    double residual_sigma = 0;  // rms in units of what was expected: 1 where the standard errors are right
    double cost = 0;            // half the sum of squares, robust
    bool converged = false;

    // [1/mm] 1 / distance of the camera from z = 0; 0: far away.
    double inverse_distance_mm() const { return inverse_focal.value * px_per_mm; }
};

// The reflected rays are intersected by least squares; from there lights, spheres and the camera's focal
// length and distance are moved together until the highlights are where they were seen, as a bundle
// adjustment (Triggs et al. 2000), with the outlines, and with what else is known, as prior knowledge. The
// spheres are taken to lie in one plane, to a twentieth of their radius. Errors are those of the least
// squares, enlarged by residual_sigma where that is above 1.
//
// Why highlights tell the focal length: seen at an angle t from the middle, a sphere turns all that it
// reflects by t. Rays of spheres on either side, turned apart by the wrong angle, no longer meet.
PositionResult light_positions(const PositionInput& input);

// Point nearest to all rays, weighted with 1 / (sigma_rad * distance)^2 once the distance is known. Nothing
// where they are parallel or meet behind their origins.
struct LightRay {
    glm::dvec3 origin{0}, direction{0, 0, 1};
    double sigma_rad = 0.01;
};
std::optional<glm::dvec3> nearest_point(std::span<const LightRay> rays);

}  // namespace tangi
