// homography.h: plane projective maps between the pixels of two pictures.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

namespace tangi {

using Corners = std::array<glm::dvec2, 4>;  // [px] top left, top right, bottom right, bottom left

// Acts on (x, y, 1); x runs right and y down, in pixels, with pixel centres at integers. glm stores columns.
using Homography = glm::dmat3;

inline glm::dvec2 mapped(const Homography& h, const glm::dvec2& p) {
    const glm::dvec3 q = h * glm::dvec3(p, 1);
    return glm::dvec2(q) / q.z;
}

// Of vectors in the plane: positive where b is turned clockwise from a, as seen in the picture.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// The map that takes four points to four others. ContractError where three of either lie on a line.
Homography homography_between(const Corners& from, const Corners& to);

// Least squares of the distances in the target, from four points on; nothing where they lie on a line. With
// `stray` > 0, through the largest set of points found that are no farther off than that (RANSAC, Fischler
// and Bolles 1981; the same choices each time).
std::optional<Homography> homography_through(std::span<const glm::dvec2> from, std::span<const glm::dvec2> to,
                                             double stray = 0);

// The same map, scaled so that its last element is 1.
inline Homography normalised(const Homography& h) { return h / h[2][2]; }

}  // namespace tangi
