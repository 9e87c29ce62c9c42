#include "viewer/render/tilt.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

namespace tangi {

namespace {

constexpr double kDegreesPerHeight = 120;
constexpr double kHalfSpeed_s = 0.15, kHalfWay_s = 0.06;
constexpr double kStill_deg_per_s = 1, kThere_deg = 0.05;

glm::dvec2 within_reach(const glm::dvec2& angle) {
    return glm::clamp(angle, glm::dvec2(-Tilt::kMost_deg), glm::dvec2(Tilt::kMost_deg));
}

}  // namespace

// glm's matrices are written column by column.
glm::dmat3 rotation_x(double a) {
    return {{1, 0, 0}, {0, std::cos(a), std::sin(a)}, {0, -std::sin(a), std::cos(a)}};
}
glm::dmat3 rotation_y(double a) {
    return {{std::cos(a), 0, -std::sin(a)}, {0, 1, 0}, {std::sin(a), 0, std::cos(a)}};
}
glm::dmat3 rotation_z(double a) {
    return {{std::cos(a), std::sin(a), 0}, {-std::sin(a), std::cos(a), 0}, {0, 0, 1}};
}
glm::dmat3 rotation_xyz(double x, double y, double z) {
    return rotation_x(x) * rotation_y(y) * rotation_z(z);
}

glm::dmat3 Tilt::rotation() const {
    return rotation_xyz(glm::radians(angle_deg.x), glm::radians(angle_deg.y), 0);
}

bool Tilt::moves() const { return returning || speed_deg_per_s != glm::dvec2(0); }

Tilt dragged(Tilt tilt, double dx, double dy, double seconds) {
    const glm::dvec2 turn = kDegreesPerHeight * glm::dvec2(dy, dx);
    tilt.angle_deg = within_reach(tilt.angle_deg + turn);
    // The hand's speed of the last tenth of a second.
    const double weight = std::clamp(seconds / 0.1, 0.0, 1.0);
    if (seconds > 0) tilt.speed_deg_per_s += weight * (turn / seconds - tilt.speed_deg_per_s);
    tilt.returning = false;
    return tilt;
}

Tilt advanced(Tilt tilt, double seconds) {
    if (tilt.returning) {
        tilt.angle_deg *= std::exp2(-seconds / kHalfWay_s);
        if (glm::length(tilt.angle_deg) < kThere_deg) tilt = {};
        return tilt;
    }
    // The integral of a speed that halves every kHalfSpeed_s: the same for any number of frames.
    const double slower = std::exp2(-seconds / kHalfSpeed_s);
    const glm::dvec2 wanted =
        tilt.angle_deg + tilt.speed_deg_per_s * (kHalfSpeed_s / std::numbers::ln2 * (1 - slower));
    tilt.angle_deg = within_reach(wanted);
    tilt.speed_deg_per_s *= slower;
    for (int axis = 0; axis < 2; ++axis)
        if (tilt.angle_deg[axis] != wanted[axis]) tilt.speed_deg_per_s[axis] = 0;
    if (glm::length(tilt.speed_deg_per_s) < kStill_deg_per_s) tilt.speed_deg_per_s = glm::dvec2(0);
    return tilt;
}

Tilt held(Tilt tilt) {
    tilt.speed_deg_per_s = glm::dvec2(0);
    tilt.returning = false;
    return tilt;
}

Tilt sent_back(Tilt tilt) {
    tilt.speed_deg_per_s = glm::dvec2(0);
    tilt.returning = tilt.angle_deg != glm::dvec2(0);
    return tilt;
}

}  // namespace tangi
