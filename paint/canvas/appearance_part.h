// appearance_part.h: a part of a painted canvas as a Surface, for what looks at some places of a large one.
#pragma once

#include "paint/canvas/appearance.h"

namespace tangi {

// What appearance() gives there, bit for bit; pixel (0, 0) is the part's upper left. Memory is that of the
// part. Throws ContractError where it is empty or not within the canvas.
Surface appearance_in(const Canvas& canvas, const Region& part, const AppearanceOptions& options = {});

// The same of its colour alone [rho_d, linear Rec. 709]: some rows at a time, so that memory is that of the
// result.
Image<Rgb> diffuse_in(const Canvas& canvas, const Region& part, const AppearanceOptions& options = {});

}  // namespace tangi
