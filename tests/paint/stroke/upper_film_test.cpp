// upper_film_test.cpp: which strokes have met other paint than they brought: that under their
// bristles.
#include "paint/stroke/upper_film.h"

#include <gtest/gtest.h>

#include <tuple>

#include "paint/canvas/layer_pictures.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(UpperFilm, PaintBesideAStrokeChangesNothing) {
    const auto painted = [](bool beside) {
        Canvas canvas = flat_canvas(200, 120);
        const auto red = add_paint(canvas, "Pyrrole Red"), yellow = add_paint(canvas, "Hansa Yellow Opaque");
        const auto paint = [&](IngredientId id, double y, int seed) {
            Brush brush(flat_of(3), kTestPixel, static_cast<std::uint64_t>(seed));
            brush.load({{id, 1}}, 1);
            stroke(canvas, brush, {-12, y}, {12, y}, 0.5);
        };
        if (beside) paint(yellow, 5, 1);
        paint(red, 0, 2);
        return canvas;
    };
    const Canvas with = painted(true), without = painted(false);
    bool shared_tile = false;
    for (const TileIndex at : with.wet().painted()) {
        const auto& ids = with.wet().tile(at)->ingredients;
        shared_tile = shared_tile || ids.size() == 2;
    }
    ASSERT_TRUE(shared_tile);
    EXPECT_FALSE(has_upper(with.wet()));
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 200; ++x)
            ASSERT_EQ(with.wet().thickness_mm(x, y, 0), without.wet().thickness_mm(x, y, 0)) << x << ' ' << y;
}

// Bristles that are held above it do not come over it.
TEST(UpperFilm, PaintUnderTheDomeOfALightBrushIsNotMet) {
    for (const auto& [preset, pressure, y_mm] :
         {std::tuple{"round", 0.1, 7.0}, {"round", 0.05, 7.0}, {"filbert", 0.6, 7.8}, {"fan", 0.6, 7.8}}) {
        Canvas canvas = flat_canvas(260, 160);
        const auto red = add_paint(canvas, "Pyrrole Red"), yellow = add_paint(canvas, "Hansa Yellow Opaque");
        BrushSettings settings = brush_presets().at(preset);
        settings.size_mm = 12;
        Brush line(flat_of(1.2), kTestPixel, 1), brush(settings, kTestPixel, 2);
        line.load({{yellow, 1}}, 1);
        stroke(canvas, line, {-20, y_mm}, {20, y_mm}, 0.5);
        const Image<float> before = thickness_mm_of(canvas.wet(), yellow);
        brush.load({{red, 1}}, 1);
        stroke(canvas, brush, {-18, 0}, {18, 0}, pressure);
        EXPECT_FALSE(has_upper(canvas.wet())) << preset << ' ' << pressure;
        const Image<float> after = thickness_mm_of(canvas.wet(), yellow);
        for (std::size_t i = 0; i < before.size(); ++i)
            ASSERT_NEAR(before.pixels()[i], after.pixels()[i], 2e-3) << preset << ' ' << pressure;
    }
}

// The same scene anywhere on a canvas: where tiles begin does not show.
TEST(UpperFilm, DoesNotKnowOfTiles) {
    const auto painted = [](int pixels) {  // to the right and down
        Canvas canvas = flat_canvas(200 + 2 * pixels, 120 + 2 * pixels);
        const auto yellow = add_paint(canvas, "Hansa Yellow Opaque"),
                   white = add_paint(canvas, "Titanium White");
        const auto paint = [&](IngredientId id, PathPoint from, PathPoint to) {
            Brush brush(flat_of(4), kTestPixel, 3);
            brush.load({{id, 1}}, 1);
            stroke(canvas, brush, from, to, 0.4);
        };
        paint(yellow, {4, -10}, {4, 10});
        paint(white, {-14, 2}, {14, -3});
        return canvas;
    };
    constexpr int kShift = 24;
    const Canvas here = painted(0), there = painted(kShift);
    ASSERT_TRUE(has_upper(here.wet()));
    for (const IngredientId id : {IngredientId(0), IngredientId(1), upper_of(0), upper_of(1)})
        for (int y = 0; y < 120; ++y)
            for (int x = 0; x < 200; ++x) {
                const auto at = [&](const Canvas& canvas, int px, int py) {
                    const auto& tile = canvas.wet().tile({px / kTileSize, py / kTileSize});
                    const auto plane = tile ? tile->plane(id) : std::span<const float>();
                    if (plane.empty()) return 0.0f;
                    return plane[static_cast<std::size_t>(py % kTileSize * kTileSize + px % kTileSize)];
                };
                ASSERT_NEAR(at(here, x, y), at(there, x + kShift, y + kShift), 2e-4)
                    << id << ' ' << x << ' ' << y;
            }
}

}  // namespace
}  // namespace tangi
