// tilt.h: a painting held in the hand: how far it is turned about x and y, and how it goes on turning.
//
// Thesis eq. 3.10 to 3.13: R = Rx(x) Ry(y) Rz(z). x right, y up, z towards the viewer; turning about x by a
// positive angle brings the upper edge nearer.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace tangi {

glm::dmat3 rotation_x(double rad);
glm::dmat3 rotation_y(double rad);
glm::dmat3 rotation_z(double rad);
glm::dmat3 rotation_xyz(double x_rad, double y_rad, double z_rad);  // eq. 3.13

struct Tilt {
    static constexpr double kMost_deg = 75;  // seen from farther aside, a painting is a line

    glm::dvec2 angle_deg{0};        // about x, about y
    glm::dvec2 speed_deg_per_s{0};  // while nobody holds it
    bool returning = false;         // on its way back to 0, 0

    glm::dmat3 rotation() const;
    bool moves() const;
};

// Follows the hand: dragging over the height of the window turns by 120 degrees. `dx`, `dy`: parts of that
// height, right and down; `seconds` since the last call, for the speed it has when it is let go.
Tilt dragged(Tilt tilt, double dx, double dy, double seconds);

// Let go: goes on, slower by half every 0.15 s; or returns to 0, half of the way every 0.06 s.
Tilt advanced(Tilt tilt, double seconds);

Tilt held(Tilt tilt);       // stops
Tilt sent_back(Tilt tilt);  // begins to return to 0, 0

}  // namespace tangi
