// paint_layer.h: paint on a canvas as volumes of its ingredients, in sparse tiles that are copied on write.
//
// A tile holds one plane for each ingredient that occurs in it: the thickness [mm] which that ingredient
// alone would have, that is its volume over the pixel's area. The thickness of the paint is their sum, its
// recipe their ratio, so that mixing is bookkeeping and every volume can be counted again. Tiles without
// paint take no memory, and a copy of a layer shares all tiles with it, which makes undo cheap.
//
// Paint laid on other wet paint lies on it until bristles stir both. Where that happened a tile has planes of
// two kinds: what is mixed, and on it the upper film, which has a recipe of its own.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

// Index into Canvas::ingredients(); in tiles, with kUpper added, what of that paint is in the upper film.
using IngredientId = std::uint16_t;

constexpr float kUpper_mm = 0.02f;  // [mm] of the upper film that strokes and piles leave
constexpr IngredientId kUpper = 0x8000;
constexpr bool is_upper(IngredientId id) { return (id & kUpper) != 0; }
constexpr IngredientId upper_of(IngredientId paint) { return static_cast<IngredientId>(paint | kUpper); }
constexpr IngredientId paint_of(IngredientId id) { return static_cast<IngredientId>(id & ~kUpper); }

struct PaintTile {
    static constexpr int kSize = 64;  // [pixels] of a side
    static constexpr int kPixels = kSize * kSize;

    std::vector<IngredientId> ingredients;  // ascending: those of the upper film last
    std::vector<float> thickness_mm;        // [ingredients][row][column]

    // The plane of an ingredient, or an empty span where the tile has none of it.
    std::span<const float> plane(IngredientId ingredient) const;
    // The plane to write to; made, full of 0, where the tile has none. Other planes may move.
    std::span<float> writable_plane(IngredientId ingredient);
    // Whether there is anything in the upper film; planes of it that hold nothing do not count.
    bool has_upper() const;
    // Takes planes away that hold nothing: all, or those of the upper film.
    void drop_empty();
    void drop_empty_upper();
    std::size_t bytes() const { return sizeof(PaintTile) + thickness_mm.capacity() * sizeof(float); }

private:
    void drop_empty_from(std::size_t first);
};

constexpr int kTileSize = PaintTile::kSize;  // [pixels]

// What lies in both.
inline Region intersection(const Region& a, const Region& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

// The smallest that holds both; `a` does not count where it is empty.
inline Region united(const Region& a, const Region& b) {
    if (a.empty()) return b;
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

// Where a tile is: column and row in the grid of tiles.
struct TileIndex {
    int x = 0, y = 0;
    friend auto operator<=>(const TileIndex&, const TileIndex&) = default;
};

class PaintLayer {
public:
    using TilePtr = std::shared_ptr<const PaintTile>;  // null: no paint

    PaintLayer() = default;
    PaintLayer(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }
    Region region() const { return {0, 0, width_, height_}; }
    int columns() const { return columns_; }
    int rows() const { return rows_; }

    const TilePtr& tile(TileIndex at) const { return tiles_[index(at)]; }
    void set_tile(TileIndex at, TilePtr tile) { tiles_[index(at)] = std::move(tile); }

    // The tile to write to: copied first where something else holds it too.
    PaintTile& writable(TileIndex at);

    // All tiles that hold paint, row by row.
    std::vector<TileIndex> painted() const;
    bool empty() const { return painted().empty(); }

    // Thickness [mm] of one paint, in both films, and of all of them at a pixel of the canvas.
    float thickness_mm(int x, int y, IngredientId paint) const;
    float thickness_mm(int x, int y) const;

    // Adds the thickness [mm] of all paint in `region`, which lies on the canvas, to `out`, row by row.
    void add_thickness_mm(const Region& region, float* out, std::size_t stride) const;

    // Memory of the tiles and of the table of them.
    std::size_t bytes() const;

    // The part of the canvas that a tile covers.
    Region region_of(TileIndex at) const;

private:
    std::size_t index(TileIndex at) const {
        return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(at.x);
    }

    int width_ = 0, height_ = 0, columns_ = 0, rows_ = 0;
    std::vector<TilePtr> tiles_;
};

// Volume [mm^3] of each ingredient on the whole layer: count of ingredients, pixels of mm_per_pixel. Summed
// in double in a fixed order.
std::vector<double> volumes_mm3(const PaintLayer& layer, std::size_t ingredients, double mm_per_pixel);

// True where both hold the same bits everywhere; an ingredient that a tile has not is 0.
bool identical(const PaintLayer& a, const PaintLayer& b);

}  // namespace tangi
