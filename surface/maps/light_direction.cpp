#include "surface/maps/light_direction.h"

#include <glm/geometric.hpp>

namespace tangi {

TangentFrame tangent_frame(const glm::dvec3& d) {
    const double s = 1 / (1 + d.z);
    return {{1 - d.x * d.x * s, -d.x * d.y * s, -d.x}, {-d.x * d.y * s, 1 - d.y * d.y * s, -d.y}};
}

glm::dvec3 turned(const glm::dvec3& direction, const glm::dvec2& t) {
    const TangentFrame frame = tangent_frame(direction);
    return glm::normalize(direction + t.x * frame.a + t.y * frame.b);
}

glm::dvec2 turn_between(const glm::dvec3& direction, const glm::dvec3& to) {
    const TangentFrame frame = tangent_frame(direction);
    return glm::dvec2(glm::dot(to, frame.a), glm::dot(to, frame.b)) / glm::dot(to, direction);
}

}  // namespace tangi
