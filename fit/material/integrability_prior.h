// integrability_prior.h: what the surface through the neighbours of a pixel says about its slope.
//
// The joint minimum of photographs and integrability, height and slopes both unknown,
//   sum over pixels of the photographs' cost (slope_i, ...)
//   + sum over edges of ((z_j - z_i) / mm - (slope_i + slope_j) / 2)^2 / tolerance^2,
// is approached by turns: the height for given slopes (height.h), then each pixel for given height and
// neighbours, which is this Gaussian prior of its slope in the fit of a pixel. Where photographs know the
// slope it changes little; where shadows, glints or few lights leave it open, the surface decides.
#pragma once

#include <vector>

#include "fit/pixel/ward_residual.h"
#include "surface/maps/surface.h"

namespace tangi {

// Rows are gone through from top to bottom and may be overwritten once they have been used, as with
// LobePriors: what is kept is memory for a few rows. Keeps a reference to the surface, whose height has had
// `plane` taken off.
class IntegrabilityPriors {
public:
    IntegrabilityPriors(const Surface& surface, const Plane& plane) : surface_(surface), plane_(plane) {}

    // From now on add_to() knows rows y0 <= y < y1, and of the surface rows y < y1 may be overwritten, apart
    // from the height. y0 must be what y1 was before, 0 at first.
    void advance(int y0, int y1);

    // Of pixels that were not measured, or no neighbour of which was, nothing is said.
    void add_to(int x, int y, WardPrior& prior) const;

private:
    struct Prior {
        float x = 0, y = 0;                          // [1] mean of slope x, slope y
        float x_information = 0, y_information = 0;  // [1] 1 / variance
    };
    Prior prior_of(int x, int y) const;

    const Surface& surface_;
    Plane plane_;
    int first_ = 0, end_ = 0;    // rows that are known
    std::vector<Prior> priors_;  // of rows first_ <= y < end_
};

}  // namespace tangi
