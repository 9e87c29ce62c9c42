#include "paint/other_paint.h"

#include <cmath>
#include <numeric>
#include <vector>

namespace tangi {

namespace {

constexpr double kNoPaint_mm3 = 1e-9;  // on a brush
constexpr double kSame = 0.02;         // [1] part by volume up to which two recipes are one

}  // namespace

OtherPaint::OtherPaint(const Brush& brush) {
    const IngredientId last = brush.ingredients().empty() ? IngredientId(0) : brush.ingredients().back();
    const std::vector<double> mm3 = brush.volumes_mm3(last + std::size_t(1));
    const double all = std::accumulate(mm3.begin(), mm3.end(), 0.0);
    for (const IngredientId id : brush.ingredients())
        if (all > kNoPaint_mm3) brought_[id] = mm3[id] / all;
}

bool OtherPaint::met(const PaintLayer& wet, const Region& box) {
    const Region part = intersection(box, wet.region());
    if (met_ || part.empty()) return met_;
    for (int y = part.y0 / kTileSize; y * kTileSize < part.y1; ++y)
        for (int x = part.x0 / kTileSize; x * kTileSize < part.x1; ++x)
            if (seen_.insert({x, y}).second && is_in(wet, {x, y})) met_ = true;
    return met_;
}

bool OtherPaint::is_in(const PaintLayer& wet, TileIndex at) const {
    const auto& tile = wet.tile(at);
    if (!tile) return false;
    if (tile->has_upper()) return true;
    std::map<IngredientId, double> parts;
    double all = 0;
    for (const IngredientId id : tile->ingredients) {
        const auto plane = tile->plane(id);
        all += parts[id] = std::accumulate(plane.begin(), plane.end(), 0.0);
    }
    if (!(all > 0) || brought_.empty()) return all > 0;
    for (auto& [id, part] : parts) part /= all;
    for (const auto& [id, part] : brought_) parts[id] -= part;
    double differ = 0;
    for (const auto& [id, part] : parts) differ += std::abs(part) / 2;
    return differ > kSame;
}

}  // namespace tangi
