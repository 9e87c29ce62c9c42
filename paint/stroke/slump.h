// slump.h: paint that stands steeper than it can flows down, however far, where a brush has heaped it up.
//
// In a step of the brush paint flows within a few pixels of the bristles only (transfer.h), which suffices
// for the slopes of a stroke. What many strokes pile up at one place, or a blade ahead of itself, has to go
// further: else it stands there as a wall, with the straight sides of the box of pixels that steps change.
#pragma once

#include <span>
#include <vector>

#include "paint/stroke/brush_steps.h"

namespace tangi {

// Parts of the canvas around walls: where paint in one of `parts`, with what is dry, stands higher than a
// neighbouring pixel by `step_mm`, and not only since what is dry does. None overlaps another.
std::vector<Region> walls_in(const Canvas& canvas, std::span<const Region> parts, float step_mm);

// Lets paint in `region`, one of walls_in(), flow down until no step is higher than 1.4 rates.yield_mm, or as
// far as it comes in some dozen steps. Films and bulges stay as they are. Conservative, the same on any
// number of threads.
void slump(Canvas& canvas, const Region& region, const TransferRates& rates, DabMemory& memory);

}  // namespace tangi
