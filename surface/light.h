// light.h: the lights of photographs and of relit pictures.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <string>

#include "surface/image.h"

namespace tangi {

// A distant light, or a near one where position_mm is set. Strength is relative to the exposure: a matt white
// surface (rho_d = 1) at the centre of the picture that faces the light has the linear value `gain`.
struct Light {
    std::string name;         // the photograph it belongs to, as its lights file names it; may be empty
    Vec3 direction{0, 0, 1};  // [unit vector] from the surface to the light, seen from the picture's centre
    std::optional<Vec3> position_mm{};  // [mm] of a near light; direction is its unit vector then
    Rgb gain{1, 1, 1};                  // [1] > 0
};

Light distant_light(const Vec3& direction, std::string name = {});  // normalises
Light near_light(const Vec3& position_mm, std::string name = {});

// Direction to the light and irradiance at a point of the painting, both as seen from there.
struct Incidence {
    Vec3 direction;  // [unit vector]
    Rgb irradiance;  // [1] that of a surface facing the light, in units of the exposure
};

// A near light falls off with the inverse square of the distance, and has `gain` at the origin.
inline Incidence incidence(const Light& light, const Vec3& point_mm) {
    if (!light.position_mm) return {light.direction, light.gain};
    const Vec3 to_light = *light.position_mm - point_mm;
    const float distance2 = glm::dot(to_light, to_light);
    const float falloff = glm::dot(*light.position_mm, *light.position_mm) / distance2;
    return {to_light / std::sqrt(distance2), light.gain * falloff};
}

}  // namespace tangi
