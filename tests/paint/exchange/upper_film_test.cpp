// upper_film_test.cpp: paint that is laid on other wet paint lies on it, until bristles stir both.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "paint/canvas/appearance.h"
#include "paint/canvas/layer_pictures.h"
#include "paint/files/canvas_file.h"
#include "paint/optics/kubelka_munk.h"
#include "paint/session/mixing_board.h"
#include "paint/stroke/paint_window.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Thick wet yellow all over the middle, and on it a stroke of white.
struct WhiteOnYellow {
    Canvas canvas = flat_canvas(200, 120);
    IngredientId yellow = add_paint(canvas, "Hansa Yellow Opaque"),
                 white = add_paint(canvas, "Titanium White");
    std::vector<double> brought = {0, 0};  // [mm^3]
    std::vector<double> left = {0, 0};     // on brushes

    explicit WhiteOnYellow(double pressure, int seed = 3) {
        for (int k = -2; k <= 2; ++k) paint(yellow, 8, {-20, 4.0 * k}, {20, 4.0 * k}, 0.6, 10 * seed + k);
        paint(white, 8, {-14, 0}, {14, 0}, pressure, seed);
    }
    void paint(IngredientId id, double size_mm, PathPoint from, PathPoint to, double pressure, int seed) {
        Brush brush(flat_of(size_mm), kTestPixel, static_cast<std::uint64_t>(seed));
        brush.load({{id, 1}}, 1.5);
        count(brush, brought);
        stroke(canvas, brush, from, to, pressure);
        count(brush, left);
    }
    static void count(const Brush& brush, std::vector<double>& sums) {
        const auto volumes = brush.volumes_mm3(2);
        for (std::size_t i = 0; i < 2; ++i) sums[i] += volumes[i];
    }
    // Of the middle of the white stroke, [1] of 0..1; yellow has 0.02 of blue, white 0.7.
    float blue() const {
        const Surface seen = appearance(canvas);
        float sum = 0;
        for (int y = 55; y < 65; ++y)
            for (int x = 90; x < 110; ++x) sum += seen.diffuse(x, y).b / 200;
        return sum;
    }
};

// The same volumes, mixed through.
Canvas mixed(const Canvas& canvas) {
    Canvas result = canvas;
    for (const TileIndex at : canvas.wet().painted()) {
        auto tile = std::make_shared<PaintTile>();
        for (const IngredientId id : canvas.wet().tile(at)->ingredients) {
            const auto from = canvas.wet().tile(at)->plane(id);
            const auto to = tile->writable_plane(paint_of(id));
            for (std::size_t i = 0; i < from.size(); ++i) to[i] += from[i];
        }
        result.writable_wet().set_tile(at, tile);
    }
    return result;
}

TEST(UpperFilm, OfWhiteOnWetYellowIsWhiteUnderALightHand) {
    constexpr int kSeeds = 12;  // bristles differ
    float seen = 0, pressed = 0, through = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        WhiteOnYellow light(0.2, seed);
        seen += light.blue() / kSeeds;
        pressed += WhiteOnYellow(0.9, seed).blue() / kSeeds;
        light.canvas = mixed(light.canvas);
        through += light.blue() / kSeeds;
    }
    EXPECT_GT(seen, 0.45f);
    EXPECT_GT(seen, 2 * through) << "than of the same paint, mixed";
    EXPECT_LT(pressed, 0.8f * seen) << "a firm one stirs";
    EXPECT_GT(pressed, 0.05f);
}

TEST(UpperFilm, KeepsEachPaintsVolume) {
    for (const double pressure : {0.1, 0.5, 1.0}) {
        const WhiteOnYellow paints(pressure);
        const auto volumes = paints.canvas.volumes_mm3();
        for (std::size_t i = 0; i < 2; ++i)
            EXPECT_NEAR((volumes[i] + paints.left[i]) / paints.brought[i], 1, 1e-5) << pressure;
        for (const TileIndex at : paints.canvas.wet().painted())
            for (const float mm : paints.canvas.wet().tile(at)->thickness_mm) ASSERT_GE(mm, -1e-6f);
    }
}

