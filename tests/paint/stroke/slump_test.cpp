// slump_test.cpp: what brushes pile up flows down, however far.
#include "paint/stroke/slump.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "paint/stroke/step_rates.h"
#include "surface/base/parallel.h"
#include "tests/support/paint/paint_support.h"

namespace tangi {
namespace {

// [1] The steepest paint between neighbouring pixels.
double steepest(const Canvas& canvas) {
    const Image<float> mm = thickness_of(canvas);
    float step = 0;
    for (int y = 0; y + 1 < mm.height(); ++y)
        for (int x = 0; x + 1 < mm.width(); ++x)
            step = std::max({step, std::abs(mm(x, y) - mm(x + 1, y)), std::abs(mm(x, y) - mm(x, y + 1))});
    return static_cast<double>(step) / canvas.mm_per_pixel();
}

// A square block of paint in two colours, its left edge on that of a tile.
Canvas block(float height_mm) {
    Canvas canvas = flat_canvas(192, 192, 0.1);
    const auto white = add_paint(canvas, "Titanium White"), blue = add_paint(canvas, "Ultramarine Blue");
    for (int y = 70; y < 110; ++y)
        for (int x = 64; x < 104; ++x)
            canvas.writable_wet()
                .writable({x / kTileSize, y / kTileSize})
                .writable_plane(
                    y < 90 ? white
                           : blue)[static_cast<std::size_t>(y % kTileSize * kTileSize + x % kTileSize)] =
                height_mm;
    return canvas;
}

TEST(Collapse, AWallBecomesASlopeWhateverTheThreads) {
    std::vector<PaintLayer> results;
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        Canvas canvas = block(1);
        const auto before = canvas.volumes_mm3();
        const TransferRates rates = rates_of(BrushSettings{}, 0.1);
        DabMemory memory;
        int times = 0;
        for (; times < 20; ++times) {
            const std::vector<Region> walls =
                walls_in(canvas, std::vector{canvas.region()}, 1.5f * rates.yield_mm);
            if (walls.empty()) break;
            for (const Region& wall : walls) slump(canvas, wall, rates, memory);
        }
        EXPECT_LT(times, 8);
        EXPECT_LT(steepest(canvas), 1.5 * BrushSettings{}.yield_slope);
        // The middle has not moved.
        EXPECT_EQ(canvas.wet().thickness_mm(84, 90), 1);
        const auto after = canvas.volumes_mm3();
        for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i] / before[i], 1, 1e-6);
        results.push_back(canvas.wet());
    }
    set_thread_count(0);
    EXPECT_TRUE(identical(results[0], results[1]));
}

// A cliff in what is dry is none of the paint's, and what is no wall stays as it is.
TEST(Collapse, OnlyWallsOfPaintAreWalls) {
    auto ground = flat_surface(96, 96, 0.1);
    for (int y = 0; y < 96; ++y)
        for (int x = 48; x < 96; ++x) ground->height_mm(x, y) = 2;
    Canvas canvas(ground);
    const auto white = add_paint(canvas, "Titanium White");
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x)
            canvas.writable_wet()
                .writable({x / kTileSize, y / kTileSize})
                .writable_plane(white)[static_cast<std::size_t>(y % kTileSize * kTileSize + x % kTileSize)] =
                0.2f + 0.1f * static_cast<float>(x % 2);
    const TransferRates rates = rates_of(BrushSettings{}, 0.1);
    EXPECT_TRUE(walls_in(canvas, std::vector{canvas.region()}, 1.5f * rates.yield_mm).empty());
    EXPECT_FALSE(walls_in(block(1), std::vector{Region{60, 60, 80, 80}}, 1.5f * rates.yield_mm).empty());
}

// Before, dabs in one place were octagons with sides along the pixels, and strokes trays with vertical rims.
TEST(Collapse, PaintThatIsPiledUpHasNoWalls) {
    for (const double pixel_mm : {0.05, 0.15}) {
        const int side = static_cast<int>(14 / pixel_mm);
        Canvas dabs = flat_canvas(side, side, pixel_mm), strokes = flat_canvas(side, side, pixel_mm);
        const auto white = add_paint(dabs, "Titanium White"), red = add_paint(strokes, "Pyrrole Red");
        double laid[2] = {0, 0};
        for (int i = 0; i < 12; ++i) {
            BrushSettings round = brush_presets().at("round");
            round.size_mm = 3.5;
            BrushSettings blade = brush_presets().at("knife");
            blade.size_mm = 3;
            const auto seed = static_cast<std::uint64_t>(i);
            Brush dab(round, pixel_mm, seed), knife(blade, pixel_mm, seed);
            dab.load({{white, 1}}, 1);
            knife.load({{red, 1}}, 1);
            laid[0] += dab.volumes_mm3(1)[0];
            laid[1] += knife.volumes_mm3(1)[0];
            Stroke s(dabs, dab, {}, seed);
            s.add({0, 0, 0, 0.8, 0, 0, 0});
            s.finish();
            stroke(strokes, knife, {-4, -1}, {4, 1}, 0.6, seed);
            laid[0] -= dab.volumes_mm3(1)[0];
            laid[1] -= knife.volumes_mm3(1)[0];
        }
        EXPECT_LT(steepest(dabs), 1.55 * BrushSettings{}.yield_slope) << pixel_mm;
        EXPECT_LT(steepest(strokes), 1.55 * BrushSettings{}.yield_slope) << pixel_mm;
        EXPECT_NEAR(dabs.volumes_mm3()[0] / laid[0], 1, 1e-5) << pixel_mm;
        EXPECT_NEAR(strokes.volumes_mm3()[0] / laid[1], 1, 1e-5) << pixel_mm;
    }
}

}  // namespace
}  // namespace tangi
