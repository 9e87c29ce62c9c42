// paint_window.h: a part of the canvas as whole rows, on which steps of a brush work; what changes is put
// back.
#pragma once

#include <vector>

#include "paint/canvas/canvas.h"
#include "paint/exchange/transfer.h"

namespace tangi {

// The wet paint of a region, its support and where brushes may work. The paint is taken out of the tiles
// and put back when the steps are done: in between this is the paint, not a copy of it to pick up from.
class PaintWindow {
public:
    // What windows lie in, one after the other.
    struct Memory {
        std::vector<std::vector<float>> paint;
        std::vector<float> total, relief, open, height, mean;
    };

    // `region` may reach beyond the canvas; pixels there, and where the canvas's mask is 0, are not
    // open and neither take nor give paint.
    // `ingredients` are those that will come from a brush; those of the canvas are added. `ride_px`: half the
    // side of the square over which a brush follows the relief. `upper`: something will be laid above.
    // `memory` is this window's until the next one's.
    PaintWindow(const Canvas& canvas, const Region& region, std::vector<IngredientId> ingredients,
                int ride_px, bool upper, Memory& memory);

    const Region& region() const { return region_; }
    const std::vector<IngredientId>& ingredients() const { return ingredients_; }  // but for the upper film

    // Points the box's canvas side at the part of the window that begins at pixel (x0, y0) of the canvas.
    void attach(StepBox& box, int x0, int y0);

    // Puts the paint back into the tiles and marks those that changed as dirty.
    void store(Canvas& canvas) const;

private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - region_.y0) * stride_ + static_cast<std::size_t>(x - region_.x0);
    }
    // Calls body(i, part of the window in tiles_[i]) for each, on all threads where there is much to do.
    template <class Body>
    void for_tiles(const PaintLayer& layer, const Body& body) const;
    void clear();
    void find_relief(const Canvas& canvas, int ride_px);
    void find_open(const Canvas& canvas, const Region& part);
    void take_paint(const PaintLayer& wet, TileIndex at, const Region& part);
    bool put_back(PaintLayer& wet, TileIndex at, const Region& part) const;  // whether there was a change

    Region region_, on_canvas_;
    std::size_t stride_ = 0;
    std::vector<TileIndex> tiles_;                    // in which the window lies
    std::vector<IngredientId> ingredients_, planes_;  // planes_: with the upper film's, if there is one
    Memory& memory_;
};

}  // namespace tangi
