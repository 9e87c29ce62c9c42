// shading_induced_motion.h: the part of apparent motions that goes with the light.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace tangi {

// A camera does not know where the light is. Apparent motion that is a smooth function of the light's
// direction is what highlights and shadows do; of a camera's motion, such functions take up only their share.
struct SharedShading {
    std::vector<glm::dvec2> of_photo;  // [pixels] the smooth part, its mean left out
    std::vector<glm::dvec2> rest;      // [pixels] what is left of each photograph's motion
    double taken_up = 1;          // [1] by which the rest is smaller than what it is the rest of, typically
    double rms_px = 0;            // [pixels] of the smooth part
    bool exceeds_motion = false;  // the smooth part is larger than a camera's motion would have left there
};

// Robust least squares over the photographs that count. The number of smooth functions (1; with 7, as in
// Alignment, 3; with 14, 5; with 24, 8) follows the number of photographs.
SharedShading shared_shading(const std::vector<glm::dvec2>& shifts, const std::vector<glm::dvec3>& lights,
                             const std::vector<bool>& counted);

}  // namespace tangi
