// tile_cache.h: which tiles of a painting are on the graphics device: those that are seen, and of those seen
// before as many as there is room for. No OpenGL.
//
// Every tile has a layer that is its home, by column and row modulo those of a grid; tiles of a view lie side
// by side there, and a shader finds them by arithmetic. Coarse levels have homes for all of their tiles,
// finer ones share what is left: those that are two levels apart, which are seen together, have no home in
// common. A tile whose home is needed by another that is seen lies elsewhere, and a table tells where.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "viewer/render/texels.h"

namespace tangi {

// What is seen of a painting at one level of detail: a convex outline [pixels of the painting].
struct TileView {
    int level = 0;
    std::vector<glm::dvec2> outline;
};

class TileCache {
public:
    TileCache() = default;
    // For a painting of so many pixels. Layers that only ever hold what is seen: `layers` >= 1.
    TileCache(int width, int height, int layers);

    struct Placed {
        TileName tile;
        int layer = 0;
    };
    struct Wanted {
        std::vector<Placed> placed;  // new ones: their texels are to be put into these layers
        bool complete = false;       // nothing is missing after that for which there is room
        bool exact = false;          // nor anything else of the views' own levels
        bool roomy = true;           // no tile had to go, and no level was given up, for want of layers
    };
    // Finds layers for up to `most` tiles that these views need: coarse ones first, which stand in for what
    // is missing, then from the middle outwards. Takes the layers of tiles that were not needed for longest.
    // `guest`: beside the picture that is seen (a loupe), whose tiles it drives from nowhere.
    Wanted want(std::span<const TileView> views, std::size_t most, bool guest = false);

    // Where tiles of a view are found: layer first + (column + left, less columns where that is not below it)
    // + columns * (the same of row). Empty where one of them is missing or not at home.
    struct Homes {
        int first = 0, columns = 1, rows = 1;
        int left = 0, top = 0;
    };
    std::optional<Homes> homes(const TileView& view) const;

    std::optional<int> layer_of(const TileName& tile) const;
    int all() const { return first_.back() + 1; }  // tiles of the painting, all levels
    int layers() const { return layers_; }
    int resident() const { return static_cast<int>(resident_.size()); }

    // For the shader: for each tile of each level, row by row, the layer (lower 11 bits) and level (upper 5)
    // of the finest tile on the device that covers it.
    std::vector<std::uint32_t> table() const;
    const std::vector<int>& first_entries() const { return first_; }  // of each level

private:
    struct Order {
        bool operator()(const TileName& a, const TileName& b) const {
            return std::tie(a.level, a.row, a.column) < std::tie(b.level, b.row, b.column);
        }
    };
    struct Entry {
        int layer = 0;
        std::uint64_t used = 0;  // the call of want() that needed it last
    };
    struct Missing {
        TileName tile;
        double distance = 0;  // [pixels of the painting] from the view's middle
    };
    void make_homes();
    int home_of(const TileName& tile) const;
    bool may_go(int layer, bool guest) const;
    void drive_out(int layer);
    void settle(const TileName& tile, int layer, Wanted& wanted);
    void send_home(std::span<const TileView> views, std::size_t most, Wanted& wanted);
    LevelSize size(int level) const { return level_size(width_, height_, level); }
    template <class Visit>
    void for_each_tile(int level, const std::vector<glm::dvec2>& outline, const Visit& visit) const;
    int affordable(const TileView& view) const;
    std::vector<Missing> missing_of(std::span<const TileView> views, Wanted& wanted);
    std::optional<int> layer_for(const TileName& tile, bool guest, bool& roomy);

    int width_ = 0, height_ = 0, layers_ = 0;
    std::vector<int> first_;
    std::vector<Homes> homes_;                   // of each level; left and top are of views
    std::vector<std::optional<TileName>> held_;  // by each layer
    std::map<TileName, Entry, Order> resident_;
    std::uint64_t call_ = 0, seen_call_ = 0;  // the last; the last that was no guest's
};

}  // namespace tangi
