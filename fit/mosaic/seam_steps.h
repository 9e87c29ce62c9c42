// seam_steps.h: what a mosaic's seams add to the wall: steps of height and of colour that no position has
// there.
#pragma once

#include <vector>

#include "fit/mosaic/mosaic_seams.h"

namespace tangi {

struct SeamSteps {
    std::size_t first = 0, second = 0;  // positions, first < second
    std::size_t pieces = 0;             // of the seam
    double height_rms = 0;              // [pixels of the wall]
    double height_error = 0;            // [pixels of the wall] that the wall's heights there state, rms
    double delta_e_2000 = 0;            // [1] mean
};

// Of two neighbouring cells with different owners, which both positions cover: by how much the wall's
// difference in height, and in rho_d, between them is another than what both positions have on average
// between the same two. What is seen of a seam goes on along it: steps are means of pieces of eight by eight
// cells. `height_error`: [pixels of the wall] as stated, mean of each cell.
std::vector<SeamSteps> seam_steps(const std::vector<CellMaps>& maps, const MosaicScales& scales,
                                  const CellGrid& grid, const Image<int>& owner, const CellMaps& wall,
                                  const Image<float>& height_error);

}  // namespace tangi
