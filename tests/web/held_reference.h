// held_reference.h: what a page shows of a painting while its screen is held at an angle, by the reference
// renderer.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "surface/render/relight.h"
#include "viewer/render/tilt.h"
#include "viewer/render/view.h"

namespace tangi {

// The screen now -> the screen when it was level, of a device that stood at alpha = beta = gamma = 0 then:
// W3C's turns about z, x and y (thesis eq. 3.10 to 3.13), and the turn of what the screen shows [degrees].
inline glm::dmat3 held_screen(double alpha, double beta, double gamma, double screen_angle = 0) {
    const auto rad = [](double deg) { return deg * std::numbers::pi / 180; };
    const glm::dmat3 device = rotation_z(rad(alpha)) * rotation_x(rad(beta)) * rotation_y(rad(gamma));
    return rotation_z(rad(screen_angle)) * device * rotation_z(-rad(screen_angle));
}

// Linear, without ambient light: one pixel as one, from an eye that stands `distance_mm` before the level
// screen's middle. The light and the eye stay where they are in the room.
inline Image<Rgb> reference_held(const Surface& s, const Vec3& light, double distance_mm,
                                 const glm::dmat3& held) {
    const glm::dmat3 in_painting = glm::transpose(held);
    const Vec3 from(in_painting * glm::dvec3(light));
    const glm::dvec3 eye = in_painting * glm::dvec3(0, 0, distance_mm);
    Image<Rgb> picture(s.width(), s.height());
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            const Vec3 view(glm::normalize(eye - glm::dvec3(s.point_mm(x, y))));
            picture(x, y) = glm::clamp(reflected(s, x, y, from, view, WardModel::bounded), 0.0f, 1.0f);
        }
    return picture;
}

}  // namespace tangi
