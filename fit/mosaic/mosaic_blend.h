// mosaic_blend.h: the wall's maps, rectangle by rectangle, from those of the positions.
#pragma once

#include <vector>

#include "fit/mosaic/mosaic_seams.h"

namespace tangi {

// Refers to all that it is made of.
struct MosaicBlend {
    const std::vector<MosaicPosition>& positions;
    const MosaicLayout& layout;
    const MosaicScales& scales;
    const CellGrid& grid;
    const MosaicSeams& seams;
};

// Maps of a rectangle of the wall, without height; errors where all joined positions have them. Positions are
// resampled once (Lanczos 3, Duchon 1979), slopes rather than normals; a pixel that was not measured is
// taken from another position. Errors of positions count as independent.
MosaicPart blended(const MosaicBlend& blend, const Region& part);

}  // namespace tangi
