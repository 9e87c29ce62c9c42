// bristle_rows.h: the underside of a brush along a row of pixels, from the map of its tip.
#pragma once

#include <cstdint>
#include <vector>

namespace tangi {

// A field of a texel's 32 bits: parts of the field's unit, the greatest number being all of it.
struct TexelField {
    int shift, bits;
};
constexpr TexelField kDomeField{0, 14};   // [1] 0 in the middle, 1 at the rim and outside
constexpr TexelField kTipField{14, 9};    // [longest] how much shorter the bristle is
constexpr TexelField kCoverField{23, 9};  // [1] part of the pixel that the tip covers

// A texel of a tip (lower half) and the one to its right (upper half): what a bilinear look needs of a row is
// one number. Looking up numbers costs by their count, so all of a texel is in one.
using TexelPair = std::uint64_t;

// The tip, in pixels along the brush's width (columns) and thickness (rows). Its border is outside.
struct TipMap {
    const TexelPair* texels = nullptr;
    float longest = 1;          // [1] unit of kTipField
    float steepest = 1;         // [1/texel] slope of the dome at most
    int width = 0, height = 0;  // at least 2
};

// Of values between 0 and their field's unit, row by row.
std::vector<TexelPair> texel_pairs(const std::vector<float>& dome, const std::vector<float>& tip,
                                   const std::vector<float>& cover, int width);

// Bilinear, `part` of the way to the pairs' right; [1] of the field's unit.
template <TexelField kField>
inline float between(TexelPair above, TexelPair below, float part, float downwards) {
    constexpr std::uint32_t most = (1u << kField.bits) - 1;
    const auto value = [](std::uint32_t texel) {
        return static_cast<float>(static_cast<int>(texel >> kField.shift & most));
    };
    const auto left = [&](TexelPair pair) { return value(static_cast<std::uint32_t>(pair)); };
    const auto right = [&](TexelPair pair) { return value(static_cast<std::uint32_t>(pair >> 32)); };
    const float a = left(above) + (right(above) - left(above)) * part;
    const float b = left(below) + (right(below) - left(below)) * part;
    return (a + (b - a) * downwards) * (1.0f / static_cast<float>(most));
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
void underside_row(int n, const TipMap& map, const UndersideRow& row, float* out, float* cover);

}  // namespace tangi
