// light.h: the lights of photographs and of relit pictures.
#pragma once

#include <array>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <optional>
#include <string>

#include "surface/image/image.h"

namespace tangi {

constexpr double kDegrees = 180 / std::numbers::pi;  // in a radian

// How unevenly a light lights the picture beyond what its distance makes of it (a reflector's hot spot, a
// light that is aimed beside the middle): ln of the irradiance is a polynomial of the second degree of the
// place, 0 at the origin.
struct Beam {
    std::array<float, 5> terms{};  // [1/mm, 1/mm, 1/mm^2, 1/mm^2, 1/mm^2] of x, y, x^2, x y, y^2

    bool even() const { return terms == std::array<float, 5>{}; }
    // [1] Irradiance at a place of the painting's plane over that of an even beam. Only of use where the
    // light was measured: inside the picture.
    float part(const Vec3& point_mm) const;

    friend bool operator==(const Beam&, const Beam&) = default;
};

// A distant light, or a near one where position_mm is set. Strength is relative to the exposure: a matt white
// surface (rho_d = 1) at the centre of the picture that faces the light has the linear value `gain`.
struct Light {
    std::string name;         // the photograph it belongs to, as its lights file names it; may be empty
    Vec3 direction{0, 0, 1};  // [unit vector] from the surface to the light, seen from the picture's centre
    std::optional<Vec3> position_mm{};  // [mm] of a near light; direction is its unit vector then
    Rgb gain{1, 1, 1};                  // [1] > 0
    Beam beam{};
};

Light distant_light(const Vec3& direction, std::string name = {});  // normalises
Light near_light(const Vec3& position_mm, std::string name = {});

// What all photographs of a stack have in common beside the painting.
struct Rig {
    static constexpr float kPointLight_deg = 0.25f;  // of a small light at some distance

    // [1] Light from all around (the room, the dome, the relief itself), as a part of the light's: a matt
    // surface shows rho_d (max(n.l, 0) + ambient).
    float ambient = 0;
    // [mm] The camera's height above the painting's plane; far away where empty.
    std::optional<float> camera_distance_mm{};
    // [mm] x and y of the camera: where it looks straight down, it sees this point in the picture's middle.
    glm::vec2 camera_axis_mm{0, 0};
    // [mm] Of lights whose own position is not known, from the origin; far away where empty.
    std::optional<float> light_distance_mm{};
    // [mm] How high the painting's surface is above the point that their directions and distance are from.
    float surface_above_mm = 0;
    // [1/mm] Directions turn by this angle for each mm from the centre, as if the painting were bent: the
    // part of the lights' field of directions that photographs of a matt painting cannot tell from a bulge.
    float bend_per_mm = 0;
    // [deg] Angular radius of the lights, as seen from the painting: how soft the shadows are that they cast.
    float light_radius_deg = kPointLight_deg;

    friend bool operator==(const Rig&, const Rig&) = default;
};

// Direction to the light and irradiance at a point of the painting, both as seen from there.
struct Incidence {
    Vec3 direction;  // [unit vector]
    Rgb irradiance;  // [1] that of a surface facing the light, in units of the exposure
};

// A near light falls off with the inverse square of the distance; all have `gain` at the origin, times the
// part of their beam elsewhere.
Incidence incidence(const Light& light, const Vec3& point_mm, const Rig& rig = {});

// Puts a light of which only the direction is known where the rig says that it is: position, direction from
// the origin, and gain, since lights that are as strong light what is nearer to them more. Far lights stay.
void place(Light& light, const Rig& rig);

// [unit vector] from a point of the painting to the camera.
inline Vec3 view_direction(const Rig& rig, const Vec3& point_mm) {
    if (!rig.camera_distance_mm) return {0, 0, 1};
    return glm::normalize(Vec3(rig.camera_axis_mm, *rig.camera_distance_mm) - point_mm);
}

}  // namespace tangi
