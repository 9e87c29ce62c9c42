#include "paint/brush/brush_in_hand.h"

#include <algorithm>

namespace tangi {

std::optional<BrushInHand> kept(const Brush* brush, Place place) {
    if (!brush) return {};
    BrushInHand hand{brush->settings(), brush->seed(), place, {}};
    const BrushLoad load = brush->bristles();
    if (load.ingredients.empty()) return hand;
    constexpr std::size_t piece = PaintTile::kPixels;
    for (std::size_t first = 0; first < load.total_mm.size(); first += piece) {
        const auto tile = std::make_shared<PaintTile>();
        tile->ingredients = load.ingredients;
        tile->thickness_mm.assign(load.mm.size() * piece, 0.0f);
        const std::size_t count = std::min(piece, load.total_mm.size() - first);
        for (std::size_t i = 0; i < load.mm.size(); ++i)
            std::copy_n(load.mm[i].data() + first, count, tile->thickness_mm.data() + i * piece);
        hand.cells.push_back(tile);
    }
    return hand;
}

std::unique_ptr<Brush> taken_up(const std::optional<BrushInHand>& hand, double mm_per_pixel) {
    if (!hand) return nullptr;
    auto brush = std::make_unique<Brush>(hand->settings, mm_per_pixel, hand->seed);
    if (hand->cells.empty()) return brush;
    constexpr std::size_t piece = PaintTile::kPixels;
    BrushLoad load;
    const auto side = static_cast<std::size_t>(brush->grid_size());
    load.ingredients = hand->cells.front()->ingredients;
    load.mm.resize(load.ingredients.size());
    load.total_mm.assign(side * side, 0.0f);
    for (std::size_t i = 0; i < load.mm.size(); ++i) {
        for (const auto& tile : hand->cells) {
            const float* from = tile->thickness_mm.data() + i * piece;
            load.mm[i].insert(load.mm[i].end(), from, from + piece);
        }
        load.mm[i].resize(side * side);
        for (std::size_t k = 0; k < load.total_mm.size(); ++k) load.total_mm[k] += load.mm[i][k];
    }
    brush->put_back(load);
    return brush;
}

}  // namespace tangi