TEST(UpperFilm, IsWhereOtherPaintIsOnly) {
    Canvas canvas = flat_canvas(200, 120);
    const auto red = add_paint(canvas, "Pyrrole Red");
    for (const double y : {-4.0, 0.0, 4.0}) {
        Brush brush(flat_of(8), kTestPixel, 5);
        brush.load({{red, 1}}, 1.5);
        stroke(canvas, brush, {-20, y}, {20, y});
    }
    EXPECT_FALSE(has_upper(canvas.wet()));
    EXPECT_TRUE(has_upper(WhiteOnYellow(0.4).canvas.wet()));
}

TEST(UpperFilm, IsStirredInByBristlesThatGoOverIt) {
    WhiteOnYellow paints(0.2);
    float before = paints.blue();
    const float first = before;
    for (int k = 0; k < 4; ++k) {
        Brush brush(brush_presets().at("smudge"), kTestPixel, 7);
        stroke(paints.canvas, brush, {-14, 0}, {14, 0}, 0.6);
        const float now = paints.blue();
        EXPECT_LE(now, 1.02f * before + 0.001f) << k;
        before = now;
    }
    EXPECT_LT(before, 0.6f * first);
}

TEST(UpperFilm, CountsInRecipesAndMapsOfAPaint) {
    const WhiteOnYellow paints(0.3);
    const Recipe recipe = recipe_at(paints.canvas, 100, 60, 3);
    ASSERT_EQ(recipe.portions.size(), 2u);
    EXPECT_NEAR(recipe.portions[0].part + recipe.portions[1].part, 1, 1e-6);
    EXPECT_GT(recipe.portions[paints.white].part, 0.05);
    const Image<float> white = thickness_mm_of(paints.canvas.wet(), paints.white);
    EXPECT_FLOAT_EQ(white(100, 60), paints.canvas.wet().thickness_mm(100, 60, paints.white));
    double sum = 0;
    for (const float mm : white.pixels()) sum += mm * kTestPixel * kTestPixel;
    EXPECT_NEAR(sum, paints.canvas.volumes_mm3()[paints.white], 1e-3 * sum);
}

TEST(UpperFilm, RecipesLookLikeTheSpot) {
    const WhiteOnYellow paints(0.2);
    const Surface shown = appearance(paints.canvas);
    const Lab seen = lab_from_linear(glm::dvec3(shown.diffuse(100, 60)));
    const auto look_of = [&](const std::vector<float>& volumes) {
        const Medium medium = mix(paints.canvas.ingredients(), volumes);
        return delta_e_2000(lab_from_linear(glm::dvec3(to_linear_rgb(opaque_look(medium)))), seen);
    };
    const std::size_t count = paints.canvas.ingredients().size();
    std::vector<float> picked(count), all(count);
    for (const Portion& portion : recipe_at(paints.canvas, 100, 60, 0.5).portions)
        picked[portion.ingredient] = static_cast<float>(portion.part);
    for (std::size_t id = 0; id < count; ++id)
        all[id] = paints.canvas.wet().thickness_mm(100, 60, static_cast<IngredientId>(id));
    // The nearest mixture of white and yellow is 3.6 off: none is quite like white that yellow shows through.
    std::printf("dE2000 of the recipe %.1f, of all paint %.1f\n", look_of(picked), look_of(all));
    EXPECT_LT(look_of(picked), 5);
    EXPECT_GT(look_of(all), 2 * look_of(picked));
}

TEST(UpperFilm, RecipesBearWhatRoundingLeaves) {
    WhiteOnYellow paints(0.2);
    const auto blue = add_paint(paints.canvas, "Phthalo Blue (Green Shade)");
    PaintTile& tile = paints.canvas.writable_wet().writable({100 / kTileSize, 60 / kTileSize});
    const auto pixel = static_cast<std::size_t>((60 % kTileSize) * kTileSize + 100 % kTileSize);
    tile.writable_plane(upper_of(blue))[pixel] = -1e-9f;
    const Recipe recipe = recipe_at(paints.canvas, 100, 60, 0.5);
    EXPECT_EQ(recipe.portions.size(), 2u);
}

