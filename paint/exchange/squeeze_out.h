// squeeze_out.h: what a brush drives out from under it where it is pressed down and stands, as at either end
// of a stroke and in a dab: it stays as a rim.
#pragma once

#include <vector>

#include "paint/exchange/bristle_rows.h"
#include "paint/exchange/transfer.h"

namespace tangi {

// A tip that stands on the canvas, in pixels (y down).
struct StandingTip {
    TipMap map;
    float x = 0, y = 0;                  // its middle
    float cosine = 1, sine = 0;          // of the rotation
    float narrowing = 1;                 // [texels] of the map for each pixel
    float touched = 1;                   // [1] dome that is flattened: pressure ends there
    float band_px = 1;                   // width of the part of it out of which paint is pressed
    float towards_x = 0, towards_y = 0;  // unit vector of the side where this happens; 0, 0: all around
};

// Which way paint leaves from under the bristles of a box of pixels, and how fast: 1 [1] at most, where the
// pressure ends.
struct Outwards {
    std::vector<float> x, y;
};
void find_outwards(const StandingTip& tip, const StepBox& box, Outwards& out);

// Moves squeeze_per_mm [1/mm] times its thickness of the paint (but the film) to the next pixels.
// Conservative; reads the box's underside, paint and `open` only.
void squeeze_out(const StepBox& box, const Outwards& outwards, float squeeze_per_mm, float film_mm,
                 StepScratch& scratch);

}  // namespace tangi
