// plane_pose.h: where the camera stands over a plane that it saw.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "surface/image/homography.h"

namespace tangi {

// The camera over a plane that is seen through a homography (plane, y up -> undistorted pixels), by focal
// length in pixels: Zhang 2000, "A flexible new technique for camera calibration", section 3.1.
struct PlanePose {
    glm::dmat3 turn{1};    // camera's frame (x right, y up, z away from the scene) -> the plane's
    glm::dvec3 camera{0};  // in the plane's frame and unit
    double tilt_deg = 0;   // between the camera's axis and the plane's normal
    double stretch = 1;    // [1] by which the plane looks longer across than down: 1 where all fits
};
PlanePose pose_of(const Homography& plane_to_picture, double focal_px, const glm::dvec2& principal_px);

}  // namespace tangi
