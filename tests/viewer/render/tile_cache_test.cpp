// tile_cache_test.cpp: what is seen is on the device, and no more than fits.
#include "viewer/render/tile_cache.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/test_support.h"
#include "viewer/render/view.h"

namespace tangi {
namespace {

std::vector<glm::dvec2> rectangle(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

// Level and layer that the shader would find for this pixel at this level.
std::pair<int, int> found(const TileCache& cache, int width, int height, int level, int x, int y) {
    const std::size_t entry = static_cast<std::size_t>(
        cache.first_entries()[static_cast<std::size_t>(level)] +
        (y >> level >> kTileBits) * level_size(width, height, level).columns() + (x >> level >> kTileBits));
    const int code = cache.table().at(entry);
    return {code >> 11, code & 2047};
}

// However it is turned and tilted: the four texels around each place of the picture are there.
TEST(TileCache, HoldsWhatAShotShows) {
    constexpr int kWidth = 5000, kHeight = 3700;
    Random random(4);
    for (int i = 0; i < 40; ++i) {
        const Extent screen{640, 400};
        const View view{.centre_px = {random.real(0, kWidth), random.real(0, kHeight)},
                        .zoom = std::exp2(random.real(-4, 3)),
                        .turn_deg = random.real(0, 360)};
        Tilt tilt;
        tilt.angle_deg = {random.real(-70, 70), random.real(-70, 70)};
        const Placement placement(view, {tilt}, {kWidth, kHeight}, screen, 1);
        const Shot shot = placement.shot(1, true);
        TileCache cache(kWidth, kHeight, 2047);
        const int level = std::min(shot.level, level_count(kWidth, kHeight) - 1);
        const TileCache::Wanted wanted =
            cache.want(std::vector<TileView>{{level, outline_of(shot)}}, SIZE_MAX);
        EXPECT_TRUE(wanted.complete && wanted.exact);
        const auto table = cache.table();
        for (int sample = 0; sample < 300; ++sample) {
            glm::dvec2 p;
            const glm::dvec2 at(random.real(0, screen.width), random.real(0, screen.height));
            if (!placement.to_painting(at, p)) continue;
            const double half = 0.5 * (1 << level);
            for (const glm::dvec2 corner : {glm::dvec2(-half), {half, -half}, {-half, half}, {half, half}}) {
                const glm::ivec2 q(glm::floor(p + corner + 0.5));
                if (q.x < 0 || q.y < 0 || q.x >= kWidth || q.y >= kHeight) continue;
                ASSERT_EQ(found(cache, kWidth, kHeight, level, q.x, q.y).first, level)
                    << view.zoom << ": " << q.x << " " << q.y;
            }
        }
    }
}

TEST(TileCache, HoldsNoMoreThanFits) {
    TileCache cache(4096, 4096, 12);
    const auto look = [&](double x, double y) {
        return cache.want(std::vector<TileView>{{0, rectangle(x, y, x + 200, y + 200)}}, SIZE_MAX);
    };
    EXPECT_EQ(look(20, 20).placed.size(), 3u) << "the coarsest, one that stands in, one that is meant";
    EXPECT_TRUE(look(20, 20).placed.empty()) << "it is there";
    for (int i = 1; i < 8; ++i) EXPECT_TRUE(look(20 + 512 * i, 20).exact);
    EXPECT_LE(cache.resident(), 12);
    EXPECT_FALSE(cache.layer_of({0, 0, 0})) << "its home was needed";
    EXPECT_TRUE(cache.layer_of({0, 14, 0}));
    EXPECT_TRUE(cache.layer_of({8, 0, 0})) << "the coarsest stays";
    // No layer has two tiles.
    std::set<int> layers;
    for (int level = 0; level < 9; ++level)
        for (int row = 0; row < std::max(16 >> level, 1); ++row)
            for (int column = 0; column < std::max(16 >> level, 1); ++column) {
                const auto layer = cache.layer_of({level, column, row});
                EXPECT_TRUE(!layer || layers.insert(*layer).second) << level << " " << column << " " << row;
            }
    EXPECT_EQ(static_cast<int>(layers.size()), cache.resident());
}

// The layer that the shader reckons for a tile of a view.
int reckoned(const TileCache::Homes& homes, int column, int row) {
    int x = column + homes.left, y = row + homes.top;
    if (x >= homes.columns) x -= homes.columns;
    if (y >= homes.rows) y -= homes.rows;
    return homes.first + y * homes.columns + x;
}

// A picture that is panned and zoomed: its tiles are found without the table, and where they are, whatever
// has been seen before; one picture is no reason to fetch tiles of another twice.
TEST(TileCache, TilesOfAViewAreAtHome) {
    constexpr int kWidth = 9000, kHeight = 7000;
    Random random(8);
    for (const int layers : {100, 300, 2047}) {
        TileCache cache(kWidth, kHeight, layers);
        for (int i = 0; i < 200; ++i) {
            const int level = random.below(4);
            const double side = std::ldexp(1000.0, level), x = random.real(-500, kWidth - 100),
                         y = random.real(-500, kHeight - 100);
            const TileView view{level, rectangle(x, y, x + side, y + 0.6 * side)};
            EXPECT_TRUE(cache.want(std::vector{view}, SIZE_MAX).exact);
            const auto homes = cache.homes(view);
            ASSERT_TRUE(homes) << layers << ": " << level << ", " << x << ", " << y;
            const double texels = std::ldexp(kTileSide, level);
            for (int row = 0; row < level_size(kWidth, kHeight, level).rows(); ++row)
                for (int column = 0; column < level_size(kWidth, kHeight, level).columns(); ++column) {
                    if ((column + 1) * texels < x || column * texels > x + side) continue;
                    if ((row + 1) * texels < y || row * texels > y + 0.6 * side) continue;
                    ASSERT_EQ(reckoned(*homes, column, row), cache.layer_of({level, column, row}));
                }
            EXPECT_TRUE(cache.want(std::vector{view}, SIZE_MAX).placed.empty()) << "it is there";
        }
    }
}

TEST(TileCache, WhatIsMissingOrElsewhereIsNotAtHome) {
    TileCache cache(9000, 7000, 100);
    const TileView small{0, rectangle(10, 10, 300, 300)}, large{0, rectangle(10, 10, 4000, 1800)};
    EXPECT_FALSE(cache.homes(small));
    EXPECT_FALSE(cache.homes({0, {}}));
    cache.want(std::vector{small}, SIZE_MAX);
    EXPECT_TRUE(cache.homes(small));
    EXPECT_FALSE(cache.homes({0, rectangle(10, 10, 600, 300)})) << "one is missing";
    const TileCache::Wanted wanted = cache.want(std::vector{large}, SIZE_MAX);
    EXPECT_FALSE(wanted.roomy);
    EXPECT_FALSE(cache.homes(large)) << "more than a grid has";
}

// A loupe beside the picture finds room, and does not drive out what the picture needs, frame by frame.
TEST(TileCache, AGuestDrivesOutNothingThatIsSeen) {
    TileCache cache(9000, 7000, 100);
    const TileView picture{2, rectangle(0, 0, 4000, 2600)};
    for (int i = 0; i < 50; ++i) {
        const bool first = i == 0;
        const auto seen = cache.want(std::vector{picture}, SIZE_MAX);
        EXPECT_TRUE(seen.exact);
        EXPECT_TRUE(cache.homes(picture));
        if (i > 1) {
            EXPECT_TRUE(seen.placed.empty()) << i;
        }
        const double x = first ? 0 : 20.0 * i;
        EXPECT_TRUE(
            cache.want(std::vector{TileView{0, rectangle(x, x, x + 240, x + 240)}}, SIZE_MAX, true).exact);
    }
}

TEST(TileCache, TakesACoarserLevelWhereTheViewsOwnDoesNotFit) {
    TileCache cache(4096, 4096, 30);
    const std::vector<TileView> all = {{0, rectangle(0, 0, 4096, 4096)}};
    const TileCache::Wanted wanted = cache.want(all, SIZE_MAX);
    EXPECT_TRUE(wanted.complete);
    EXPECT_FALSE(wanted.exact);
    for (const auto& [x, y] : {std::pair(0, 0), {4095, 4095}, {2000, 100}})
        EXPECT_EQ(found(cache, 4096, 4096, 0, x, y).first, 2) << "16 tiles, and one that stands in";
}

TEST(TileCache, BringsCoarseTilesFirstThenThoseInTheMiddle) {
    TileCache cache(4096, 4096, 400);
    const std::vector<TileView> all = {{0, rectangle(0, 0, 4096, 4096)}};
    std::vector<TileName> order;
    for (int i = 0; i < 1000; ++i) {
        const TileCache::Wanted wanted = cache.want(all, 3);
        EXPECT_LE(wanted.placed.size(), 3u);
        for (const auto& placed : wanted.placed) order.push_back(placed.tile);
        if (wanted.complete) break;
    }
    ASSERT_EQ(order.size(), 256u + 16 + 1);
    EXPECT_EQ(order[0], (TileName{8, 0, 0}));
    for (std::size_t i = 1; i < order.size(); ++i) EXPECT_LE(order[i].level, order[i - 1].level);
    const auto out = [](const TileName& t) {
        return std::max(std::abs(t.column - 7.5), std::abs(t.row - 7.5));
    };
    EXPECT_EQ(out(order[17]), 0.5);
    EXPECT_EQ(out(order.back()), 7.5);
}

TEST(TileCache, WhatIsMissingHasTheNextCoarser) {
    TileCache cache(4096, 4096, 400);
    EXPECT_TRUE(cache.want({}, 1).complete);
    EXPECT_EQ(found(cache, 4096, 4096, 0, 3000, 10), (std::pair{8, *cache.layer_of({8, 0, 0})}));
    cache.want(std::vector<TileView>{{0, rectangle(10, 10, 20, 20)}}, 1);
    EXPECT_EQ(found(cache, 4096, 4096, 0, 1000, 10), (std::pair{2, *cache.layer_of({2, 0, 0})}));
    EXPECT_EQ(found(cache, 4096, 4096, 1, 1000, 10).first, 2);
    EXPECT_EQ(found(cache, 4096, 4096, 0, 3000, 10).first, 8);
}

}  // namespace
}  // namespace tangi
