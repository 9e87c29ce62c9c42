// lobe_prior.h: what the neighbours of a pixel that have its colour say about its lobe.
//
// Few lights show the lobe of a pixel, but neighbours of other slopes have it shown by others. Paint of one
// material shares it (Lensch et al. 2003, "Image-based reconstruction of spatial appearance and geometric
// detail"; Goldman et al. 2010, "Shape and spatially-varying BRDFs from photometric stereo"); here the
// materials are those of the neighbourhood, found by colour.
#pragma once

#include "fit/fit_errors.h"
#include "fit/ward_residual.h"
#include "surface/surface.h"

namespace tangi {

constexpr int kLobeReach = 6;  // [pixels] how far neighbours are asked

// The prior of a pixel's ln alpha and rho_s: mean and spread of what the neighbours within kLobeReach pixels
// have, weighted by how certain they are and how alike in colour; drawn to `general`, which is all there is
// where no neighbour is alike. The pixel itself has no say in it.
WardPrior lobe_prior_at(const Surface& surface, const FitErrors& errors, const WardPrior& general, int x,
                        int y);

}  // namespace tangi
