// png_encode.h: PNG pictures in memory, for files that hold several.
#pragma once

#include <string>

#include "surface/image/image.h"

namespace tangi {

// sRGB-encoded colours (0..1), 8 or 16 bits a sample. `alpha`, of the same size, is not multiplied into the
// colours; empty for none.
std::string png_bytes(const Image<Rgb>& encoded, const Image<float>& alpha = {}, int bits = 8);
// Numbers as they are (0..1), without a colour space by which others would convert them.
std::string png_bytes(const Image<float>& values, int bits = 16);

}  // namespace tangi
