// loss_surroundings.h: what is known of a loss before paint is chosen for it; for sources of this module
// only.
#pragma once

#include <vector>

#include "paint/canvas/canvas.h"
#include "paint/optics/spectrum.h"
#include "retouch/colour_match/gloss.h"
#include "retouch/inpaint/mixture_colours.h"
#include "retouch/inpaint/retouch_modes.h"
#include "retouch/mask/mask.h"

namespace tangi {

struct Loss {
    Region region;      // of the canvas: the mask and what lies round it
    Mask mask;          // in the region
    Image<Rgb> seen;    // linear Rec. 709 under D65
    Image<Rgb> target;  // what the surroundings go on as, where the mask is above 0
    double mm_per_pixel = 1;

    MaskRegions parts;                // connected parts of the mask
    std::vector<PartGround> grounds;  // what lies below each of them, in the mean

    // The few glosses that are beside the parts of the loss, and the number of its own at each pixel of the
    // mask. A part beside which nothing was measured has the first.
    std::vector<Gloss> glosses;
    Image<unsigned char> gloss;
    std::vector<std::vector<Region>> gloss_parts;  // of each gloss, largest first; in the canvas
};

// Memory is that of the region, for two colours and a mask a pixel. Throws Error where the mask is empty, or
// nothing is left to go on from.
Loss loss_of(const Canvas& canvas, const Mask& mask, const Mask& damaged, const RetouchOptions& options);

}  // namespace tangi
