#include "capture/geometry/plane_pose.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "surface/base/error.h"

namespace tangi {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

PlanePose pose_of(const Homography& plane_to_picture, double focal_px, const dvec2& principal_px) {
    // To the camera's frame with y up and z away from the scene: K^-1, then both turned round.
    const dmat3 k_inverse(1 / focal_px, 0, 0, 0, -1 / focal_px, 0, -principal_px.x / focal_px,
                          principal_px.y / focal_px, -1);
    dmat3 h = k_inverse * plane_to_picture;
    if (h[2].z > 0) h = -h;  // the plane lies before the camera
    const double across = glm::length(h[0]), up = glm::length(h[1]);
    // The two unit vectors at right angles that are nearest to the columns.
    const dvec3 a = h[0] / across, b = h[1] / up;
    const dvec3 sum = glm::normalize(a + b), difference = glm::normalize(a - b);
    const dvec3 x = (sum + difference) / std::numbers::sqrt2, y = (sum - difference) / std::numbers::sqrt2;
    const dmat3 plane_to_camera(x, y, glm::cross(x, y));
    const dvec3 origin = h[2] * (2 / (across + up));
    PlanePose pose;
    pose.turn = glm::transpose(plane_to_camera);
    pose.camera = -(pose.turn * origin);
    if (!(pose.camera.z > 0))
        fail("--rectify: the painting's plane is seen from behind; are its corners mirrored?");
    pose.tilt_deg = std::acos(std::clamp(plane_to_camera[2].z, -1.0, 1.0)) * (180 / std::numbers::pi);
    pose.stretch = across / up;
    return pose;
}

}  // namespace tangi
