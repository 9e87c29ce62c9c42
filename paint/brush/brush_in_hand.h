// brush_in_hand.h: a brush between strokes and where it was used last, to go back to.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "paint/brush/brush.h"
#include "paint/canvas/canvas.h"

namespace tangi {

struct BrushInHand {
    BrushSettings settings;
    std::uint64_t seed = 0;
    Place place = Place::painting;  // its paints have the numbers of that canvas's ingredients
    // What is on it, in pieces of as many cells as a tile has pixels: rows of its grid, the last piece filled
    // up with 0. None where no paint ever was.
    std::vector<PaintLayer::TilePtr> cells;

    // The same state, not only an equal one.
    friend bool operator==(const BrushInHand&, const BrushInHand&) = default;
};

// Empty where there is no brush.
std::optional<BrushInHand> kept(const Brush* brush, Place place);
// The brush, bit for bit; null where there was none.
std::unique_ptr<Brush> taken_up(const std::optional<BrushInHand>& hand, double mm_per_pixel);

}  // namespace tangi
