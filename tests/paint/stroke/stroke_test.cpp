// stroke_test.cpp: the laws of strokes: conservation, mixing, streaks, rotation, sameness on all
// threads.
#include "paint/stroke/stroke.h"
#include "paint/stroke/brush_steps.h"

#include <gmock/gmock.h>

#include "paint/substrate/substrate.h"
#include "surface/base/parallel.h"
#include "surface/painting_file/painting_file.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

TEST(Path, GoesThroughItsPointsWithoutLoops) {
    const PathPoint a{0, 0}, b{1, 0}, c{1.2, 0.1}, d{9, 7};
    EXPECT_NEAR(catmull_rom(a, b, c, d, 0).x, b.x, 1e-9);
    EXPECT_NEAR(catmull_rom(a, b, c, d, 1).y, c.y, 1e-9);
    // Centripetal: between close points after a long way, the path does not turn back.
    double before = -1;
    for (int i = 0; i <= 100; ++i) {
        const PathPoint p = catmull_rom(a, b, c, d, i / 100.0);
        const double along = (p.x - b.x) * (c.x - b.x) + (p.y - b.y) * (c.y - b.y);
        EXPECT_GE(along, before - 1e-6);
        before = along;
    }
}

TEST(Path, ReproducesACircleFromFewPoints) {
    const auto on_circle = [](double turn) { return PathPoint{10 * std::cos(turn), 10 * std::sin(turn)}; };
    for (double u = 0; u <= 1; u += 0.1) {
        const PathPoint p = catmull_rom(on_circle(-0.3), on_circle(0), on_circle(0.3), on_circle(0.6), u);
        EXPECT_NEAR(std::hypot(p.x, p.y), 10, 0.01);
    }
}

TEST(Stroke, ConservesEachPaint) {
    Canvas canvas = flat_canvas(200, 120);
    const auto white = add_paint(canvas, "Titanium White"), blue = add_paint(canvas, "Ultramarine Blue");
    for (const char* preset : {"round", "flat", "fan", "knife", "smudge", "rag"}) {
        Brush brush(brush_presets().at(preset), kTestPixel, 5);
        if (brush.settings().load_mm > 0) brush.load({{white, 1}, {blue, 2}}, 1);
        const auto before = on_both(canvas, brush);
        stroke(canvas, brush, {-20, -8}, {20, 9});
        stroke(canvas, brush, {20, -8}, {-30, 9}, 0.9);  // over the border
        const auto after = on_both(canvas, brush);
        for (const auto id : {white, blue}) EXPECT_NEAR(after[id] / before[id], 1, 1e-5) << preset;
    }
}

TEST(Stroke, ACleanBrushStaysCleanOnDryPaint) {
    Canvas canvas = flat_canvas();
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush loaded(even_brush(), kTestPixel, 1);
    loaded.load({{red, 1}}, 1);
    stroke(canvas, loaded, {-10, 0}, {10, 0});
    dry(canvas, "first");
    Brush clean(brush_presets().at("smudge"), kTestPixel, 2);
    stroke(canvas, clean, {-10, 0}, {10, 0});
    EXPECT_EQ(clean.volumes_mm3(1)[0], 0);
    EXPECT_TRUE(canvas.wet().empty());
    EXPECT_GT(canvas.volumes_mm3()[0], 1);
}

TEST(Stroke, PicksUpWetPaint) {
    Canvas canvas = flat_canvas();
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush loaded(even_brush(), kTestPixel, 1), clean(brush_presets().at("smudge"), kTestPixel, 2);
    loaded.load({{red, 1}}, 1);
    stroke(canvas, loaded, {-10, 0}, {10, 0});
    stroke(canvas, clean, {0, -8}, {0, 8});
    EXPECT_GT(clean.volumes_mm3(1)[0], 0);
    float carried = 0;  // to where there was none; not by every bristle
    for (int x = 56; x <= 72; ++x) carried += canvas.wet().thickness_mm(x, 24, red);
    EXPECT_GT(carried, 0.001f);
}

