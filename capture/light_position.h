// light_position.h: where a lamp is, from its reflections in two or more mirror balls of known radius.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "capture/ball_geometry.h"

namespace tangi {

struct MeasuredHighlight {
    glm::dvec2 place_px{0, 0};
    double sigma_px = 0.1;
};

struct PositionInput {
    BallCamera camera;  // without a focal length the balls are taken to lie in one plane
    double ball_radius_mm = 1;
    std::vector<BallImage> balls;
    std::vector<std::vector<std::optional<MeasuredHighlight>>> highlights;  // [photograph][ball]
    // [mm] Depth of the balls' centres in the camera frame (z < 0) and its standard error, where it is known.
    std::optional<double> depth_mm{};
    double depth_sigma_mm = 0.5;
};

struct LampPosition {
    glm::dvec3 position_mm{0};  // camera frame
    glm::dmat3 covariance_mm2{0};
    double residual_px = 0;  // rms of the highlights
};

struct PositionResult {
    std::vector<std::optional<LampPosition>>
        lamps;                                // nothing for photographs with fewer than two highlights, or
                                              // where the rays do not meet in front of the balls
    std::vector<glm::dvec3> ball_centres_mm;  // camera frame, refined
    double residual_px = 0;                   // rms of all highlights
    double residual_sigma = 0;  // rms in units of what was expected: 1 where the standard errors are right
    bool converged = false;
};

// The reflected rays are intersected by least squares; from there lamps and balls are moved together until
// the highlights are where they were seen, as a bundle adjustment (Triggs et al. 2000), with the outlines as
// what is known of the balls beforehand. Errors are those of the least squares, enlarged by residual_sigma
// where that is above 1.
PositionResult lamp_positions(const PositionInput& input);

// Point nearest to all rays, weighted with 1 / (sigma_rad * distance)^2 once the distance is known. Nothing
// where they are parallel or meet behind their origins.
struct LightRay {
    glm::dvec3 origin{0}, direction{0, 0, 1};
    double sigma_rad = 0.01;
};
std::optional<glm::dvec3> nearest_point(std::span<const LightRay> rays);

}  // namespace tangi