TEST(UpperFilm, DriesAsItLies) {
    WhiteOnYellow paints(0.3);
    const Surface wet = appearance(paints.canvas);
    dry(paints.canvas, "alla prima");
    EXPECT_TRUE(paints.canvas.wet().empty());
    EXPECT_TRUE(has_upper(paints.canvas.dried()[0].paint));
    const Surface dried = appearance(paints.canvas);
    EXPECT_TRUE(std::ranges::equal(wet.diffuse.pixels(), dried.diffuse.pixels()));
    EXPECT_TRUE(std::ranges::equal(wet.specular.pixels(), dried.specular.pixels()));
}

TEST(UpperFilm, IsInTheFile) {
    const TestDir dir;
    const WhiteOnYellow paints(0.3);
    write_canvas(dir / "a.exr", paints.canvas);
    const Canvas read = read_canvas(dir / "a.exr");
    EXPECT_TRUE(identical(read.wet(), paints.canvas.wet()));
    EXPECT_TRUE(has_upper(read.wet()));
}

// A white brush, and one without paint, that a blue stripe has soiled goes on over white paint: nothing shows
// where tiles end.
TEST(UpperFilm, HasNoSeamsAtTiles) {
    for (const double load : {0.6, 0.0}) {
        Canvas canvas = flat_canvas(400, 60);
        const auto blue = add_paint(canvas, "Ultramarine Blue"), white = add_paint(canvas, "Titanium White");
        Brush ground(flat_of(12), kTestPixel, 2), stripe(flat_of(4), kTestPixel, 3),
            tool(flat_of(8), kTestPixel, 4);
        ground.load({{white, 1}}, 2);
        stroke(canvas, ground, {-49, 0}, {45, 0});
        stripe.load({{blue, 1}}, 1.5);
        stroke(canvas, stripe, {-45, -5}, {-45, 5});  // in the middle of a tile
        if (load > 0) tool.load({{white, 1}}, load);
        stroke(canvas, tool, {-48, 0}, {44, 0}, 0.6);
        const Surface seen = appearance(canvas);
        const auto column = [&](int x) {
            double sum = 0;
            for (int row = 24; row < 36; ++row) sum += seen.diffuse(x, row).r / 12;
            return sum;
        };
        // The step at tiles' borders against those around them.
        for (int x = 64; x < 360; x += 64) {
            double around = 0;
            for (int k = -6; k <= 6; ++k)
                if (k != 0) around = std::max(around, std::abs(column(x + k) - column(x + k - 1)));
            EXPECT_LT(std::abs(column(x) - column(x - 1)), 2 * around + 0.01) << x << ", load " << load;
        }
    }
}

// What gives nothing leaves nothing; blades carry little on.
TEST(UpperFilm, OfToolsThatOnlyTakeHasNoneOfWhatTheyTook) {
    Canvas canvas = flat_canvas(240, 80);
    const auto yellow = add_paint(canvas, "Hansa Yellow Opaque"), red = add_paint(canvas, "Pyrrole Red"),
               white = add_paint(canvas, "Titanium White");
    const auto lay = [&](IngredientId id, PathPoint from, PathPoint to, double size_mm) {
        Brush brush(flat_of(size_mm), kTestPixel, 3);
        brush.load({{id, 1}}, 1.5);
        stroke(canvas, brush, from, to, 0.4);
    };
    lay(yellow, {-25, 0}, {25, 0}, 12);
    lay(red, {-22, -6}, {-22, 6}, 6);
    lay(white, {-25, 0}, {25, 0}, 4);
    std::vector<float> before;
    for (int x = 180; x < 210; ++x) before.push_back(canvas.wet().thickness_mm(x, 40, red));
    Brush eraser(brush_presets().at("height eraser"), kTestPixel, 5);
    stroke(canvas, eraser, {-26, 0}, {26, 0}, 0.6);
    for (int x = 180; x < 210; ++x)
        EXPECT_LE(canvas.wet().thickness_mm(x, 40, red), before[static_cast<std::size_t>(x - 180)] + 1e-5f)
            << x;
}

