// light_sweep.h: the way of a light over a painting.
#pragma once

#include <vector>

#include "viewer/render/view.h"

namespace tangi {

// Where the light stands in each of `frames` pictures (1 or more) on its way from corner to corner, straight
// in azimuth and elevation and equally fast on the dome. One corner: once round, counter-clockwise. A way
// that ends where it began can be shown again and again: the last picture is not the first.
std::vector<Angles> sweep_path(std::vector<Angles> corners, int frames);

}  // namespace tangi
