#include "viewer/tile_cache.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "surface/error.h"
#include "viewer/view.h"

namespace tangi {

namespace {

constexpr int kStandIn = 2;  // [levels] coarser: sixteen times as much for one tile

}  // namespace

TileCache::TileCache(int width, int height, int layers) : width_(width), height_(height) {
    int entries = 0;
    for (int level = 0; level < level_count(width, height); ++level) {
        first_.push_back(entries);
        entries += size(level).columns() * size(level).rows();
    }
    layers_ = std::min(layers, entries);
    TP_REQUIRE(layers_ >= 1 && layers_ <= 2048, "a tile fits, and its layer into 11 bits");
    free_.resize(static_cast<std::size_t>(layers_));
    std::iota(free_.rbegin(), free_.rend(), 0);
}

// Tiles that an outline touches, with the texels beside it, which are mixed into those at its border.
template <class Visit>
void TileCache::for_each_tile(int level, const std::vector<glm::dvec2>& outline, const Visit& visit) const {
    const double side = std::ldexp(kTileSide, level), beside = std::ldexp(1.0, level);
    const LevelSize all = size(level);
    for (int row = 0; row < all.rows(); ++row) {
        const double top = row * side - 0.5 - beside, bottom = (row + 1) * side - 0.5 + beside;
        const auto strip = clipped(clipped(outline, {0, 1}, top), {0, -1}, -bottom);
        if (strip.empty()) continue;
        double left = strip.front().x, right = left;
        for (const glm::dvec2& p : strip) {
            left = std::min(left, p.x);
            right = std::max(right, p.x);
        }
        const auto column = [&](double x) {
            return static_cast<int>(std::clamp(std::floor((x + 0.5) / side), -1.0, 1.0 * all.columns()));
        };
        for (int c = std::max(column(left - beside), 0);
             c <= std::min(column(right + beside), all.columns() - 1); ++c)
            visit(TileName{level, c, row});
    }
}

// The finest level, from the view's on, whose tiles fit together with those that stand in for them.
int TileCache::affordable(const TileView& view) const {
    const int last = static_cast<int>(first_.size()) - 1;
    int level = std::clamp(view.level, 0, last);
    if (layers_ >= all()) return level;
    for (; level < last; ++level) {
        int count = 1;
        for (const int l : {level, level + kStandIn})
            if (l < last) for_each_tile(l, view.outline, [&](const TileName&) { ++count; });
        if (count <= layers_) break;
    }
    return level;
}

std::optional<int> TileCache::free_layer() {
    if (free_.empty()) {
        const auto oldest =
            std::min_element(resident_.begin(), resident_.end(),
                             [](const auto& a, const auto& b) { return a.second.used < b.second.used; });
        if (oldest->second.used == call_) return {};
        free_.push_back(oldest->second.layer);
        resident_.erase(oldest);
    }
    const int layer = free_.back();
    free_.pop_back();
    return layer;
}

TileCache::Wanted TileCache::want(std::span<const TileView> views, std::size_t most) {
    ++call_;
    const int last = static_cast<int>(first_.size()) - 1;
    struct Missing {
        TileName tile;
        double distance;
    };
    std::vector<Missing> missing;
    Wanted wanted{.placed = {}, .complete = true, .exact = true, .roomy = true};
    const auto need = [&](const TileName& tile, double distance) {
        if (const auto there = resident_.find(tile); there != resident_.end())
            there->second.used = call_;
        else
            missing.push_back({tile, distance});
    };
    const auto refuse_exact = [&] { wanted.exact = wanted.roomy = false; };
    need({last, 0, 0}, 0);
    for (const TileView& view : views) {
        if (view.outline.empty()) continue;
        const int level = affordable(view);
        if (level != std::clamp(view.level, 0, last)) refuse_exact();
        glm::dvec2 middle(0);
        for (const glm::dvec2& p : view.outline) middle += p / static_cast<double>(view.outline.size());
        for (const int l : {level + kStandIn, level})
            if (l < last)
                for_each_tile(l, view.outline, [&](const TileName& tile) {
                    const glm::dvec2 centre =
                        std::ldexp(kTileSide, l) * (glm::dvec2(tile.column, tile.row) + 0.5);
                    need(tile, glm::length(centre - middle));
                });
    }
    std::stable_sort(missing.begin(), missing.end(), [](const Missing& a, const Missing& b) {
        return std::pair(-a.tile.level, a.distance) < std::pair(-b.tile.level, b.distance);
    });
    for (const Missing& m : missing) {
        if (resident_.contains(m.tile)) continue;  // two views need it
        if (wanted.placed.size() == most) {
            wanted.complete = wanted.exact = false;
            break;
        }
        wanted.roomy = wanted.roomy && !free_.empty();
        const auto layer = free_layer();
        if (!layer) {
            refuse_exact();
            break;
        }
        resident_[m.tile] = {*layer, call_};
        wanted.placed.push_back({m.tile, *layer});
    }
    return wanted;
}

std::optional<int> TileCache::layer_of(const TileName& tile) const {
    const auto found = resident_.find(tile);
    if (found == resident_.end()) return {};
    return found->second.layer;
}

std::vector<std::uint32_t> TileCache::table() const {
    std::vector<std::uint32_t> table(static_cast<std::size_t>(all()));
    for (int level = static_cast<int>(first_.size()) - 1; level >= 0; --level) {
        const LevelSize all = size(level);
        std::size_t i = static_cast<std::size_t>(first_[static_cast<std::size_t>(level)]);
        for (int row = 0; row < all.rows(); ++row)
            for (int column = 0; column < all.columns(); ++column, ++i)
                if (const auto layer = layer_of({level, column, row}))
                    table[i] = static_cast<std::uint32_t>(*layer | level << 11);
                else if (level + 1 < static_cast<int>(first_.size()))
                    table[i] = table[static_cast<std::size_t>(first_[static_cast<std::size_t>(level) + 1] +
                                                              (row >> 1) * size(level + 1).columns() +
                                                              (column >> 1))];
    }
    return table;
}

}  // namespace tangi
