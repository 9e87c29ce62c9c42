// lobe_neighbour_prior.h: what the neighbours of a pixel that have its colour say about its lobe.
//
// Few lights show the lobe of a pixel, but neighbours of other slopes have it shown by others. Paint of one
// material shares it (Lensch et al. 2003, "Image-based reconstruction of spatial appearance and geometric
// detail"; Goldman et al. 2010, "Shape and spatially-varying BRDFs from photometric stereo"); here the
// materials are those of the neighbourhood, found by colour.
#pragma once

#include <vector>

#include "fit/pixel/fit_errors.h"
#include "fit/pixel/ward_residual.h"
#include "surface/maps/surface.h"

namespace tangi {

constexpr int kLobeReach = 6;  // [pixels] how far neighbours are asked

inline float square(float v) { return v * v; }

// The prior of each pixel's ln alpha and rho_s: mean and spread of what the neighbours within kLobeReach
// pixels have, weighted by how certain they are and how alike in colour (of rho_d, or of rho_d and a lobe so
// wide that it may stand in for it); drawn to `general`, which is all there is where no neighbour is alike.
// The pixel itself has no say in it.
//
// Rows are gone through from top to bottom and may be overwritten once they have been used: what is kept is
// memory for a few rows. References to surface and errors are kept.
class LobePriors {
public:
    LobePriors(const Surface& surface, const FitErrors& errors, const WardPrior& general)
        : surface_(surface), errors_(errors), general_(general) {}

    // From now on at() knows rows y0 <= y < y1, and of the surface rows y < y1 may be overwritten. y0 must be
    // what y1 was before, 0 at first.
    void advance(int y0, int y1);

    WardPrior at(int x, int y) const;

private:
    struct Prior {
        float ln_alpha, ln_alpha_sigma, specular, specular_sigma;
    };

    const Surface& surface_;
    const FitErrors& errors_;
    WardPrior general_;
    int first_ = 0, end_ = 0;    // rows that are known
    std::vector<Prior> priors_;  // of rows first_ <= y < end_
};

}  // namespace tangi
