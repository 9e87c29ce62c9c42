// light_plausibility.h: whether photographs are shaded as lights in given directions would shade them.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "capture/registration/camera_motion.h"
#include "capture/stack/grey_photos.h"

namespace tangi {

struct ShadedCircle {
    glm::dvec2 centre_px{0, 0};  // of the whole photographs
    double radius_px = 0;
};

// A photograph divided by its median is, where the relief is gentle, 1 + slope . (l.x, l.y) / l.z (Horn 1977,
// linearised). How much of what changes from photograph to photograph these explain is compared with what
// they explain dealt out to the photographs at random, a permutation test (Fisher 1935): the part [1] of 99
// random deals that explain as much. Small: the directions tell something of where the lights were. Nothing
// of fewer than 8 photographs with a direction, or where hardly anything changes (a flat, even picture) or
// what changes is as dark as rounding and noise (a sphere before a black cloth). `without`: circles that are
// not looked at, as a sphere's own.
std::optional<double> chance_of_directions(const GreyPhotos& photos, const CameraMotions& drifts,
                                           std::span<const std::optional<glm::dvec3>> directions,
                                           std::span<const ShadedCircle> without);

constexpr double kLargestChance = 0.1;  // beyond which directions are not believed

}  // namespace tangi
