// light_direction_field.h: small corrections of the lights' directions, and which of them photographs can
// tell.
//
// A correction is a turn t of surface/maps/light_direction.h.
//
// What photographs cannot tell: a matt painting under lights A^-T l is a painting with normals A n, for any
// invertible A (Hayakawa 1994; Belhumeur, Kriegman & Yuille 1999), as far as the lights' strengths are free.
// Small A are eight motions of all directions together: three rotations, and five shears. They are fixed by
// keeping the part of the corrections along them zero: as a whole, the directions are taken as they are
// listed. Where strengths are known, only the rotations are left in doubt.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "surface/maps/light_direction.h"

namespace tangi {

// Smooth fields of turns over direction: polynomials of the direction's x and y up to the second degree in
// both components, without what they have of the motions that photographs cannot tell, in `lights` taken
// together. Each has rms 1 over the lights, and they are orthogonal there.
class DirectionField {
public:
    static constexpr std::size_t kPolynomials = 12;  // of which the field is made, at most

    DirectionField() = default;
    DirectionField(const std::vector<glm::dvec3>& lights, bool strengths_known);

    int modes() const { return static_cast<int>(modes_.size()); }
    // The turns of each of the fields at this direction.
    std::vector<glm::dvec2> at(const glm::dvec3& direction) const;
    // Their sum with these coefficients; none: no turn.
    glm::dvec2 turn(const std::vector<double>& coefficients, const glm::dvec3& direction) const;

    // The turns at this direction of the motions that photographs cannot tell.
    std::vector<glm::dvec2> untold(const glm::dvec3& direction) const;

private:
    bool strengths_known_ = false;
    std::vector<std::array<double, kPolynomials>> modes_;    // of polynomials ...
    std::vector<std::array<double, kPolynomials>> motions_;  // ... less what these have of each motion
};

}  // namespace tangi
