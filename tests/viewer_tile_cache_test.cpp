// viewer_tile_cache_test.cpp: what is seen is on the device, and no more than fits.
#include "viewer/tile_cache.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "test_support.h"
#include "viewer/view.h"

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
        const Placement placement(view, tilt, false, {kWidth, kHeight}, screen, 1);
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

TEST(TileCache, HoldsNoMoreThanFitsAndForgetsTheOldest) {
    TileCache cache(4096, 4096, 12);
    const auto look = [&](double x, double y) {
        return cache.want(std::vector<TileView>{{0, rectangle(x, y, x + 200, y + 200)}}, SIZE_MAX);
    };
    EXPECT_EQ(look(20, 20).placed.size(), 3u) << "the coarsest, one that stands in, one that is meant";
    EXPECT_TRUE(look(20, 20).placed.empty()) << "it is there";
    for (int i = 1; i < 8; ++i) EXPECT_TRUE(look(20 + 512 * i, 20).exact);
    EXPECT_EQ(cache.resident(), 12);
    EXPECT_FALSE(cache.layer_of({0, 0, 0})) << "not needed for longest";
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
    EXPECT_EQ(layers.size(), 12u);
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
