// low_confidence_fill.h: pixels of which the photographs hardly tell the slope, at last.
//
// In a crack under low lights a few photographs show some light, all from one side: a steep dark flank
// explains them, and so does a flat bottom in the shade. By itself such a pixel takes the first for granted;
// relit from above, it is a black dot, and height falls into it. What is around it knows better, as far as
// slopes there agree.
#pragma once

#include "surface/maps/surface.h"

namespace tangi {

// Where the standard error of the slope is above 0.15 (confidence below 0.3, but not 0) and the slope is off
// by more than 0.5 from those around, slope and
// reflectance become the mean of what was measured and of what pixels around that are surer say, by their
// variances; those without any of these within 6 pixels stay as they are, and so do confidences.
void fill_low_confidence(Surface& surface);

}  // namespace tangi
