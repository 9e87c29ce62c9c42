// sphere_lights.h: directions and positions of the lights from what mirror spheres show, and what contradicts
// what.
#pragma once

#include "capture/sphere_lights/sphere_focal.h"

namespace tangi {

// Fills lights, positions, camera and scale of `c`, whose spheres are known; what contradicts each other
// becomes poor, and part of the errors.
void lights_from_spheres(SphereCalibration& c, const SphereCalibrationOptions& options,
                         const FocalVerdict& verdict);

// A light's direction, unless it comes from below or is too uncertain.
void keep_direction(CalibratedLight& light, const glm::dvec3& direction, double sigma_rad);

}  // namespace tangi
