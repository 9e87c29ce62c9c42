// mosaic_seams.h: which position shows which part of the wall, and what makes them agree there.
#pragma once

#include <vector>

#include "fit/mosaic/mosaic_cells.h"
#include "fit/mosaic/mosaic_scales.h"

namespace tangi {

// What is added to a position's low frequencies, on the wall's scale and in its frame.
struct LowBand {
    glm::vec2 slope{0};
    Rgb ln_diffuse{0};
    float ln_specular = 0, ln_alpha = 0;
};

// Of the cells of one position.
struct PositionShare {
    Region cells;
    Image<float> weight;  // [1] by which its detail is taken; 0 where others show the wall
    Image<LowBand> low;
};

struct MosaicSeams {
    Image<int> owner;  // of each cell of the wall: the position; -1: none covers it
    std::vector<PositionShare> shares;
};

// Two bands (Burt & Adelson 1983). Low frequencies, of several cells, are means of all positions there, by
// the distance from the rim of each picture: what bends slopes a little and differently in each leaves no
// edge. Detail comes from one position, its owner, and changes to the next within some two cells of a seam.
// Seams are minimal cuts (GraphCutSeamFinder: Kwatra et al. 2003) where positions differ least in rho_d and
// slopes.
MosaicSeams find_seams(const CellGrid& grid, const MosaicLayout& layout, const std::vector<CellMaps>& maps,
                       const MosaicScales& scales);

}  // namespace tangi
