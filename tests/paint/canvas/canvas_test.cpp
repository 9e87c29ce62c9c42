// canvas_test.cpp: recipes, drying, lifting off, dirty tiles.
#include "paint/canvas/canvas.h"

#include <gmock/gmock.h>

#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A canvas with a stroke of three parts white and one blue.
Canvas painted_once() {
    Canvas canvas = flat_canvas();
    const auto white = add_paint(canvas, "Titanium White"), blue = add_paint(canvas, "Ultramarine Blue");
    Brush brush(even_brush(), kTestPixel, 1);
    brush.load({{white, 3}, {blue, 1}}, 1);
    stroke(canvas, brush, {-10, 0}, {10, 0});
    return canvas;
}

TEST(Canvas, KnowsEachPaintOnce) {
    Canvas canvas = flat_canvas();
    EXPECT_EQ(add_paint(canvas, "Titanium White"), 0);
    EXPECT_EQ(add_paint(canvas, "Bone Black"), 1);
    EXPECT_EQ(add_paint(canvas, "Titanium White"), 0);
    Pigment glossy = artist_acrylics().at("Titanium White");
    glossy.roughness = 0.05f;
    EXPECT_EQ(canvas.add(glossy), 2);
}

TEST(Canvas, GivesAScaleToASurfaceThatHasNone) {
    auto surface = flat_surface(32, 32);
    EXPECT_THAT(error_of([&] { Canvas(surface, 0.1); }), HasSubstr("0.25 mm, not 0.1 mm"));
    surface->mm_per_pixel = 0.3;  // as a file gives it back, and as an earlier version did
    EXPECT_EQ(Canvas(surface, static_cast<double>(0.3f)).mm_per_pixel(), 0.3);
    surface->scale_known = false;
    surface->mm_per_pixel = 1;
    surface->height_mm(3, 4) = 2;  // pixels
    const Canvas canvas(surface, 0.1);
    EXPECT_EQ(canvas.mm_per_pixel(), 0.1);
    float height = 0;
    canvas.relief_mm({3, 4, 4, 5}, &height, 1);
    EXPECT_FLOAT_EQ(height, 0.2f);
    EXPECT_THAT(error_of([&] { Canvas(surface, -1.0); }), HasSubstr("-1"));
}

TEST(Canvas, RecipesCanBeReadBack) {
    const Canvas canvas = painted_once();
    const Recipe recipe = recipe_at(canvas, 64, 48, 3);
    ASSERT_EQ(recipe.portions.size(), 2u);
    EXPECT_NEAR(recipe.portions[0].part, 0.75, 1e-5);
    EXPECT_NEAR(recipe.portions[1].part, 0.25, 1e-5);
    EXPECT_GT(recipe.thickness_mm, 0.02);
    EXPECT_TRUE(recipe_at(canvas, 5, 5, 3).portions.empty());
    EXPECT_TRUE(recipe_at(canvas, -50, 5, 3).portions.empty());
}

TEST(Canvas, DryingMovesPaintAndKeepsItsVolume) {
    Canvas canvas = painted_once();
    const auto before = canvas.volumes_mm3();
    const float mm = canvas.wet().thickness_mm(64, 48);
    dry(canvas, "first", {}, 0.25);
    EXPECT_NEAR(canvas.wet().thickness_mm(64, 48), 0.75f * mm, 1e-6);
    EXPECT_NEAR(canvas.dried()[0].paint.thickness_mm(64, 48), 0.25f * mm, 1e-6);
    dry(canvas, "second");
    EXPECT_EQ(canvas.dried().size(), 2u);
    EXPECT_TRUE(canvas.wet().empty());
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(canvas.volumes_mm3()[i] / before[i], 1, 1e-6);
    EXPECT_THAT(error_of([&] { dry(canvas, "x", {}, 0); }), HasSubstr("part = 0"));
}

