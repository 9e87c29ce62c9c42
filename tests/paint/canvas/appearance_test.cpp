// appearance_test.cpp: painted canvases as surfaces: colour, slopes, gloss, and what stays untouched.
#include "paint/canvas/appearance.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "paint/canvas/appearance_part.h"
#include "paint/canvas/appearance_rows.h"
#include "paint/optics/kubelka_munk.h"
#include "surface/base/error.h"
#include "surface/reflectance/anisotropy.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A canvas with a film of even thickness on its left half.
Canvas half_covered(const std::string& paint, float mm) {
    Canvas canvas = flat_canvas(128, 64);
    const auto id = add_paint(canvas, paint);
    PaintTile tile;
    tile.ingredients = {id};
    tile.thickness_mm.assign(PaintTile::kPixels, mm);
    canvas.writable_wet().set_tile({0, 0}, std::make_shared<PaintTile>(tile));
    return canvas;
}

TEST(Appearance, IsTheDrySurfaceWhereThereIsNoPaint) {
    const Canvas empty = flat_canvas();
    const Surface same = appearance(empty);
    EXPECT_TRUE(images_identical(same.diffuse, empty.dry().diffuse));
    EXPECT_TRUE(images_identical(same.normal, empty.dry().normal));
    const Canvas half = half_covered("Bone Black", 0.1f);
    const Surface s = appearance(half);
    EXPECT_EQ(s.diffuse(100, 30), half.dry().diffuse(100, 30));
    EXPECT_EQ(s.height_mm(100, 30), 0);
    EXPECT_NE(s.diffuse(30, 30), half.dry().diffuse(30, 30));
}

// Bare canvas and the thinnest film on it are seen under the same light; grey is grey under each.
TEST(Appearance, IsSeenUnderALampWithAndWithoutPaint) {
    for (int i = 0; i < kIlluminants; ++i) {
        const auto light = static_cast<Illuminant>(i);
        Canvas canvas = half_covered("Bone Black", 1e-5f);
        Surface dry = canvas.dry();
        std::ranges::fill(dry.diffuse.pixels(), Rgb(0.6f, 0.3f, 0.1f));
        dry.diffuse(100, 30) = Rgb(0.4f);
        dry.diffuse(101, 30) = Rgb(2.0f);
        Canvas brown(std::make_shared<Surface>(dry));
        brown.add(canvas.ingredients()[0]);
        brown.writable_wet() = canvas.wet();
        const Surface s = appearance(brown, {.illuminant = light});
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(s.diffuse(30, 30)[c], s.diffuse(100, 31)[c], 0.002) << name_of(light);
            EXPECT_NEAR(s.diffuse(100, 30)[c], 0.4, 1e-4) << name_of(light);
            EXPECT_NEAR(s.diffuse(101, 30)[c], 2, 1e-3) << name_of(light);
        }
        const bool daylight = light == Illuminant::d65;
        EXPECT_EQ(s.diffuse(100, 31) == Rgb(0.6f, 0.3f, 0.1f), daylight) << name_of(light);
    }
}

// For comparison: one constant and three channels, opaque where it covers. It mixes no green.
TEST(Appearance, ByTheModelOfTheThesisIsOpaqueAndItsMixturesAreItsOwn) {
    EXPECT_EQ(paint_model_named("thesis"), PaintModel::thesis);
    EXPECT_EQ(paint_model_named(name_of(PaintModel::spectral)), PaintModel::spectral);
    EXPECT_FALSE(paint_model_named("rgb"));
    const AppearanceOptions thesis{.model = PaintModel::thesis};
    const Canvas thin = half_covered("Titanium White", 0.05f), thick = half_covered("Titanium White", 1.0f);
    const Rgb once = appearance(thin, thesis).diffuse(30, 30),
              more = appearance(thick, thesis).diffuse(30, 30);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(once[c], more[c], 0.01);
    EXPECT_EQ(appearance(thin, thesis).diffuse(100, 30), thin.dry().diffuse(100, 30));
    const Rgb film = appearance(thin).diffuse(30, 30), hiding = appearance(thick).diffuse(30, 30);
    EXPECT_GT(glm::length(hiding - film), 0.05f);
    // Of one paint that hides, both models have the colour.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(more[c], hiding[c], 0.02);
}

