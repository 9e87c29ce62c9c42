// quantise_volumes.h: paint that comes to rest lies on a grid of volumes.
#pragma once

#include "paint/canvas/paint_layer.h"

namespace tangi {

// [mm] Volumes that were left are multiples of it: a hundred-thousandth of a thin film, and far less than can
// be seen. So traces that bristles carry about end somewhere, tiles get rid of paints of which they have none
// to speak of, and files are a third smaller, since digits that mean nothing cannot be compressed. Where
// paint is thicker than 2 mm, floats are coarser than this anyway.
constexpr float kVolumeGrid_mm = 0x1p-22f;

// The nearest multiple [mm] of the grid, 0 at least.
float on_grid(float mm);

// Rounds those volumes of a tile to the grid that differ from `as_it_was` (null: there was none). What one
// pixel loses or gains, the next such one in the same column gains or loses, and what is left in the end,
// less than a step, is given to one of them, beside the grid: an ingredient's volume in the tile stays what
// it was, to a thousandth of a step and what floats round. Planes in which nothing is left are taken away.
void settle(PaintTile& tile, const PaintTile* as_it_was);

}  // namespace tangi
