// icc_profile.h: what the numbers of an sRGB picture mean, for programs that manage colour; and whether a
// profile that came with a picture can be read.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tangi {

// An ICC profile (ICC.1:2010, version 4.3) of a display with the primaries, white and transfer curve of sRGB
// (IEC 61966-2-1), adapted to D50 by Bradford's matrix.
std::string srgb_icc_profile();

// What is wrong with a profile that came from outside, in a few words: a tag that lies outside of it, texts
// that are shorter than they say. Nothing where every tag can be read, or where it is no profile by its
// header, which every reader looks at first. OpenImageIO 2.4 believes tags: an offset and size that overflow
// 32 bits, and texts shorter than their own head, end the process.
std::optional<std::string> damage_of_icc(std::string_view profile);

}  // namespace tangi
