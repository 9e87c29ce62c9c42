// homography.h: plane projective maps between the pixels of two pictures.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace tangi {

// Acts on (x, y, 1); x runs right and y down, in pixels, with pixel centres at integers. glm stores columns.
using Homography = glm::dmat3;

inline glm::dvec2 mapped(const Homography& h, const glm::dvec2& p) {
    const glm::dvec3 q = h * glm::dvec3(p, 1);
    return glm::dvec2(q) / q.z;
}

// Of vectors in the plane: positive where b is turned clockwise from a, as seen in the picture.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// The same map, scaled so that its last element is 1.
inline Homography normalised(const Homography& h) { return h / h[2][2]; }

}  // namespace tangi
