// mosaic_layout.h: where the positions of a mosaic lie on the wall: one homography each, of all overlaps
// together.
#pragma once

#include <glm/mat3x3.hpp>
#include <vector>

#include "fit/mosaic/pair_registration.h"

namespace tangi {

struct PlacedPosition {
    bool joined = false;
    Homography to_wall{1};  // pixel of the position -> pixel of the wall
    double sigma_px = 0;    // [pixels of the wall] standard error of a point of it, rms; 0: the anchor
    double pixel = 1;       // [pixels of the wall] side of a pixel in the picture's middle
    double turn_rad = 0;    // of the picture on the wall, from x towards y (up)

    // Vectors of the position -> those of the wall, if its camera is not tilted.
    glm::dmat3 turn() const;
};

struct PlacedPair {
    std::size_t first = 0, second = 0;
    std::size_t ties = 0;
    double rms_px = 0;  // [pixels of the wall] of ties, root of the mean square of their distance
};

struct MosaicLayout {
    std::size_t anchor = 0;  // whose pixels are the wall's
    int width = 0, height = 0;
    std::vector<PlacedPosition> positions;
    std::vector<PlacedPair> pairs;
    double rms_px = 0;  // of all ties
};

// Minimises the distances of ties on the wall, each by its standard error and robustly (Cauchy), over a
// homography for each position that is joined to the anchor through pairs, whose own stays what it is
// (Ceres). Loops close by that. Perspective and shear, which chains of overlaps know badly, are held to what
// cameras on a stand have (kPrior in the source). The wall is as large as its positions.
MosaicLayout solve_layout(const std::vector<MosaicPosition>& positions,
                          const std::vector<PairRegistration>& pairs, std::size_t anchor);

}  // namespace tangi