TEST(Appearance, OfAPartIsThatOfTheWhole) {
    Canvas canvas = half_covered("Bone Black", 0.02f);  // its edge is a slope
    canvas.writable_dried().push_back({"varnish", canvas.wet(), true});
    const Surface whole = appearance(canvas, {.illuminant = Illuminant::a});
    for (const Region& part : {Region{0, 0, 128, 64}, Region{60, 3, 71, 40}, Region{65, 0, 66, 1},
                               Region{64, 10, 128, 20}, Region{10, 10, 30, 20}}) {
        const Surface s = appearance_in(canvas, part, {.illuminant = Illuminant::a});
        ASSERT_EQ(s.height_mm.region(), (Region{0, 0, part.width(), part.height()}));
        for (int y = 0; y < part.height(); ++y)
            for (int x = 0; x < part.width(); ++x) {
                const int u = x + part.x0, v = y + part.y0;
                ASSERT_EQ(s.diffuse(x, y), whole.diffuse(u, v));
                ASSERT_EQ(s.normal(x, y), whole.normal(u, v)) << u << ", " << v;
                ASSERT_EQ(s.height_mm(x, y), whole.height_mm(u, v));
                ASSERT_EQ(s.roughness(x, y), whole.roughness(u, v));
                ASSERT_EQ(s.specular(x, y), whole.specular(u, v));
                ASSERT_EQ(s.confidence(x, y), whole.confidence(u, v));
            }
    }
    EXPECT_THROW(appearance_in(canvas, {100, 0, 129, 10}), ContractError);
}

TEST(Appearance, PaintHidesTheColourOfTheLobeBelow) {
    auto dry = flat_surface(128, 64);
    const Rgb gold(1, 0.77f, 0.34f);
    dry->specular_colour = Image<Rgb>(128, 64, gold);
    std::fill(dry->specular.pixels().begin(), dry->specular.pixels().end(), 0.3f);
    Canvas canvas(dry);
    const auto id = add_paint(canvas, "Titanium White");
    float before = gold.b;
    for (const float mm : {0.002f, 0.01f, 0.2f}) {
        PaintTile tile;
        tile.ingredients = {id};
        tile.thickness_mm.assign(PaintTile::kPixels, mm);
        canvas.writable_wet().set_tile({0, 0}, std::make_shared<PaintTile>(tile));
        const Surface s = appearance(canvas, {.covering_mm = 0.01});
        EXPECT_EQ(s.specular_colour(100, 30), gold) << "bare";
        const Rgb colour = s.specular_colour(30, 30);
        EXPECT_GT(colour.b, before);
        before = colour.b;
        // Light of both skins adds: what is left of the gold's, and the paint's.
        const float bare = std::exp(-mm / 0.01f);
        const Rgb both = 0.3f * bare * gold + (s.specular(30, 30) - 0.3f * bare) * Rgb(1);
        EXPECT_LT(glm::length(s.specular(30, 30) * colour - both), 1e-5f);
    }
    EXPECT_GT(before, 0.999f);
}

TEST(Appearance, PaintIsNotDrawnOutAsWhatIsBelow) {
    auto dry = flat_surface(128, 64);
    const Stretch brushed(0.5f, -0.3f);
    std::fill(dry->specular.pixels().begin(), dry->specular.pixels().end(), 0.3f);
    dry->lobe_axes = Image<LobeAxes>(128, 64, axes_of(brushed, dry->roughness(0, 0)));
    Canvas canvas(dry);
    const auto id = add_paint(canvas, "Titanium White");
    float before = glm::length(brushed);
    for (const float mm : {0.002f, 0.01f, 0.2f}) {
        PaintTile tile;
        tile.ingredients = {id};
        tile.thickness_mm.assign(PaintTile::kPixels, mm);
        canvas.writable_wet().set_tile({0, 0}, std::make_shared<PaintTile>(tile));
        const Surface s = appearance(canvas, {.covering_mm = 0.01});
        EXPECT_EQ(s.lobe_axes(100, 30), dry->lobe_axes(100, 30)) << "bare";
        const Stretch left = stretch_of(s.lobe_axes(30, 30), s.roughness(30, 30));
        EXPECT_LT(glm::length(left), before);
        before = glm::length(left);
        EXPECT_NEAR(left.x * brushed.y, left.y * brushed.x, 1e-5) << "in its direction";
    }
    EXPECT_LT(before, 0.001f);
}

TEST(Appearance, BarePartFallsWithThickness) {
    EXPECT_TRUE(bare_part(flat_canvas()).empty());
    const Canvas half = half_covered("Bone Black", 0.02f);
    const Image<float> bare = bare_part(half, {.covering_mm = 0.01});
    EXPECT_EQ(bare(100, 30), 1);
    EXPECT_NEAR(bare(30, 30), std::exp(-2.0f), 1e-6);
}

