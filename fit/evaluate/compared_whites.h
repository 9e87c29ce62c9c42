// compared_whites.h: the white balance of photographs that a painting is compared with.
#pragma once

#include <string>

#include "capture/radiometry/white_balances.h"
#include "fit/evaluate/compare.h"

namespace tangi {

// A photograph's white balance beside the relit picture's, both as stored, from some 20,000 pixels. `clips`:
// what is near full scale may be cut off. `light`: the direction that it is lit from.
WhiteBalance white_balance_of(const Image<Rgb>& photo, const Image<Rgb>& relit, const PixelMask& mask,
                              const Transfer& transfer, bool clips, const Vec3& light);

// That photographs are of another white balance, and how far the farthest is off; empty where none is.
std::string other_white_balances(const CompareReport& report, const std::string& folder);

}  // namespace tangi
