// paint_settle_test.cpp: paint that was left lies on a grid of volumes, and none of it is lost.
#include <gtest/gtest.h>

#include <cmath>

#include "paint/canvas.h"
#include "paint/settle.h"
#include "paint/stroke.h"
#include "surface/noise.h"
#include "tests/paint_support.h"

namespace tangi {
namespace {

bool lies_on_grid(float mm) { return std::fmod(mm, kVolumeGrid_mm) == 0; }

bool lies_on_grid(const PaintLayer& layer) {
    for (const TileIndex at : layer.painted())
        if (!std::ranges::all_of(layer.tile(at)->thickness_mm, [](float mm) { return lies_on_grid(mm); }))
            return false;
    return true;
}

double sum_of(std::span<const float> plane) {
    double sum = 0;
    for (const float mm : plane) sum += static_cast<double>(mm);
    return sum;
}

// Uniform from 0 to `most_mm`, in a part of the pixels.
PaintTile random_tile(float most_mm, float part) {
    PaintTile tile;
    const std::span<float> plane = tile.writable_plane(3);
    for (std::size_t i = 0; i < plane.size(); ++i)
        if (procedural::uniform(procedural::hash(1, i)) < part)
            plane[i] = most_mm * procedural::uniform(procedural::hash(2, i));
    return tile;
}

TEST(Settle, KeepsTheVolumeToHalfAStepOfTheGrid) {
    for (const float most_mm : {1e-9f, 1e-6f, 1e-3f, 0.3f, 1.9f})
        for (const float part : {1.0f, 0.3f, 0.002f}) {
            PaintTile tile = random_tile(most_mm, part);
            const double before = sum_of(tile.plane(3));
            settle(tile, nullptr);
            EXPECT_NEAR(sum_of(tile.plane(3)), before, (0.5 + 1e-3 * before) * kVolumeGrid_mm)
                << most_mm << " " << part;
            for (const float mm : tile.thickness_mm) ASSERT_TRUE(mm >= 0 && lies_on_grid(mm)) << mm;
        }
}

// As many columns as there are, each with a pixel that is rounded up.
TEST(Settle, ManyThatRoundTheSameWayDoNotAddUp) {
    for (const float steps : {0.6f, 0.4f, 1.4f, 1.6f}) {
        PaintTile tile;
        for (std::size_t x = 0; x < PaintTile::kSize; ++x)
            tile.writable_plane(3)[64 * (x % 7) + x] = steps * kVolumeGrid_mm;
        settle(tile, nullptr);
        EXPECT_NEAR(sum_of(tile.plane(3)) / kVolumeGrid_mm, 64 * steps, 0.501) << steps;
    }
}

TEST(Settle, NoPixelChangesByMoreThanTwoSteps) {
    const PaintTile before = random_tile(0.1f, 0.5f);
    PaintTile tile = before;
    settle(tile, nullptr);
    for (std::size_t i = 0; i < PaintTile::kPixels; ++i) {
        EXPECT_NEAR(tile.plane(3)[i], before.plane(3)[i], 2 * kVolumeGrid_mm);
        EXPECT_TRUE(before.plane(3)[i] > 0 || tile.plane(3)[i] == 0) << "paint where there was none";
    }
}

TEST(Settle, LeavesAloneWhatDidNotChange) {
    const PaintTile before = random_tile(0.1f, 1);
    PaintTile tile = before;
    for (std::size_t i = 0; i < PaintTile::kPixels; i += 7) tile.writable_plane(3)[i] += 0.01f;
    settle(tile, &before);
    for (std::size_t i = 0; i < PaintTile::kPixels; ++i)
        if (i % 7)
            ASSERT_EQ(tile.plane(3)[i], before.plane(3)[i]) << i;
        else
            ASSERT_TRUE(lies_on_grid(tile.plane(3)[i])) << i;
}

TEST(Settle, WhatIsThickStaysAsItIs) {
    PaintTile tile = random_tile(1e6f, 0.5f);
    const PaintTile before = tile;
    settle(tile, nullptr);
    for (std::size_t i = 0; i < PaintTile::kPixels; ++i)
        ASSERT_NEAR(tile.plane(3)[i], before.plane(3)[i], 1e-6f * before.plane(3)[i]) << i;
}

TEST(Settle, PaintsOfWhichNothingIsLeftLeaveTheTile) {
    PaintTile tile = random_tile(0.1f, 1);
    tile.writable_plane(7)[100] = 1e-12f;
    tile.writable_plane(upper_of(3))[5] = 1e-9f;
    settle(tile, nullptr);
    EXPECT_EQ(tile.ingredients, std::vector<IngredientId>{3});
    EXPECT_EQ(tile.thickness_mm.size(), std::size_t(PaintTile::kPixels));
}

// A brush that crosses one paint after the other leaves traces of each.
TEST(Settle, WhatStrokesLeaveLiesOnTheGridWetAndDry) {
    Canvas canvas = flat_canvas(400, 160);
    for (const char* name : {"Hansa Yellow Opaque", "Ultramarine Blue", "Pyrrole Red", "Titanium White"})
        add_paint(canvas, name);
    std::vector<double> brought(4), left(4);
    for (int i = 0; i < 4; ++i) {
        Brush brush(brush_presets().at("flat"), kTestPixel, static_cast<std::uint64_t>(i));
        brush.load({{static_cast<IngredientId>(i), 1}}, 1);
        const auto before = brush.volumes_mm3(4);
        stroke(canvas, brush, {-40.0 + 3 * i, 8.0 - 5 * i}, {40, 5.0 * i - 8});
        const auto after = brush.volumes_mm3(4);
        for (std::size_t k = 0; k < 4; ++k) {
            brought[k] += before[k];
            left[k] += after[k];
        }
    }
    EXPECT_TRUE(lies_on_grid(canvas.wet()));
    dry(canvas, "part", {}, 0.37);
    ASSERT_EQ(canvas.dried().size(), 1u);
    EXPECT_TRUE(lies_on_grid(canvas.wet()));
    EXPECT_TRUE(lies_on_grid(canvas.dried()[0].paint));
    const auto there = canvas.volumes_mm3();
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR((there[k] + left[k]) / brought[k], 1, 1e-6) << k;
}

// For as long as a stroke lasts, what settles is not drawn again.
TEST(Settle, IsToldApartFromWhatIsPainted) {
    Canvas canvas = flat_canvas(700, 100);
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush brush(brush_presets().at("flat"), kTestPixel, 1);
    brush.load({{red, 1}}, 1);
    Stroke s(canvas, brush, {}, 1);
    std::size_t painted = 0;
    for (int i = 0; i <= 150; ++i) {
        s.add({i * 0.01, i - 75.0, 0, 0.6, 0, 0, 0});
        for (const Region& part : canvas.take_painted())
            painted = std::max(painted, static_cast<std::size_t>(part.width()));
    }
    EXPECT_LE(painted, 64u);
    EXPECT_LT(painted, 60u) << "a step's part of a tile, not all of it";
    const auto settled = canvas.take_dirty();
    EXPECT_GE(settled.size(), 8u);
    s.finish();
    EXPECT_TRUE(lies_on_grid(canvas.wet()));
}

}  // namespace
}  // namespace tangi
