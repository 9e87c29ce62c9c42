#include "viewer/render/tile_cache.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <glm/common.hpp>

#include "surface/base/error.h"
#include "viewer/render/view.h"

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
    held_.resize(static_cast<std::size_t>(layers_));
    make_homes();
}

// From the coarsest level down, as many levels as fit into half of the layers have a home for each tile; all,
// where all fit. The others share two grids in turn, two levels the same one.
void TileCache::make_homes() {
    homes_.resize(first_.size());
    int shared = layers_, level = static_cast<int>(first_.size()) - 1;
    for (; level >= 0; --level) {
        const LevelSize whole = size(level);
        const int tiles = whole.columns() * whole.rows();
        const bool fits = layers_ == all() || layers_ - shared + tiles <= std::max(layers_ / 2, 1);
        if (!fits) break;
        shared -= tiles;
        homes_[static_cast<std::size_t>(level)] = {
            .first = shared, .columns = whole.columns(), .rows = whole.rows()};
    }
    const int grids = level >= 2 ? 2 : 1, room = std::max(shared / grids, 1);
    for (; level >= 0; --level) {
        const LevelSize whole = size(level);
        Homes& homes = homes_[static_cast<std::size_t>(level)];
        homes.first = std::min((level / 2 % grids) * room, layers_ - 1);
        // Screens are wider than high.
        homes.columns =
            std::clamp(static_cast<int>(std::sqrt(1.6 * room)), 1, std::min(whole.columns(), room));
        homes.rows = std::min(whole.rows(), room / homes.columns);
        homes.columns = std::min(whole.columns(), room / homes.rows);
    }
}

int TileCache::home_of(const TileName& tile) const {
    const Homes& homes = homes_[static_cast<std::size_t>(tile.level)];
    return homes.first + tile.column % homes.columns + homes.columns * (tile.row % homes.rows);
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

bool TileCache::may_go(int layer, bool guest) const {
    const auto& tile = held_[static_cast<std::size_t>(layer)];
    const std::uint64_t used = tile ? resident_.at(*tile).used : 0;
    return used != call_ && !(guest && used == seen_call_);
}

void TileCache::drive_out(int layer) {
    auto& tile = held_[static_cast<std::size_t>(layer)];
    if (tile) resident_.erase(*tile);
    tile.reset();
}

// Its home; where that is needed, one that is free, or of the tile that was not needed for longest.
std::optional<int> TileCache::layer_for(const TileName& tile, bool guest, bool& roomy) {
    const int home = home_of(tile);
    if (!held_[static_cast<std::size_t>(home)]) return home;
    if (!guest) roomy = false;
    if (may_go(home, guest)) return home;
    std::optional<int> oldest;
    std::uint64_t used = 0;
    for (int layer = 0; layer < layers_; ++layer) {
        const auto& other = held_[static_cast<std::size_t>(layer)];
        if (!other) return layer;
        const std::uint64_t its = resident_.at(*other).used;
        if (may_go(layer, guest) && (!oldest || its < used)) oldest = layer, used = its;
    }
    if (oldest) roomy = false;
    return oldest;
}

void TileCache::settle(const TileName& tile, int layer, Wanted& wanted) {
    drive_out(layer);
    held_[static_cast<std::size_t>(layer)] = tile;
    resident_[tile] = {layer, call_};
    wanted.placed.push_back({tile, layer});
}

// Those that are seen and lie elsewhere, since their home was needed.
void TileCache::send_home(std::span<const TileView> views, std::size_t most, Wanted& wanted) {
    for (const TileView& view : views) {
        const int level = std::clamp(view.level, 0, static_cast<int>(first_.size()) - 1);
        if (view.outline.empty()) continue;
        for_each_tile(level, view.outline, [&](const TileName& tile) {
            const auto layer = layer_of(tile);
            const int home = home_of(tile);
            if (!layer || *layer == home || wanted.placed.size() >= most || !may_go(home, false)) return;
            drive_out(*layer);
            settle(tile, home, wanted);
        });
    }
}

// What these views need and is not there, in the order in which it is to come; what is there counts as needed
// now. Notes in `wanted` where a coarser level than the view's has to do.
std::vector<TileCache::Missing> TileCache::missing_of(std::span<const TileView> views, Wanted& wanted) {
    const int last = static_cast<int>(first_.size()) - 1;
    std::vector<Missing> missing;
    const auto need = [&](const TileName& tile, double distance) {
        if (const auto there = resident_.find(tile); there != resident_.end())
            there->second.used = call_;
        else
            missing.push_back({tile, distance});
    };
    need({last, 0, 0}, 0);
    for (const TileView& view : views) {
        if (view.outline.empty()) continue;
        const int level = affordable(view);
        if (level != std::clamp(view.level, 0, last)) wanted.exact = wanted.roomy = false;
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
    return missing;
}

TileCache::Wanted TileCache::want(std::span<const TileView> views, std::size_t most, bool guest) {
    ++call_;
    if (!guest) seen_call_ = call_;
    Wanted wanted{.placed = {}, .complete = true, .exact = true, .roomy = true};
    for (const Missing& m : missing_of(views, wanted)) {
        if (resident_.contains(m.tile)) continue;  // two views need it
        if (wanted.placed.size() == most) {
            wanted.complete = wanted.exact = false;
            break;
        }
        const auto layer = layer_for(m.tile, guest, wanted.roomy);
        if (!layer) {
            wanted.exact = wanted.roomy = false;
            break;
        }
        settle(m.tile, *layer, wanted);
    }
    if (!guest) send_home(views, most, wanted);
    return wanted;
}

std::optional<int> TileCache::layer_of(const TileName& tile) const {
    const auto found = resident_.find(tile);
    if (found == resident_.end()) return {};
    return found->second.layer;
}

std::optional<TileCache::Homes> TileCache::homes(const TileView& view) const {
    const int level = std::clamp(view.level, 0, static_cast<int>(first_.size()) - 1);
    if (view.outline.empty()) return {};
    Homes homes = homes_[static_cast<std::size_t>(level)];
    glm::ivec2 low(INT_MAX), high(-1);
    bool all_at_home = true;
    for_each_tile(level, view.outline, [&](const TileName& tile) {
        low = glm::min(low, glm::ivec2(tile.column, tile.row));
        high = glm::max(high, glm::ivec2(tile.column, tile.row));
        all_at_home = all_at_home && layer_of(tile) == home_of(tile);
    });
    if (!all_at_home || high.x < low.x || high.x - low.x >= homes.columns || high.y - low.y >= homes.rows)
        return {};
    homes.left = -(low.x / homes.columns) * homes.columns;
    homes.top = -(low.y / homes.rows) * homes.rows;
    return homes;
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
