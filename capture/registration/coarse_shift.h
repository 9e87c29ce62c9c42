// coarse_shift.h: shifts of several pixels between pictures of one thing under different lights.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

// [pixels] What moves each picture (of local contrast) onto the first that is in the model, to about a pixel:
// by correlation of each with the four under the most similar lights, along the tree of the best links (Prim
// 1957), so that a picture of something else leads nowhere. Exactly 0 where no shift is much better than
// none.
std::vector<glm::dvec2> coarse_shifts(const std::vector<Image<float>>& pictures,
                                      const std::vector<glm::dvec3>& lights,
                                      const std::vector<bool>& in_model);

}  // namespace tangi