TEST(Stroke, MixingAPaintWithItselfChangesNothing) {
    Canvas one = flat_canvas(), two = flat_canvas();
    const auto red = add_paint(one, "Pyrrole Red");
    add_paint(two, "Pyrrole Red");
    // The second canvas has the same paint under another number: half and half is the whole.
    Pigment again = artist_acrylics().at("Pyrrole Red");
    again.name = "Pyrrole Red, another tube";
    const auto twin = two.add(again);
    for (int pass = 0; pass < 3; ++pass) {
        Brush a(brush_presets().at("round"), kTestPixel, 4), b(brush_presets().at("round"), kTestPixel, 4);
        a.load({{red, 1}}, 1);
        b.load({{red, 1}, {twin, 1}}, 1);
        stroke(one, a, {-10, pass - 1.0}, {10, 0});
        stroke(two, b, {-10, pass - 1.0}, {10, 0});
    }
    EXPECT_TRUE(images_near(thickness_of(two), thickness_of(one), 2e-5));
}

TEST(Stroke, ASecondPassOfTheSameBrushDepositsLess) {
    Canvas canvas = flat_canvas();
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush brush(brush_presets().at("round"), kTestPixel, 4);
    brush.load({{red, 1}}, 1);
    stroke(canvas, brush, {-10, 0}, {10, 0});
    const double first = canvas.volumes_mm3()[0];
    stroke(canvas, brush, {-10, 0}, {10, 0});
    const double second = canvas.volumes_mm3()[0] - first;
    EXPECT_GT(first, 1);
    EXPECT_LT(second, 0.7 * first);
}

// Loaded anew: from a brush with so little that it scrapes over the crests to a full one.
TEST(Stroke, ASecondEqualStrokeDepositsLess) {
    SubstrateOptions piece;
    piece.width_mm = piece.height_mm = 32;
    piece.pixel_mm = kTestPixel;
    const auto linen = std::make_shared<Surface>(make_substrate(SubstrateKind::linen, piece));
    for (const auto& surface : {flat_surface(128, 128), linen})
        for (const char* preset : {"round", "flat", "filbert", "fan", "knife"})
            for (const double load : {0.05, 0.2, 0.5, 1.0}) {
                Canvas canvas(surface);
                const auto red = add_paint(canvas, "Pyrrole Red");
                std::vector<double> laid = {0};
                for (int pass = 0; pass < 2; ++pass) {
                    Brush brush(brush_presets().at(preset), kTestPixel, 4);
                    brush.load({{red, 1}}, load);
                    stroke(canvas, brush, {-10, 0}, {10, 0});
                    laid.push_back(canvas.volumes_mm3()[0]);
                }
                EXPECT_GT(laid[1], 0.1) << preset << ", load " << load;
                EXPECT_LT(laid[2] - laid[1], 0.995 * laid[1])
                    << preset << ", load " << load << (surface == linen ? ", linen" : ", flat");
            }
}

TEST(Stroke, RunsDry) {
    Canvas canvas = flat_canvas(700, 60);
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush brush(brush_presets().at("round"), kTestPixel, 4);
    brush.load({{red, 1}}, 0.3);
    stroke(canvas, brush, {-80, 0}, {80, 0});
    const auto mean = [&](int x0) {
        double sum = 0;
        for (int y = 0; y < 60; ++y)
            for (int x = x0; x < x0 + 60; ++x) sum += canvas.wet().thickness_mm(x, y);
        return sum;
    };
    EXPECT_LT(mean(580), 0.3 * mean(60));
    EXPECT_LT(mean(580), mean(300));
}

TEST(Stroke, IsTheSameOnAnyNumberOfThreadsAndForAnyGroupingOfPoints) {
    const auto painted = [](int threads) {
        set_thread_count(threads);
        Canvas canvas = flat_canvas(300, 220);
        const auto red = add_paint(canvas, "Pyrrole Red"), white = add_paint(canvas, "Titanium White");
        BrushSettings settings = brush_presets().at("round");
        settings.size_mm = 36;  // 144 pixels: large enough for threads
        Brush brush(settings, kTestPixel, 4);
        brush.load({{red, 1}, {white, 1}}, 1);
        stroke(canvas, brush, {-12, -4}, {6, 5});
        set_thread_count(0);
        return canvas.wet();
    };
    const PaintLayer one = painted(1);
    EXPECT_FALSE(one.empty());
    EXPECT_TRUE(identical(one, painted(2)));
    EXPECT_TRUE(identical(one, painted(4)));
}

