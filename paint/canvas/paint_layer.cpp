#include "paint/canvas/paint_layer.h"

#include <algorithm>
#include <cstring>

#include "surface/base/error.h"

namespace tangi {

namespace {

int tiles_for(int pixels) { return (pixels + kTileSize - 1) / kTileSize; }

}  // namespace

std::span<const float> PaintTile::plane(IngredientId ingredient) const {
    const auto found = std::lower_bound(ingredients.begin(), ingredients.end(), ingredient);
    if (found == ingredients.end() || *found != ingredient) return {};
    const auto number = static_cast<std::size_t>(found - ingredients.begin());
    return std::span(thickness_mm).subspan(number * kPixels, kPixels);
}

std::span<float> PaintTile::writable_plane(IngredientId ingredient) {
    const auto at = std::lower_bound(ingredients.begin(), ingredients.end(), ingredient);
    const auto offset = (at - ingredients.begin()) * kPixels;
    if (at == ingredients.end() || *at != ingredient) {
        ingredients.insert(at, ingredient);
        thickness_mm.reserve(thickness_mm.size() +
                             kPixels);  // and no more: growing twofold, half were unused
        thickness_mm.insert(thickness_mm.begin() + offset, kPixels, 0.0f);
    }
    return std::span(thickness_mm).subspan(static_cast<std::size_t>(offset), kPixels);
}

bool PaintTile::has_upper() const {
    const auto first = std::ranges::find_if(ingredients, is_upper);
    const auto begin = (first - ingredients.begin()) * kPixels;
    return std::any_of(thickness_mm.begin() + begin, thickness_mm.end(), [](float mm) { return mm != 0; });
}

void PaintTile::drop_empty() { drop_empty_from(0); }

void PaintTile::drop_empty_upper() {
    drop_empty_from(
        static_cast<std::size_t>(std::ranges::find_if(ingredients, is_upper) - ingredients.begin()));
}

void PaintTile::drop_empty_from(std::size_t first) {
    std::size_t kept = first;
    for (std::size_t i = first; i < ingredients.size(); ++i) {
        const auto plane = thickness_mm.begin() + static_cast<std::ptrdiff_t>(i * kPixels);
        if (std::all_of(plane, plane + kPixels, [](float mm) { return mm == 0; })) continue;
        if (kept < i) {
            ingredients[kept] = ingredients[i];
            std::copy_n(plane, kPixels, thickness_mm.begin() + static_cast<std::ptrdiff_t>(kept * kPixels));
        }
        ++kept;
    }
    if (kept == ingredients.size()) return;
    ingredients.resize(kept);
    thickness_mm.resize(kept * kPixels);
    thickness_mm.shrink_to_fit();
}

PaintLayer::PaintLayer(int width, int height)
    : width_(width),
      height_(height),
      columns_(tiles_for(width)),
      rows_(tiles_for(height)),
      tiles_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

PaintTile& PaintLayer::writable(TileIndex at) {
    TilePtr& tile = tiles_[index(at)];
    if (!tile)
        tile = std::make_shared<PaintTile>();
    else if (tile.use_count() > 1)
        tile = std::make_shared<PaintTile>(*tile);
    return const_cast<PaintTile&>(*tile);  // made non-const above, and nobody else holds it
}

std::vector<TileIndex> PaintLayer::painted() const {
    std::vector<TileIndex> result;
    for (int y = 0; y < rows_; ++y)
        for (int x = 0; x < columns_; ++x)
            if (tile({x, y})) result.push_back({x, y});
    return result;
}

float PaintLayer::thickness_mm(int x, int y, IngredientId paint) const {
    TP_REQUIRE(x >= 0 && y >= 0 && x < width_ && y < height_, "the pixel is on the canvas");
    TP_REQUIRE(!is_upper(paint), "both films of a paint are asked for");
    const TilePtr& at = tile({x / kTileSize, y / kTileSize});
    if (!at) return 0;
    const auto i = static_cast<std::size_t>((y % kTileSize) * kTileSize + x % kTileSize);
    const auto mixed = at->plane(paint), upper = at->plane(upper_of(paint));
    return (mixed.empty() ? 0 : mixed[i]) + (upper.empty() ? 0 : upper[i]);
}

float PaintLayer::thickness_mm(int x, int y) const {
    TP_REQUIRE(x >= 0 && y >= 0 && x < width_ && y < height_, "the pixel is on the canvas");
    const TilePtr& at = tile({x / kTileSize, y / kTileSize});
    if (!at) return 0;
    float sum = 0;
    for (std::size_t i = static_cast<std::size_t>((y % kTileSize) * kTileSize + x % kTileSize);
         i < at->thickness_mm.size(); i += PaintTile::kPixels)
        sum += at->thickness_mm[i];
    return sum;
}

void PaintLayer::add_thickness_mm(const Region& region, float* out, std::size_t stride) const {
    for (int ty = region.y0 / kTileSize; ty * kTileSize < region.y1; ++ty)
        for (int tx = region.x0 / kTileSize; tx * kTileSize < region.x1; ++tx) {
            const TilePtr& at = tile({tx, ty});
            if (!at) continue;
            const Region whole = region_of({tx, ty});
            const int x0 = std::max(region.x0, whole.x0), x1 = std::min(region.x1, whole.x1);
            const int y0 = std::max(region.y0, whole.y0), y1 = std::min(region.y1, whole.y1);
            for (std::size_t plane = 0; plane < at->ingredients.size(); ++plane)
                for (int y = y0; y < y1; ++y) {
                    const float* from = at->thickness_mm.data() + plane * PaintTile::kPixels +
                                        static_cast<std::size_t>((y - whole.y0) * kTileSize + x0 - whole.x0);
                    float* to = out + static_cast<std::size_t>(y - region.y0) * stride +
                                static_cast<std::size_t>(x0 - region.x0);
                    for (int x = 0; x < x1 - x0; ++x) to[x] += from[x];
                }
        }
}

std::size_t PaintLayer::bytes() const {
    std::size_t sum = sizeof *this + tiles_.capacity() * sizeof(TilePtr);
    for (const TilePtr& tile : tiles_)
        if (tile) sum += tile->bytes();
    return sum;
}

Region PaintLayer::region_of(TileIndex at) const {
    const int x0 = at.x * kTileSize, y0 = at.y * kTileSize;
    return {x0, y0, std::min(x0 + kTileSize, width_), std::min(y0 + kTileSize, height_)};
}

std::vector<double> volumes_mm3(const PaintLayer& layer, std::size_t ingredients, double mm_per_pixel) {
    std::vector<double> sums(ingredients, 0.0);
    for (const TileIndex at : layer.painted()) {
        const PaintTile& tile = *layer.tile(at);
        for (const IngredientId id : tile.ingredients) {
            TP_REQUIRE(paint_of(id) < ingredients, "the layer's ingredients are those that are counted");
            double sum = 0;
            for (const float mm : tile.plane(id)) sum += mm;
            sums[paint_of(id)] += sum;
        }
    }
    for (double& sum : sums) sum *= mm_per_pixel * mm_per_pixel;
    return sums;
}

bool identical(const PaintLayer& a, const PaintLayer& b) {
    if (a.width() != b.width() || a.height() != b.height()) return false;
    const auto same_plane = [](const PaintLayer::TilePtr& first, const PaintLayer::TilePtr& second,
                               IngredientId id) {
        const auto one = first ? first->plane(id) : std::span<const float>();
        const auto other = second ? second->plane(id) : std::span<const float>();
        const auto is_zero = [](float v) { return v == 0; };
        if (one.empty() || other.empty())
            return std::all_of(one.begin(), one.end(), is_zero) &&
                   std::all_of(other.begin(), other.end(), is_zero);
        return std::memcmp(one.data(), other.data(), one.size_bytes()) == 0;
    };
    for (int y = 0; y < a.rows(); ++y)
        for (int x = 0; x < a.columns(); ++x) {
            const auto &first = a.tile({x, y}), &second = b.tile({x, y});
            if (first == second) continue;
            for (const auto& tile : {first, second})
                if (tile)
                    for (const IngredientId id : tile->ingredients)
                        if (!same_plane(first, second, id)) return false;
        }
    return true;
}

}  // namespace tangi