// Paint that dried before and paint that dries now are two films, whatever they are called: white under blue
// is no light blue.
TEST(Canvas, WhatDriesIsALayerOfItsOwnWithANameOfItsOwn) {
    Canvas canvas = flat_canvas();
    const auto paint = [&](const std::string& name) {
        Brush brush(even_brush(), kTestPixel, 1);
        brush.load({{add_paint(canvas, name), 1}}, 1);
        stroke(canvas, brush, {-10, 0}, {10, 0});
    };
    paint("Titanium White");
    EXPECT_EQ(dry(canvas, "retouch"), "retouch");
    paint("Ultramarine Blue");
    EXPECT_EQ(dry(canvas, "retouch", CirclePart{{-5, 0}, 3}), "retouch 2");
    EXPECT_EQ(dry(canvas, "retouch"), "retouch 3");
    EXPECT_EQ(dry(canvas, "retouch"), "");  // there is no wet paint any more
    ASSERT_EQ(canvas.dried().size(), 3u);
    EXPECT_EQ(canvas.dried()[0].paint.thickness_mm(64, 48, 1), 0) << "no blue in the white";
    EXPECT_EQ(canvas.dried()[2].paint.thickness_mm(64, 48, 0), 0) << "no white in the blue";

    lift_off(canvas, "retouch");  // of those below, nothing is lost
    ASSERT_EQ(canvas.dried().size(), 2u);
    EXPECT_EQ(canvas.dried()[0].name, "retouch 2");
    paint("Bone Black");
    EXPECT_EQ(dry(canvas, "retouch 2"), "retouch 4");  // 3 is taken
    EXPECT_EQ(free_layer_name(canvas, "retouch"), "retouch");
    EXPECT_EQ(free_layer_name(canvas, "retouch 99999999999"), "retouch 99999999999");
    // A file of an earlier version may have a name twice: what lies on top goes first.
    canvas.writable_dried()[0].name = "retouch 4";
    lift_off(canvas, "retouch 4");
    EXPECT_EQ(canvas.dried().size(), 2u);
    EXPECT_EQ(canvas.dried()[0].name, "retouch 4");
}

TEST(Canvas, DriesARegionOnly) {
    Canvas canvas = painted_once();
    const float mm = canvas.wet().thickness_mm(64, 48);
    dry(canvas, "left", PolygonPart{{{-16, 12}, {-1, 12}, {-1, -12}, {-16, -12}}});  // 60 columns
    EXPECT_EQ(canvas.wet().thickness_mm(59, 48), 0);
    EXPECT_EQ(canvas.wet().thickness_mm(64, 48), mm);
    EXPECT_GT(canvas.dried()[0].paint.thickness_mm(59, 48), 0);
    EXPECT_EQ(canvas.dried()[0].paint.thickness_mm(60, 48), 0);
}

TEST(Canvas, DriedLayersAreReliefAndCanBeLiftedOff) {
    Canvas canvas = painted_once();
    dry(canvas, "first");
    float height = 0;
    canvas.relief_mm({64, 48, 65, 49}, &height, 1);
    EXPECT_GT(height, 0.02f);
    EXPECT_THAT(error_of([&] { lift_off(canvas, "second"); }),
                testing::AllOf(HasSubstr("second"), HasSubstr("first")));
    lift_off(canvas, "first");
    height = 0;
    canvas.relief_mm({64, 48, 65, 49}, &height, 1);
    EXPECT_EQ(height, 0);
}

TEST(Canvas, TellsWhatChangedOfWhichTile) {
    Canvas canvas = flat_canvas(256, 128);
    const auto white = add_paint(canvas, "Titanium White");
    Brush brush(even_brush(2), kTestPixel, 1);
    brush.load({{white, 1}}, 1);
    stroke(canvas, brush, {-28, 10}, {-24, 10});  // pixels 15 to 31 of row 23
    const auto changed = canvas.take_dirty();
    ASSERT_EQ(changed.size(), 1u);  // of the first tile, what is around the stroke
    const Region& part = changed[0];
    EXPECT_TRUE(part.x0 <= 13 && part.x1 > 32 && part.y0 <= 22 && part.y1 > 24);
    EXPECT_TRUE(part.x0 > 0 && part.x1 < 48 && part.y0 > 10 && part.y1 < 36);
    EXPECT_TRUE(canvas.take_dirty().empty());
    EXPECT_LT(canvas.bytes(), 100000u);  // one tile of one ingredient
}