TEST(Stroke, NeverTouchesTheDrySurface) {
    Canvas canvas = flat_canvas();
    const std::string before = hash_of(canvas.dry());
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush brush(brush_presets().at("knife"), kTestPixel, 4);
    brush.load({{red, 1}}, 1);
    stroke(canvas, brush, {-10, 0}, {10, 0}, 1);
    dry(canvas, "first");
    EXPECT_EQ(hash_of(canvas.dry()), before);
}

TEST(Stroke, AStabiliserSmoothsAShakyHand) {
    const auto roughness = [](double string_mm) {
        Canvas canvas = flat_canvas(240, 80);
        const auto red = add_paint(canvas, "Pyrrole Red");
        Brush brush(even_brush(1.5), kTestPixel, 4);
        brush.load({{red, 1}}, 4);
        StrokeOptions options;
        options.stabiliser_mm = string_mm;
        Stroke s(canvas, brush, options, 1);
        for (int i = 0; i <= 80; ++i) s.add({i * 0.01, i * 0.5 - 20.0, (i % 2 ? 1.0 : -1.0), 0.6, 0, 0, 0});
        s.finish();
        const Image<float> mm = thickness_of(canvas);
        double moment = 0, sum = 0;  // spread of the paint across the stroke
        for (int y = 0; y < 80; ++y)
            for (int x = 60; x < 180; ++x) moment += mm(x, y) * std::pow(y - 39.5, 2), sum += mm(x, y);
        return moment / sum;
    };
    EXPECT_LT(roughness(4), 0.7 * roughness(0));
}

TEST(Stroke, ASinglePointIsADab) {
    Canvas canvas = flat_canvas();
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush brush(even_brush(), kTestPixel, 1);
    brush.load({{red, 1}}, 1);
    stroke(canvas, brush, {0, 0}, {0, 0});
    EXPECT_GT(canvas.wet().thickness_mm(64, 48), 0.01f);
    EXPECT_EQ(canvas.wet().thickness_mm(90, 48), 0);
}

TEST(Stroke, RefusesPointsThatCannotBe) {
    Canvas canvas = flat_canvas();
    add_paint(canvas, "Pyrrole Red");
    Brush brush(even_brush(), kTestPixel, 1);
    Stroke s(canvas, brush, {}, 1);
    s.add({1, 0, 0, 0.5, 0, 0, 0});
    EXPECT_THAT(error_of([&] { s.add({0.5, 1, 0, 0.5, 0, 0, 0}); }), HasSubstr("time = 0.5"));
    EXPECT_THAT(error_of([&] { s.add({2, 1, 0, 1.5, 0, 0, 0}); }), HasSubstr("pressure = 1.5"));
    EXPECT_THAT(error_of([&] { s.add({2, NAN, 0, 0.5, 0, 0, 0}); }), HasSubstr("not finite"));
    EXPECT_THAT(error_of([&] { s.add({2, 1e6, 0, 0.5, 0, 0, 0}); }), HasSubstr("far from the canvas"));
    EXPECT_THAT(error_of([&] { s.add({2, 1, 0, 0.5, 1, 1, 0}); }), HasSubstr("tilt"));
}

