// flat_patches.h: places of one colour, roughly rectangular: what the patches of a chart look like.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

struct FlatPatch {
    glm::dvec2 centre_px{0, 0};  // centroid
    double width_px = 0;  // square root of the area that is flat, one or two pixels less than the patch's
};

// Connected regions in which no pixel differs much from its neighbours, at several limits, that fill a
// rectangle, from `smallest_px` wide up to a sixth of the picture. In no particular order; the same region is
// there once.
std::vector<FlatPatch> flat_patches(const Image<Rgb>& linear, double smallest_px);

}  // namespace tangi
