// light_direction.h: directions of lights that differ a little from others, in the plane that touches the
// sphere of directions.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace tangi {

struct TangentFrame {
    // [unit vectors] Across the direction: the x and y axes carried from the zenith to it along the great
    // circle, so that they are smooth over the whole hemisphere.
    glm::dvec3 a, b;
};
TangentFrame tangent_frame(const glm::dvec3& direction);

// direction + t.x a + t.y b, as a unit vector; t [1]: tangents of angles. `direction` is above the painting.
glm::dvec3 turned(const glm::dvec3& direction, const glm::dvec2& t);

// The t by which turned(direction, t) is `to`, less than 90 degrees away.
glm::dvec2 turn_between(const glm::dvec3& direction, const glm::dvec3& to);

}  // namespace tangi