TEST(Canvas, VolumesByNameCountMediumByItselfAndTellPaintsOfOneNameApart) {
    const Pigment blue = artist_acrylics().at("Ultramarine Blue");
    Pigment matt = finished(blue, {.roughness = 0.5}), other = artist_acrylics().at("Titanium White");
    other.name = blue.name;
    const std::vector<Pigment> paints = {blue, finished(blue, {.medium = 0.75}), matt, other,
                                         artist_acrylics().at("Bone Black")};
    const auto volumes = volumes_by_name(paints, {1, 8, 3, 5, 0});
    ASSERT_EQ(volumes.size(), 3u);  // nothing of black
    EXPECT_NEAR(volumes.at("Ultramarine Blue"), 1 + 2 + 3, 1e-5);
    EXPECT_NEAR(volumes.at("clear medium"), 6, 1e-5);
    EXPECT_EQ(volumes.at("Ultramarine Blue (2)"), 5);
}

TEST(Canvas, LayersAreNotCalledWetOrDry) {
    Canvas canvas = flat_canvas();
    const auto white = add_paint(canvas, "Titanium White");
    Brush brush(even_brush(), kTestPixel, 1);
    brush.load({{white, 1}}, 1);
    stroke(canvas, brush, {-8, 0}, {8, 0});
    EXPECT_EQ(dry(canvas, "wet", {}, 0.5), "wet 2");
    EXPECT_EQ(dry(canvas, "dry"), "dry 2");
}

// Relief goes, colour stays: a film of the paint that was there.
TEST(Canvas, AHeightEraserLeavesAFilmOfTheSamePaints) {
    Canvas canvas = flat_canvas(160, 60);
    const auto red = add_paint(canvas, "Pyrrole Red"), white = add_paint(canvas, "Titanium White");
    BrushSettings flat = brush_presets().at("flat");
    flat.size_mm = 12;
    Brush brush(flat, kTestPixel, 1);
    brush.load({{red, 1}, {white, 3}}, 2);
    stroke(canvas, brush, {-12, 0}, {12, 0});
    const float before = canvas.wet().thickness_mm(80, 30);
    ASSERT_GT(before, 0.08f);
    BrushSettings settings = brush_presets().at("height eraser");
    settings.size_mm = 14;
    Brush eraser(settings, kTestPixel, 2);
    for (int i = 0; i < 2; ++i) stroke(canvas, eraser, {-14, 0}, {14, 0});
    for (int x = 60; x <= 100; x += 5) {
        EXPECT_NEAR(canvas.wet().thickness_mm(x, 30), settings.film_mm, 0.25 * settings.film_mm) << x;
        const PaintTile& tile = *canvas.wet().tile({x / PaintTile::kSize, 0});
        const std::size_t i = static_cast<std::size_t>(30 * PaintTile::kSize + x % PaintTile::kSize);
        EXPECT_NEAR(tile.plane(white)[i] / tile.plane(red)[i], 3, 0.01) << x;
    }
}

TEST(Canvas, WhatAnEraserLeavesIsNoLayer) {
    Canvas canvas = flat_canvas();
    const auto white = add_paint(canvas, "Titanium White");
    PaintTile& tile = canvas.writable_wet().writable({0, 0});
    tile.writable_plane(white)[100] = 1e-9f;
    tile.thickness_mm[100] = 1e-9f;
    EXPECT_EQ(dry(canvas, "ghost"), "");
    // Nor is a part of a tile where there is none.
    tile.writable_plane(white)[20 * PaintTile::kSize] = 0.1f;
    tile.thickness_mm[20 * PaintTile::kSize] = 0.1f;
    EXPECT_EQ(dry(canvas, "ghost", CirclePart{{0, 0}, 1}), "");
    EXPECT_TRUE(canvas.dried().empty());
    EXPECT_EQ(dry(canvas, "all"), "all");
}

}  // namespace
}  // namespace tangi
