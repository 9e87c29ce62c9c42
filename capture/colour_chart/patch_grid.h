// patch_grid.h: grids of equal squares among flat patches.
#pragma once

#include <vector>

#include "capture/colour_chart/flat_patches.h"
#include "surface/image/homography.h"

namespace tangi {

// A grid in perspective: cell (u, v), whole numbers, has its middle at mapped(grid_to_picture, (u, v)); u
// turns to v clockwise in the picture, as x to y does.
struct PatchGrid {
    struct Cell {
        int u = 0, v = 0;
        glm::dvec2 centre_px{0, 0};
    };
    Homography grid_to_picture{1};
    std::vector<Cell> cells;  // that hold a patch
};

// Grids of at least `least` patches. Starts from each patch and two neighbours, goes on from cell to cell,
// each where the ones before let expect it, and then, by the homography through them, beyond cells without a
// patch.
std::vector<PatchGrid> patch_grids(const std::vector<FlatPatch>& patches, int least);

}  // namespace tangi
