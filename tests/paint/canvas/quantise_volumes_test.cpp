// quantise_volumes_test.cpp: paint that was left lies on a grid of volumes, and none of it is lost.
#include <gtest/gtest.h>

#include <cmath>

#include "paint/canvas/canvas.h"
#include "paint/canvas/quantise_volumes.h"
#include "paint/stroke/stroke.h"
#include "surface/base/noise.h"
#include "tests/support/paint/paint_support.h"

namespace tangi {
namespace {

bool lies_on_grid(float mm) { return std::fmod(mm, kVolumeGrid_mm) == 0; }

// But for one pixel, which has what is left, for each time that it settled.
bool lies_on_grid(std::span<const float> plane, int times = 1) {
    return std::ranges::count_if(plane, [](float mm) { return !lies_on_grid(mm); }) <= times;
}

bool lies_on_grid(const PaintLayer& layer, int times) {
    for (const TileIndex at : layer.painted())
        for (const IngredientId id : layer.tile(at)->ingredients)
            if (!lies_on_grid(layer.tile(at)->plane(id), times)) return false;
    return true;
}

constexpr int kTimes = 8;  // a few strokes, each of which may settle more than once

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

TEST(Settle, KeepsTheVolume) {
    for (const float most_mm : {1e-9f, 1e-6f, 1e-3f, 0.3f, 1.9f})
        for (const float part : {1.0f, 0.3f, 0.002f}) {
            PaintTile tile = random_tile(most_mm, part);
            const double before = sum_of(tile.plane(3));
            settle(tile, nullptr);
            EXPECT_NEAR(sum_of(tile.plane(3)), before, 2e-3 * kVolumeGrid_mm + 6e-8 * before)
                << most_mm << " " << part;
            EXPECT_TRUE(lies_on_grid(tile.plane(3)));
            EXPECT_TRUE(std::ranges::all_of(tile.plane(3), [](float mm) { return mm >= 0; }));
        }
}

// As many columns as there are, each with a pixel that is rounded up.
TEST(Settle, ManyThatRoundTheSameWayDoNotAddUp) {
    for (const float steps : {0.6f, 0.4f, 1.4f, 1.6f}) {
        PaintTile tile;
        for (std::size_t x = 0; x < PaintTile::kSize; ++x)
            tile.writable_plane(3)[64 * (x % 7) + x] = steps * kVolumeGrid_mm;
        settle(tile, nullptr);
        EXPECT_NEAR(sum_of(tile.plane(3)) / kVolumeGrid_mm, 64 * steps, 0.002) << steps;
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
    int off_grid = 0;
    for (std::size_t i = 0; i < PaintTile::kPixels; ++i)
        if (i % 7)
            ASSERT_EQ(tile.plane(3)[i], before.plane(3)[i]) << i;
        else
            off_grid += !lies_on_grid(tile.plane(3)[i]);
    EXPECT_LE(off_grid, 1);
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
    tile.writable_plane(upper_of(3))[5] = 1e-20f;
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
    EXPECT_TRUE(lies_on_grid(canvas.wet(), kTimes));
    dry(canvas, "part", {}, 0.37);
    ASSERT_EQ(canvas.dried().size(), 1u);
    EXPECT_TRUE(lies_on_grid(canvas.wet(), kTimes));
    EXPECT_TRUE(lies_on_grid(canvas.dried()[0].paint, kTimes));
    const auto there = canvas.volumes_mm3();
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR((there[k] + left[k]) / brought[k], 1, 1e-6) << k;
}

// What was erased stays so, however much is owed.
TEST(Settle, NothingComesWhereNothingIsLeft) {
    PaintTile before = random_tile(1.99f, 1), tile = before;
    for (std::size_t i = 0; i < PaintTile::kPixels; ++i) {
        float& mm = tile.writable_plane(3)[i];
        mm = i / PaintTile::kSize % 2 ? 0 : 0.73f * mm;
    }
    settle(tile, &before);
    for (std::size_t i = 0; i < PaintTile::kPixels; ++i)
        ASSERT_TRUE(i / PaintTile::kSize % 2 == 0 || tile.plane(3)[i] == 0) << i;
}

// Traces of a strong paint, by shares that are less than a step of the grid.
TEST(Settle, AShareThatDriesHasTheRecipe) {
    for (const double share : {0.01, 0.1, 0.5}) {
        Canvas canvas = flat_canvas(400, 160);
        const auto white = add_paint(canvas, "Titanium White"), blue = add_paint(canvas, "Ultramarine Blue");
        Brush brush(brush_presets().at("flat"), kTestPixel, 1);
        brush.load({{white, 10000}, {blue, 1}}, 0.1);
        stroke(canvas, brush, {-40, 0}, {40, 0});
        dry(canvas, "share", {}, share);
        ASSERT_EQ(canvas.dried().size(), 1u);
        const auto wet = volumes_mm3(canvas.wet(), 2, kTestPixel),
                   dried = volumes_mm3(canvas.dried()[0].paint, 2, kTestPixel);
        EXPECT_NEAR(1e4 * wet[blue] / wet[white], 1, 0.01) << share;
        EXPECT_NEAR(1e4 * dried[blue] / dried[white], 1, 0.02) << share;
        EXPECT_NEAR(dried[white] / (wet[white] + dried[white]), share, 1e-3 * share);
    }
}

TEST(Settle, ConservesTheVolumeOfTraces) {
    Canvas canvas = flat_canvas(400, 160);
    const auto white = add_paint(canvas, "Titanium White"), blue = add_paint(canvas, "Ultramarine Blue");
    Brush brush(brush_presets().at("flat"), kTestPixel, 1);
    brush.load({{white, 1e6}, {blue, 1}}, 1);
    const auto before = on_both(canvas, brush);
    for (int i = 0; i < 10; ++i) stroke(canvas, brush, {-40, i - 5.0}, {40, 5.0 - i});
    EXPECT_NEAR(on_both(canvas, brush)[blue] / before[blue], 1, 1e-5);
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
    EXPECT_EQ(canvas.take_settled(2).size(), 2u);
    EXPECT_GE(canvas.take_dirty().size(), 6u);
    EXPECT_FALSE(canvas.has_settled());
    s.finish();
    EXPECT_TRUE(lies_on_grid(canvas.wet(), kTimes));
}

}  // namespace
}  // namespace tangi
