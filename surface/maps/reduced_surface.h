// reduced_surface.h: a surface in half the pixels a side: the next level of detail of its maps.
#pragma once

#include "surface/maps/surface.h"

namespace tangi {

// Each pixel stands for 2 x 2, as MeanMaterial has it (material.h). Width and height are halved and rounded
// up: the last column or row of an odd number stands for itself. mm_per_pixel is doubled; numbers and words
// are those of the surface.
Surface halved(const Surface& surface);

}  // namespace tangi
