#include "viewer/devices/head_tracking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tangi {

namespace {

// Tangents of the direction to a place of the picture, right and up in the room.
glm::dvec2 tangents(const glm::dvec2& at, double camera_width_deg) {
    return -2 * std::tan(camera_width_deg / 2 * std::numbers::pi / 180) * at;
}

}  // namespace

Vec3 direction_in_room(const glm::dvec2& at, double camera_width_deg) {
    return Vec3(glm::normalize(glm::dvec3(tangents(at, camera_width_deg), 1)));
}

std::optional<FaceBox> followed(const std::vector<FaceBox>& faces, const std::optional<FaceBox>& before) {
    if (faces.empty()) return {};
    if (before) {
        const auto nearest =
            std::min_element(faces.begin(), faces.end(), [&](const FaceBox& a, const FaceBox& b) {
                return glm::distance(a.at, before->at) < glm::distance(b.at, before->at);
            });
        if (glm::distance(nearest->at, before->at) < before->width) return *nearest;
    }
    return *std::max_element(faces.begin(), faces.end(),
                             [](const FaceBox& a, const FaceBox& b) { return a.width < b.width; });
}

Vec3 HeadFollower::see(const std::optional<FaceBox>& face, double time_s) {
    if (!face) return direction_;
    const glm::dvec2 now = tangents(face->at, kCameraWidth_deg);
    if (!neutral_) neutral_ = now;
    direction_ = Vec3(glm::normalize(glm::dvec3(smooth_(now - *neutral_, time_s), 1)));
    return direction_;
}

void HeadFollower::recentre() {
    neutral_.reset();
    smooth_ = OneEuro(1.0, 8.0);
}

}  // namespace tangi
