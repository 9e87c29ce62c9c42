#include "paint/stroke/upper_film.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tangi {

namespace {

constexpr double kNoPaint_mm3 = 1e-9;  // on a brush
constexpr float kSame = 0.02f;         // [1] part by volume up to which two recipes are one
constexpr float kThin_mm = 5e-4f;      // other paint of which there is less is none

}  // namespace

UpperFilm::UpperFilm(const Brush& brush) {
    if (brush.ingredients().empty()) return;
    std::vector<double> mm3 = brush.volumes_mm3(brush.ingredients().back() + std::size_t(1));
    const double all = std::accumulate(mm3.begin(), mm3.end(), 0.0);
    if (!(all > kNoPaint_mm3)) return;
    for (double& part : mm3) part /= all;
    brought_ = std::move(mm3);
}

bool UpperFilm::met(const PaintLayer& wet, const Brush& brush, const Dab& dab, const Region& box) {
    const Region part = intersection(box, wet.region());
    if (met_ || part.empty()) return met_;
    bool near = false;
    for (int y = part.y0 / kTileSize; y * kTileSize < part.y1; ++y)
        for (int x = part.x0 / kTileSize; x * kTileSize < part.x1; ++x) {
            const auto [at, first] = seen_.try_emplace({x, y});
            if (const auto& tile = wet.tile({x, y}); first && tile) at->second = where(*tile);
            near = near || at->second;
        }
    met_ = near && is_under(brush, dab, part);
    return met_;
}

bool UpperFilm::is_under(const Brush& brush, const Dab& dab, const Region& part) const {
    const TipOutline outline = brush.outline(dab);
    const auto reach_mm = static_cast<float>(brush.settings().reach_mm);
    double cx, cy;
    brush.contact_centre(dab, cx, cy);
    for (int y = part.y0; y < part.y1; ++y) {
        const RowSpan span = outline.across(y - cy, part.x0 - cx, part.width());
        const Depths* depths = nullptr;
        for (int x = part.x0 + span.begin; x < part.x0 + span.end; ++x) {
            if (!depths || x % kTileSize == 0) {
                depths = seen_.at({x / kTileSize, y / kTileSize}).get();
                if (!depths) {
                    x = (x / kTileSize + 1) * kTileSize - 1;
                    continue;
                }
            }
            const float mm = (*depths)[static_cast<std::size_t>(y % kTileSize * kTileSize + x % kTileSize)];
            if (mm > 0 && brush.lowest_mm(dab, x, y) < mm + reach_mm) return true;
        }
    }
    return false;
}

std::unique_ptr<const UpperFilm::Depths> UpperFilm::where(const PaintTile& tile) const {
    constexpr auto pixels = static_cast<std::size_t>(PaintTile::kPixels);
    std::array<float, pixels> all{}, above{}, differ{};
    const auto part_of = [&](IngredientId id) {
        return id < brought_.size() ? static_cast<float>(brought_[id]) : 0.0f;
    };
    for (const IngredientId id : tile.ingredients) {
        const auto plane = tile.plane(id);
        std::array<float, pixels>& sum = is_upper(id) ? above : all;
        for (std::size_t i = 0; i < pixels; ++i) sum[i] += plane[i];
    }
    // Half of the sum of what each part differs by; those of paints that are not here differ whole.
    float elsewhere = 1;
    for (const IngredientId id : tile.ingredients) {
        if (is_upper(id)) continue;
        const auto plane = tile.plane(id);
        const float part = part_of(id);
        elsewhere -= part;
        for (std::size_t i = 0; i < pixels; ++i) differ[i] += std::abs(plane[i] - part * all[i]) / 2;
    }
    auto depths = std::make_unique<Depths>();
    bool any = false;
    for (std::size_t i = 0; i < pixels; ++i) {
        const float other_mm = differ[i] + std::max(elsewhere, 0.0f) / 2 * all[i];
        if (above[i] <= kThin_mm && !(other_mm > kThin_mm && other_mm > kSame * all[i])) continue;
        (*depths)[i] = all[i] + above[i];
        any = true;
    }
    if (!any) return nullptr;
    return depths;
}

}  // namespace tangi