// The first contact of a pen, and a stroke that runs out, transfer next to nothing.
TEST(Stroke, AtNoPressureNothingIsTransferredAndAtLittleLittle) {
    const auto laid = [](float pressure) {
        Canvas canvas = flat_canvas();
        const auto red = add_paint(canvas, "Pyrrole Red");
        Brush brush(brush_presets().at("flat"), kTestPixel, 4);
        brush.load({{red, 1}}, 1);
        // Short, so that the brush is never empty.
        stroke(canvas, brush, {-3, 0}, {3, 0}, static_cast<double>(pressure));
        return canvas.volumes_mm3()[0];
    };
    EXPECT_EQ(laid(0), 0);
    const double light = laid(0.15f);
    EXPECT_GT(light, 1);  // [mm^3]
    EXPECT_LT(laid(0.01f), 0.12 * light);
    double before = 0;
    for (const float pressure : {0.01f, 0.03f, 0.08f, 0.15f, 0.3f, 0.6f, 1.0f}) {
        const double now = laid(pressure);
        EXPECT_GT(now, before) << pressure;
        before = now;
    }
    // Nor does a brush that only grazes take what is there.
    Canvas canvas = flat_canvas();
    Brush brush(even_brush(), kTestPixel, 1), grazing(brush_presets().at("knife"), kTestPixel, 2);
    brush.load({{add_paint(canvas, "Pyrrole Red"), 1}}, 1);
    stroke(canvas, brush, {-8, 0}, {8, 0});
    DabMemory memory;
    UpperFilm other(grazing);
    paint_dabs(canvas, grazing, std::vector<Dab>(20, Dab{.x = 64, .y = 48, .pressure = 0}), 1, other, memory);
    EXPECT_EQ(grazing.volumes_mm3(1)[0], 0);
}

// On its way beside the canvas, which may be long and the brush large, it takes no time and changes nothing.
TEST(Stroke, BesideTheCanvasABrushKeepsItsPaintAsItIs) {
    Canvas canvas = flat_canvas();
    Brush brush(even_brush(), kTestPixel, 1);
    brush.load({{add_paint(canvas, "Pyrrole Red"), 1}}, 1);
    stroke(canvas, brush, {-8, 0}, {8, 0});
    brush.turn_to(0.3f);
    const auto before = brush.bristles();
    const Canvas painted = canvas;
    std::vector<Dab> dabs;
    for (int i = 0; i < 500; ++i)
        dabs.push_back({.x = 400.0 + i, .y = -300, .rotation_rad = 0.01f * static_cast<float>(i), .step = i});
    DabMemory memory;
    UpperFilm other(brush);
    EXPECT_EQ(paint_dabs(canvas, brush, dabs, 1, other, memory), 0) << "pixels under the brush";
    EXPECT_EQ(brush.bristles().mm, before.mm);
    EXPECT_EQ(canvas.wet().painted(), painted.wet().painted());
}

TEST(Stroke, IsWatchedAtTheTimesAskedForAndPaintsTheSame) {
    const auto paint = [](Canvas& canvas, Stroke::Look look) {
        Brush brush(brush_presets().at("flat"), kTestPixel, 4);
        brush.load({{add_paint(canvas, "Pyrrole Red"), 1}}, 1);
        Stroke s(canvas, brush, {}, 3);
        if (look) s.watch(0.5, look);
        // 1 mm a second for 4 s, a rest of 2 s, and on; clocks need not begin at 0.
        for (const auto& [t, x] : {std::pair{100.0, -8.0}, {104.0, -4.0}, {106.0, -4.0}, {110.0, 8.0}})
            s.add({.time_s = t, .x_mm = x, .y_mm = 1});
        s.finish();
        EXPECT_EQ(s.age_s(), 10);
    };
    Canvas alone = flat_canvas(), watched = flat_canvas();
    paint(alone, {});
    std::vector<double> ages, volumes;
    paint(watched, [&](double age_s) {
        ages.push_back(age_s);
        volumes.push_back(watched.volumes_mm3()[0]);
        return age_s + 1;
    });
    EXPECT_TRUE(identical(alone.wet(), watched.wet()));
    ASSERT_EQ(ages.size(), 10u);  // 0.5 to 9.5
    EXPECT_EQ(ages.back(), 9.5);
    for (std::size_t i = 1; i < volumes.size(); ++i)
        if (ages[i] > 4 && ages[i - 1] > 4 && ages[i] < 6)
            EXPECT_EQ(volumes[i], volumes[i - 1]) << ages[i];  // it rests
        else
            EXPECT_GT(volumes[i], volumes[i - 1]) << ages[i];
    EXPECT_LT(volumes.back(), watched.volumes_mm3()[0]);
}

}  // namespace
}  // namespace tangi
