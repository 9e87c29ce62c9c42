// step_rates.h: how fast paint goes between brush and canvas in one step, from the brush's settings, how it
// is pressed, and what paint is like.
#pragma once

#include "paint/brush/brush.h"
#include "paint/exchange/transfer.h"

namespace tangi {

// The paint itself, under a brush that rests.
TransferRates rates_of(const BrushSettings& settings, double mm_per_pixel);

// And one step of the brush in it.
TransferRates rates_of(const Brush& brush, const Dab& dab, double mm_per_pixel);

}  // namespace tangi