TEST(Appearance, HidesWithThicknessAsKubelkaAndMunkSay) {
    const Pigment& white = artist_acrylics().at("Titanium White");
    for (const float mm : {0.01f, 0.03f, 0.1f, 1.0f}) {
        const Canvas canvas = half_covered("Titanium White", mm);
        const Rgb expected = to_linear_rgb(
            film_look({white.k, white.s}, mm, reflectance_of_rgb(canvas.dry().diffuse(10, 10))));
        const Rgb found = appearance(canvas).diffuse(10, 10);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2e-4) << mm;
    }
}

TEST(Appearance, SlopesAndHeightsAdd) {
    auto surface = flat_surface(128, 64);
    for (Vec3& n : surface->normal.pixels()) n = normal_of({0.3f, -0.1f});  // finer than the height knows
    Canvas canvas(surface);
    const auto id = add_paint(canvas, "Titanium White");
    PaintTile tile;
    tile.ingredients = {id};
    tile.thickness_mm.resize(PaintTile::kPixels);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            tile.thickness_mm[static_cast<std::size_t>(y * 64 + x)] =
                0.1f + 0.02f * static_cast<float>(x) + 0.01f * static_cast<float>(y);
    canvas.writable_wet().set_tile({0, 0}, std::make_shared<PaintTile>(tile));
    const Surface s = appearance(canvas);
    const Slope slope = slope_of(s.normal(20, 20));
    EXPECT_NEAR(slope.x, 0.3 + 0.02 / kTestPixel, 1e-4);
    EXPECT_NEAR(slope.y, -0.1 - 0.01 / kTestPixel, 1e-4);  // rows run downwards
    EXPECT_NEAR(s.height_mm(20, 20), 0.1f + 0.4f + 0.2f, 1e-5);
    EXPECT_LT(slope_of(s.normal(64, 20)).x, 0.3f - 1);  // the paint's edge, seen from the tile beside
}

TEST(Appearance, TheBorderIsNoRougherThanTheInside) {
    // Bristle marks across the picture's border, and a plane, whose slope is known there too.
    Canvas canvas = flat_canvas(65, 66);
    const auto id = add_paint(canvas, "Titanium White");
    PaintLayer& wet = canvas.writable_wet();
    for (int y = 0; y < 66; ++y)
        for (int x = 0; x < 65; ++x)
            wet.writable({x / 64, y / 64})
                .writable_plane(id)[static_cast<std::size_t>(y % 64 * 64 + x % 64)] =
                0.2f + 0.01f * static_cast<float>(x) + 0.1f * static_cast<float>((x + y) % 2);
    const Surface s = appearance(canvas);
    for (int y = 0; y < 66; ++y)
        for (int x = 0; x < 65; ++x) {
            ASSERT_NEAR(slope_of(s.normal(x, y)).x, 0.01 / kTestPixel, 1e-3) << x << ' ' << y;
            ASSERT_NEAR(slope_of(s.normal(x, y)).y, 0, 1e-3) << x << ' ' << y;
        }
}

TEST(Appearance, GlossIsThePaintsWhereItCovers) {
    const Canvas thick = half_covered("Titanium White", 0.2f), thin = half_covered("Titanium White", 0.0005f);
    const Pigment& white = artist_acrylics().at("Titanium White");
    EXPECT_NEAR(appearance(thick).specular(9, 9), white.specular, 1e-5);
    EXPECT_NEAR(appearance(thick).roughness(9, 9), white.roughness, 1e-5);
    EXPECT_NEAR(appearance(thin).roughness(9, 9), thin.dry().roughness(9, 9), 0.02);
}

TEST(Appearance, LayersLieOnEachOther) {
    Canvas canvas = half_covered("Pyrrole Red", 0.05f);
    dry(canvas, "under");
    const Rgb red = appearance(canvas).diffuse(9, 9);
    const auto id = add_paint(canvas, "Titanium White");
    PaintTile tile;
    tile.ingredients = {id};
    tile.thickness_mm.assign(PaintTile::kPixels, 0.005f);
    canvas.writable_wet().set_tile({0, 0}, std::make_shared<PaintTile>(tile));
    const Rgb veiled = appearance(canvas).diffuse(9, 9);
    EXPECT_GT(veiled.b, red.b + 0.02f);
    EXPECT_GT(veiled.r, veiled.b + 0.1f);  // the red shines through
    EXPECT_NEAR(appearance(canvas).height_mm(9, 9), 0.055f, 1e-6);
}

