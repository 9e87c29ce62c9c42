// blade_face.h: paint that a blade heaps up before it climbs its face, and stays there.
#pragma once

#include "paint/transfer.h"

namespace tangi {

// What stands more than face_mm [mm] above the underside goes onto the blade, the part `rate` [1, 0..1] of it
// in this step, films and ingredients as they lie there; volume is conserved as in exchange(). Reads and
// changes the box's paint and load where there are bristles and `open` is more than 0.
void lift_onto_face(const StepBox& box, float face_mm, float rate);

}  // namespace tangi
