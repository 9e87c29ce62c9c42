#include "surface/maps/light.h"

#include <cmath>

#include "surface/base/error.h"

namespace tangi {

float Beam::part(const Vec3& p) const {
    return std::exp(terms[0] * p.x + terms[1] * p.y + terms[2] * p.x * p.x + terms[3] * p.x * p.y +
                    terms[4] * p.y * p.y);
}

Light distant_light(const Vec3& direction, std::string name) {
    const float length = glm::length(direction);
    TP_REQUIRE(length > 0, "a light needs a direction");
    return {.name = std::move(name), .direction = direction / length};
}

Light near_light(const Vec3& position_mm, std::string name) {
    Light light = distant_light(position_mm, std::move(name));
    light.position_mm = position_mm;
    return light;
}

namespace {

// Turned about an axis in the plane of the picture, by an angle that grows with the distance from its centre.
Vec3 bent(const Vec3& v, const Vec3& point_mm, float bend_per_mm) {
    const float rx = bend_per_mm * point_mm.x, ry = bend_per_mm * point_mm.y;
    const Vec3 turned(v.x + rx * v.z, v.y + ry * v.z, v.z - rx * v.x - ry * v.y);
    return turned * (glm::length(v) / glm::length(turned));
}

}  // namespace

Incidence incidence(const Light& light, const Vec3& point_mm, const Rig& rig) {
    const bool bends = rig.bend_per_mm != 0;
    const Rgb gain = light.beam.even() ? light.gain : light.gain * light.beam.part(point_mm);
    if (!light.position_mm)
        return {bends ? bent(light.direction, point_mm, rig.bend_per_mm) : light.direction, gain};
    const Vec3 position = bends ? bent(*light.position_mm, point_mm, rig.bend_per_mm) : *light.position_mm;
    const Vec3 to_light = position - point_mm;
    const float distance2 = glm::dot(to_light, to_light);
    const float falloff = glm::dot(position, position) / distance2;
    return {to_light / std::sqrt(distance2), gain * falloff};
}

void place(Light& light, const Rig& rig) {
    if (!rig.light_distance_mm) return;
    const float listed = *rig.light_distance_mm;
    light.position_mm = light.direction * listed;
    if (rig.surface_above_mm == 0) return;
    light.position_mm->z -= rig.surface_above_mm;
    const float distance = glm::length(*light.position_mm);
    light.direction = *light.position_mm / distance;
    light.gain *= listed * listed / (distance * distance);
}

}  // namespace tangi