TEST(Appearance, UpdatingChangedTilesIsAsGoodAsAll) {
    Canvas canvas = flat_canvas(200, 150);
    const auto blue = add_paint(canvas, "Ultramarine Blue");
    Surface kept = appearance(canvas);
    for (int i = 0; i < 3; ++i) {
        Brush brush(brush_presets().at("round"), kTestPixel, 1);
        brush.load({{blue, 1}}, 1);
        stroke(canvas, brush, {-15, i * 5.0 - 5}, {10, 5});
        const auto dirty = canvas.take_dirty();
        update_appearance(canvas, dirty, kept);
    }
    const Surface whole = appearance(canvas);
    EXPECT_TRUE(images_identical(kept.diffuse, whole.diffuse));
    EXPECT_TRUE(images_identical(kept.normal, whole.normal));
    EXPECT_TRUE(images_identical(kept.height_mm, whole.height_mm));
}

// Many pixels at once are as each by itself, wherever it lies, and as the formulas say.
TEST(Appearance, RowsAreWhatOnePixelIs) {
    Random random(3);
    constexpr std::size_t n = 150;
    const auto some = [&](double low, double high) {
        std::vector<float> values(n);
        for (float& v : values) v = random.real(low, high);
        return values;
    };
    std::vector<float> mm = some(0, 0.05), specular_mm = some(0, 0.01), roughness_mm = some(0, 0.02);
    for (std::size_t i = 0; i < n; i += 3) mm[i] = specular_mm[i] = roughness_mm[i] = 0;
    mm[1] = 1e-9f, mm[2] = 900;
    const auto below = std::array{some(0, 1), some(0, 1), some(0, 1)};
    auto laid = below;
    std::vector<float> covered(n);
    lay_sheen_rows(n, {mm.data(), specular_mm.data(), roughness_mm.data()}, 0.01f,
                   {laid[0].data(), laid[1].data(), laid[2].data()});
    covered_rows(n, mm.data(), 0.01f, covered.data());
    for (std::size_t i = 0; i < n; ++i) {
        const double c = -std::expm1(-static_cast<double>(mm[i]) / 0.01f);
        EXPECT_NEAR(covered[i], c, 2e-7 * c) << i;
        if (mm[i] == 0) {
            for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(laid[k][i], below[k][i]) << i;
        } else {
            EXPECT_NEAR(laid[0][i], below[0][i] + c * (specular_mm[i] / mm[i] - below[0][i]),
                        1e-6 * (1 + specular_mm[i] / mm[i]));
            EXPECT_NEAR(laid[2][i], (1 - c) * below[2][i], 1e-6);
        }
        auto one = std::array{below[0][i], below[1][i], below[2][i]};
        lay_sheen_rows(1, {&mm[i], &specular_mm[i], &roughness_mm[i]}, 0.01f, {&one[0], &one[1], &one[2]});
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(one[k], laid[k][i]) << i;
    }
    std::vector<Vec3> dry(n), tilted(n), again(1);
    for (Vec3& normal : dry) normal = normal_of({random.real(-1, 1), random.real(-1, 1)});
    auto right = some(0, 1), left = some(0, 1), above = some(0, 1), under = some(0, 1);
    for (std::size_t i = 0; i < n; i += 4) right[i] = left[i], above[i] = under[i];
    tilt_rows(n, {right.data(), left.data(), above.data(), under.data(), 2, 3}, dry.data(), tilted.data());
    for (std::size_t i = 0; i < n; ++i) {
        if (i % 4 == 0) {
            EXPECT_EQ(tilted[i], dry[i]);
            continue;
        }
        const Slope slope = slope_of(dry[i]);
        const Vec3 expected =
            normal_of({slope.x + 2 * (right[i] - left[i]), slope.y + 3 * (above[i] - under[i])});
        EXPECT_LT(glm::length(tilted[i] - expected), 1e-6) << i;
        tilt_rows(1, {&right[i], &left[i], &above[i], &under[i], 2, 3}, &dry[i], again.data());
        EXPECT_EQ(again[0], tilted[i]) << i;
    }
}

TEST(Appearance, OfWhatIsNotPaintedIsShared) {
    const Canvas empty = flat_canvas();
    EXPECT_EQ(shown(empty), empty.dry_shared());
    EXPECT_NE(shown(empty, {.illuminant = Illuminant::a}), empty.dry_shared());
    const Canvas half = half_covered("Bone Black", 0.1f);
    EXPECT_TRUE(images_identical(shown(half)->diffuse, appearance(half).diffuse));
}

}  // namespace
}  // namespace tangi
