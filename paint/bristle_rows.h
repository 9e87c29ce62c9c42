// bristle_rows.h: the underside of a brush along a row of pixels, from the maps of its tip.
#pragma once

#include <cstdint>
#include <vector>

namespace tangi {

// A texel of a tip's map (lower half) and the one to its right (upper half), as 65535ths of the map's unit:
// what a bilinear look needs of a row is one number.
using TexelPair = std::uint32_t;

// Maps of the tip, in pixels along the brush's width (columns) and thickness (rows). Their border is outside.
struct TipMaps {
    const TexelPair* dome = nullptr;   // [1] 0 in the middle, 1 at the rim and outside
    const TexelPair* tip = nullptr;    // [longest] how much shorter the bristle is
    const TexelPair* cover = nullptr;  // [1] part of the pixel that the tip covers
    float longest = 1;                 // [1] unit of `tip`
    int width = 0, height = 0;         // at least 2
};

// Of values between 0 and `unit`, row by row.
std::vector<TexelPair> texel_pairs(const std::vector<float>& values, int width, float unit);

// Bilinear, `part` of the way to the pairs' right; [1] of the map's unit.
inline float between(TexelPair above, TexelPair below, float part, float downwards) {
    const auto left = [](TexelPair pair) { return static_cast<float>(static_cast<int>(pair & 0xffff)); };
    const auto right = [](TexelPair pair) { return static_cast<float>(static_cast<int>(pair >> 16)); };
    const float a = left(above) + (right(above) - left(above)) * part;
    const float b = left(below) + (right(below) - left(below)) * part;
    return (a + (b - a) * downwards) * (1.0f / 65535);
}

struct UndersideRow {
    float u, v;               // [texels] of the row's first pixel
    float du, dv;             // [texels] from pixel to pixel
    float lift_mm, dlift_mm;  // tilt of the tip at the first pixel, and from pixel to pixel
    float gap_mm, groove_mm;
    float rise_mm;  // for each unit of the dome beyond `touched`
    float touched;  // [1] part of the dome that is flattened
    float rim_mm;  // by how much the underside rises from where the tip covers all to where it covers nothing
};

// Bilinear; `out` has n floats, kOutside (transfer.h) where the tip covers nothing, and `cover` [1] too.
void underside_row(int n, const TipMaps& maps, const UndersideRow& row, float* out, float* cover);

}  // namespace tangi
