// bristle_rows.h: the underside of a brush along a row of pixels, from the maps of its tip.
#pragma once

namespace tangi {

// Maps of the tip, in pixels along the brush's width (columns) and thickness (rows). Their border is outside.
struct TipMaps {
    const float* dome = nullptr;   // [1] 0 in the middle, 1 at the rim and outside
    const float* tip = nullptr;    // [1] how much shorter the bristle is
    const float* cover = nullptr;  // [1] part of the pixel that the tip covers
    int width = 0, height = 0;     // at least 2
};

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
