// fit_tiles.h: the pixels of some tiles, by a plan.
#pragma once

#include "fit/steps/fitted_tiles.h"

namespace tangi {

struct FitTilesReport {
    int asked = 0, there = 0, fitted = 0;  // tiles
    long pixels = 0;                       // of those fitted
};

// Fits those of the tiles that are not there. A row of tiles is read and fitted as one, from the top to the
// bottom, so that photographs are decoded once: who shares the work gives whole rows. Which tiles are fitted
// together changes no bit of any. Memory: that of a row of tiles, and of the height that casts shadows, as
// images (image_memory.h).
FitTilesReport fit_tiles(const FitPlan& plan, const FitOptions& options, const FittedTiles& tiles,
                         const std::vector<int>& numbers, const Progress& progress = {});

}  // namespace tangi
