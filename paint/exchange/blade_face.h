// blade_face.h: paint that a blade heaps up before it climbs its face, and stays there.
#pragma once

#include "paint/exchange/transfer.h"

namespace tangi {

// Paint that stands more than face_mm [mm], above 0, over the underside and over what is dry goes onto the
// blade, the part `rate` [1, 0..1] of it in this step, films and ingredients as they lie there, and as far as
// `open` allows; volume is conserved as in exchange(). Changes the box's paint and load where there are
// bristles.
void lift_onto_face(const StepBox& box, float face_mm, float rate);

}  // namespace tangi
