// mixing_board.h: the palette as a painter holds it: a smooth board with piles of paint on it, where paints
// are mixed with the brush and picked up again. A canvas like any other, with pixels of the painting's size,
// so that a brush carries what is on each of its bristles from one to the other.
#pragma once

#include "paint/canvas/canvas.h"
#include "paint/session/journal.h"

namespace tangi {

struct BoardSize {
    double width_mm = 200, height_mm = 150;
};

// 200 x 150 mm; as much smaller, or larger, as makes it 400 to 1600 pixels wide.
BoardSize default_board_size(double mm_per_pixel);

// White, smooth and glossy, as an enamelled or glazed palette: colours are seen as they are. Throws Error
// where it would have fewer than 8 or more than 8192 pixels a side.
Canvas make_board(const BoardSize& size, double mm_per_pixel);

// Piles of these paints along the rim, from the bottom left over the top to the bottom right, evenly; as
// large as leaves room between them, 24 mm at most. Where the middle of the board is, nothing lies. For one
// paint or more.
std::vector<PileEvent> laid_out(const std::vector<std::string>& paints, const BoardSize& size);

// Adds a dome (a paraboloid) of paint to what is on a canvas already: `recipe` in parts, with its middle
// `at`, as wide and high as said. What lies beyond the canvas is left out. Throws Error where the recipe's
// parts do not sum to more than 0.
void lay_pile(Canvas& canvas, const std::vector<Portion>& recipe, PointMm at, double size_mm,
              double height_mm);

// Where a pile of this width lies on the least wet paint: nearest to the middle, where there are several such
// places.
PointMm free_place(const Canvas& board, double size_mm);

// Takes all wet paint off a canvas.
void wipe(Canvas& canvas);

}  // namespace tangi
