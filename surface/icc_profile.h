// icc_profile.h: what the numbers of an sRGB picture mean, for programs that manage colour.
#pragma once

#include <string>

namespace tangi {

// An ICC profile (ICC.1:2010, version 4.3) of a display with the primaries, white and transfer curve of sRGB
// (IEC 61966-2-1), adapted to D50 by Bradford's matrix.
std::string srgb_icc_profile();

}  // namespace tangi
