// colour_rows.h: transfer curves and CIEDE2000 of whole rows of pixels, on the lanes of vector registers:
// what Transfer and delta_e_2000() of surface/image/colour.h say of one.
#pragma once

#include <span>

#include "surface/image/colour.h"

namespace tangi {

// As a camera stores linear light, at most 1: min(transfer.encode(linear), 1) within 1e-6. `stored` may be
// `linear`.
void encode_row(const Transfer& transfer, std::span<const Rgb> linear, std::span<Rgb> stored);

// Linear light of stored values, those above 1 as 1: transfer.decode(min(stored, 1)) within 1e-6. `linear`
// may be `stored`.
void decode_row(const Transfer& transfer, std::span<const Rgb> stored, std::span<Rgb> linear);

// [1] CIEDE2000 of each pair of pixels, linear, clamped to [0, 1], against the white D65, within 1e-6 of it.
void delta_e_2000_row(std::span<const Rgb> a_linear, std::span<const Rgb> b_linear, std::span<float> delta_e);

}  // namespace tangi
