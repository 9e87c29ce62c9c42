// edge_pressure.h: where a brush's pressure ends at either side of its way: what it presses out there becomes
// the stroke's lips.
#pragma once

#include <algorithm>

namespace tangi {

// A pixel (x, y) of a box lies ax x + ay y + a0 pixels to the right of the middle of the brush's way. The tip
// is flattened as far as left_px and right_px.
struct BrushSides {
    float ax = 0, ay = 0, a0 = 0;
    float left_px = 1, right_px = 1;
    float band_px = 0;  // width of what counts as a side; 0: the brush stands, and has none
    // [1] How hard the tuft bears on either side, over the mean: what is pressed out there goes with it.
    float left_bears = 1, right_bears = 1;

    // The sides of a row of the box from a pixel on.
    BrushSides row_from(int x, int y) const {
        BrushSides row = *this;
        row.a0 += ax * static_cast<float>(x) + ay * static_cast<float>(y);
        return row;
    }
};

}  // namespace tangi
