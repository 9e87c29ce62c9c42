// shadow_carving.h: the height changed as little as can be, so that it casts the shadows that were seen.
//
// Slopes say nothing of a cliff that no pixel shows, and little of relief as fine as pixels. A pixel in
// shadow says that somewhere towards the light the surface rises as steeply as the light stands; one that is
// lit, that nowhere it does (Daum & Dudek 1998, "On 3-D surface reconstruction using shape from shadows";
// with slopes: Yu & Chang 2005, "Shadow graphs and 3D texture reconstruction").
#pragma once

#include "fit/height/slope_edges.h"
#include "fit/pixel/lighting.h"
#include "fit/shadows/light_visibility.h"
#include "surface/base/progress.h"

namespace tangi {

struct CarveReport {
    long lights = 0;        // that were seen, lit or hidden, and that the relief may hide
    long contradicted = 0;  // by the height as it was
    long left = 0;          // by the height as it is now
};

// Changes surface.height_mm by the d that minimises, over its edges and what contradicts it,
//   sum w_ij (d_j - d_i)^2 + sum v_k (z_q - z_p - t |pq|)^2,
// w as `edges` weighs them, so that what slopes know well stays. p is a pixel, q the place towards the light,
// whose elevation has the tangent t: of a lit pixel that which hides the light, of one in shadow that which
// has to rise least, by what its edges allow. 1 / v is the variance of a shadow's edge: a part of a pixel,
// and of the light's direction, over the distance; pairs that are far off count less, as in Cauchy's loss.
// What contradicts is found anew some times. A hidden pixel from which nothing is seen to hide the light up
// to the border of the picture, or only from farther than kShadowReach, contradicts nothing. Result
// independent of the number of threads. Memory beside surface and edges: 23 bytes a pixel, and 24 to 48 for
// each light that contradicts.
CarveReport carve_shadows(const LightVisibility& lights, const Lighting& lighting, const SlopeEdges& edges,
                          Surface& surface, const Progress& progress = {});

}  // namespace tangi