TEST(UpperFilm, StaysAboveWhereAShareDries) {
    WhiteOnYellow paints(0.3);
    const Surface wet = appearance(paints.canvas);
    const auto volumes = paints.canvas.volumes_mm3();
    dry(paints.canvas, "below", {}, 0.4);
    const Surface half = appearance(paints.canvas);
    for (std::size_t i = 0; i < wet.diffuse.size(); ++i)
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(wet.diffuse.pixels()[i][c], half.diffuse.pixels()[i][c], 2e-3f) << i;
    for (std::size_t i = 0; i < volumes.size(); ++i)
        EXPECT_NEAR(paints.canvas.volumes_mm3()[i], volumes[i], 1e-5 * volumes[i]);
    EXPECT_NEAR(volumes_mm3(paints.canvas.wet(), 2, kTestPixel)[0] +
                    volumes_mm3(paints.canvas.wet(), 2, kTestPixel)[1],
                0.6 * (volumes[0] + volumes[1]), 1e-3 * volumes[0]);
}

TEST(UpperFilm, IsBelowAPile) {
    WhiteOnYellow paints(0.3);
    const auto blue = add_paint(paints.canvas, "Ultramarine Blue");
    const double before = paints.canvas.volumes_mm3()[paints.white];
    lay_pile(paints.canvas, {{blue, 1}}, {0, 0}, 8, 1);
    const Rgb seen = appearance(paints.canvas).diffuse(100, 60);
    EXPECT_LT(seen.r, 0.12f);
    EXPECT_LT(seen.g, 0.12f);
    EXPECT_NEAR(paints.canvas.volumes_mm3()[paints.white], before, 1e-5 * before);
}

// A sitting that goes on with a file has the same bits: planes of the upper film that are empty by now do not
// tell.
TEST(UpperFilm, ThatHasDriedLeavesNoTrace) {
    const TestDir dir;
    WhiteOnYellow paints(0.3);
    dry(paints.canvas, "a");
    paints.paint(paints.yellow, 8, {-20, 0}, {20, 0}, 0.5, 5);
    write_canvas(dir / "a.exr", paints.canvas);
    Canvas read = read_canvas(dir / "a.exr");
    for (Canvas* canvas : {&paints.canvas, &read}) {
        Brush brush(flat_of(8), kTestPixel, 8);
        brush.load({{paints.yellow, 1}}, 1.5);
        stroke(*canvas, brush, {-18, 2}, {18, 2}, 0.5);
    }
    EXPECT_TRUE(identical(read.wet(), paints.canvas.wet()));
    EXPECT_FALSE(has_upper(read.wet()));
}

// Drying looks at all paints, not at the first one only.
TEST(UpperFilm, OrAnyPaintDriesWhateverElseThereIs) {
    Canvas canvas = flat_canvas();
    const auto black = add_paint(canvas, "Bone Black"), red = add_paint(canvas, "Pyrrole Red");
    canvas.writable_wet().writable({0, 0}).writable_plane(black)[5] = 0;
    canvas.writable_wet().writable({0, 0}).writable_plane(red)[5] = 0.1f;
    EXPECT_EQ(dry(canvas, "a"), "a");
    EXPECT_TRUE(canvas.wet().empty());
}

// A stroke from bare canvas over two tiles with other paint and out again, looked at seldom and often: how
// steps are grouped to windows does not show.
TEST(UpperFilm, DoesNotDependOnHowStepsAreGrouped) {
    const auto painted = [](double every_s) {
        Canvas canvas = flat_canvas(400, 100);
        const auto yellow = add_paint(canvas, "Hansa Yellow Opaque"),
                   white = add_paint(canvas, "Titanium White");
        Brush first(flat_of(8), kTestPixel, 4), second(flat_of(6), kTestPixel, 5);
        first.load({{yellow, 1}}, 1.5);
        stroke(canvas, first, {-6, 10}, {-6, -10});
        stroke(canvas, first, {14, 10}, {14, -10});
        second.load({{white, 1}}, 1.5);
        Stroke s(canvas, second, {}, 9);
        if (every_s > 0) s.watch(every_s, [&](double age_s) { return age_s + every_s; });
        // Few points: many steps at once.
        for (int i = 0; i <= 4; ++i)
            s.add({.time_s = 0.5 * i, .x_mm = -40 + 20.0 * i, .y_mm = 0.6 * i, .pressure = 0.5});
        s.finish();
        return canvas;
    };
    const Canvas together = painted(0);
    EXPECT_TRUE(has_upper(together.wet()));
    for (const double every_s : {0.003, 0.05, 0.7})
        EXPECT_TRUE(identical(painted(every_s).wet(), together.wet())) << every_s;
}

}  // namespace
}  // namespace tangi
