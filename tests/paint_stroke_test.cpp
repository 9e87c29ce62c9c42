// paint_stroke_test.cpp: the laws of strokes: conservation, mixing, streaks, rotation, sameness on all
// threads.
#include "paint/stroke.h"

#include <gmock/gmock.h>

#include <numbers>

#include "paint/substrate.h"
#include "surface/painting_file.h"
#include "surface/parallel.h"
#include "tests/paint_support.h"
#include "tests/test_support.h"

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

TEST(Stroke, ASecondPassDepositsLess) {
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

TEST(Stroke, LeavesARidgeWhereItEnds) {
    Canvas canvas = flat_canvas(240, 80);
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush brush(even_brush(8), kTestPixel, 4);
    brush.load({{red, 1}}, 1.5);
    stroke(canvas, brush, {-20, 0}, {12, 0}, 0.8);
    const Image<float> mm = thickness_of(canvas);
    float body = 0, end = 0;
    for (int y = 38; y < 42; ++y)
        for (int x = 90; x < 110; ++x) body += mm(x, y) / 80;
    for (int x = 168; x < 190; ++x) end = std::max(end, mm(x, 40));
    EXPECT_GT(body, 0.03f);
    EXPECT_GT(end, 1.3f * body);
}

TEST(Stroke, BristlesLeaveStreaksAlongIt) {
    Canvas canvas = flat_canvas(240, 80);
    const auto red = add_paint(canvas, "Pyrrole Red");
    Brush brush(brush_presets().at("flat"), kTestPixel, 4);
    brush.load({{red, 1}}, 1.5);
    stroke(canvas, brush, {-20, 0}, {20, 0}, 0.6);
    const Image<float> mm = thickness_of(canvas);
    // Roughness across the stroke, and along it.
    double across = 0, along = 0;
    for (int y = 25; y < 55; ++y)
        for (int x = 80; x < 140; ++x) {
            across += std::pow(mm(x, y + 1) - mm(x, y), 2);
            along += std::pow(mm(x + 1, y) - mm(x, y), 2);
        }
    EXPECT_GT(across, 2 * along);
}

// A wide flat brush that turns with a curve leaves streaks along it: no sawtooth from pixels, no rungs.
TEST(Stroke, ATurningBrushLeavesCleanStreaks) {
    constexpr double pi = std::numbers::pi, radius_mm = 28, radius_px = radius_mm / kTestPixel;
    for (const double load : {1.0, 3.0}) {
        Canvas canvas = flat_canvas(360, 360);
        const auto red = add_paint(canvas, "Pyrrole Red");
        BrushSettings settings = brush_presets().at("flat");
        settings.size_mm = 30;
        settings.grain = 0;
        Brush brush(settings, kTestPixel, 4);
        brush.load({{red, 1}}, load);
        Stroke s(canvas, brush, {}, 1);
        for (int i = 0; i <= 60; ++i) {
            const double angle = (200 - 2 * i) * pi / 180;
            s.add({i * 0.01, radius_mm * std::cos(angle), radius_mm * std::sin(angle) - 5, 0.6, 0, 0, 0});
        }
        s.finish();
        const Image<float> mm = thickness_of(canvas);
        const auto at = [&](double r, double angle) {
            const double x = 179.5 + r * std::cos(angle), y = 179.5 + 5 / kTestPixel - r * std::sin(angle);
            const int ix = static_cast<int>(x), iy = static_cast<int>(y);
            const double fx = x - ix, fy = y - iy;
            return (mm(ix, iy) * (1 - fx) + mm(ix + 1, iy) * fx) * (1 - fy) +
                   (mm(ix, iy + 1) * (1 - fx) + mm(ix + 1, iy + 1) * fx) * fy;
        };
        // Curvature over two pixels, along the stroke and across.
        double along = 0, across = 0, count = 0;
        for (double r = radius_px - 45; r < radius_px + 45; ++r)
            for (double angle = 120 * pi / 180; angle < 175 * pi / 180; angle += 0.007) {
                const double step = 2 / r, middle = 2 * at(r, angle);
                along += std::pow(at(r, angle + step) + at(r, angle - step) - middle, 2), ++count;
                across += std::pow(at(r + 2, angle) + at(r - 2, angle) - middle, 2);
            }
        EXPECT_LT(std::sqrt(along / across), load > 2 ? 0.17 : 0.24) << load;
        // Rungs [mm]; streaks are as high as the paint is thick.
        EXPECT_LT(std::sqrt(along / count), load > 2 ? 0.008 : 0.016) << load;
    }
}

// Where a stroke crosses wet paint, its bristles drag streaks of both colours along.
TEST(Stroke, CrossingWetPaintLeavesStreaksOfBoth) {
    BrushSettings settings = brush_presets().at("flat");
    settings.size_mm = 14;
    double unevenness = 0;  // of the part of yellow from row to row, over its mean
    for (const std::uint64_t seed : {3, 5, 7, 9}) {
        Canvas canvas = flat_canvas(400, 160);
        const auto yellow = add_paint(canvas, "Hansa Yellow Opaque"),
                   blue = add_paint(canvas, "Ultramarine Blue");
        Brush first(settings, kTestPixel, seed), second(settings, kTestPixel, seed + 1);
        first.load({{yellow, 1}}, 1.2);
        stroke(canvas, first, {-10, 16}, {-10, -16});
        second.load({{blue, 1}}, 1);
        stroke(canvas, second, {-40, 0}, {40, 0});
        // From 8 to 20 mm behind the crossing.
        std::vector<double> parts;
        double mean = 0, squares = 0;
        for (int y = 60; y < 100; ++y) {
            double sum = 0, of_yellow = 0;
            for (int x = 220; x < 268; ++x) {
                sum += canvas.wet().thickness_mm(x, y);
                of_yellow += canvas.wet().thickness_mm(x, y, yellow);
            }
            if (sum > 0.1) parts.push_back(of_yellow / sum);  // [mm] the row is not bare
        }
        ASSERT_GE(parts.size(), 20u) << seed;
        for (const double part : parts) mean += part / static_cast<double>(parts.size());
        for (const double part : parts)
            squares += std::pow(part - mean, 2) / static_cast<double>(parts.size());
        EXPECT_GT(mean, 0.1) << seed;  // it is carried along
        unevenness += std::sqrt(squares) / mean / 4;
    }
    EXPECT_GT(unevenness, 0.11);
}

TEST(Stroke, MarksDoNotRepeat) {
    Canvas canvas = flat_canvas(800, 60);
    const auto red = add_paint(canvas, "Pyrrole Red");
    BrushSettings settings = brush_presets().at("round");
    settings.size_mm = 5;
    Brush brush(settings, kTestPixel, 4);
    brush.load({{red, 1}}, 3);
    stroke(canvas, brush, {-95, 0}, {95, 0}, 0.6);
    const Image<float> mm = thickness_of(canvas);
    // What varies along the stroke: each row without its mean over two dabs, which falls as the brush runs
    // dry.
    constexpr int first = 60, count = 640, half = 20;
    std::vector<std::vector<double>> rows;
    for (int y = 24; y < 36; ++y) {
        rows.emplace_back();
        for (int i = 0; i < count; ++i) {
            double mean = 0;
            for (int k = -half; k <= half; ++k) mean += mm(first + i + k, y) / (2 * half + 1);
            rows.back().push_back(mm(first + i, y) - mean);
        }
    }
    double largest = 0;
    for (int lag = 22; lag < count / 2; ++lag) {  // past the dab of 20 pixels
        double both = 0, one = 0, other = 0;
        for (const auto& row : rows)
            for (int i = 0; i + lag < count; ++i) {
                const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(i + lag);
                both += row[a] * row[b];
                one += row[a] * row[a];
                other += row[b] * row[b];
            }
        largest = std::max(largest, both / std::sqrt(one * other));
    }
    EXPECT_LT(largest, 0.5);
}

TEST(Stroke, TurningItTurnsTheResult) {
    const auto painted = [](double degrees) {
        Canvas canvas = flat_canvas(160, 160);
        const auto red = add_paint(canvas, "Pyrrole Red");
        BrushSettings settings = even_brush(8);
        settings.groove_mm = 0.15;
        Brush brush(settings, kTestPixel, 4);
        brush.load({{red, 1}}, 1);
        const double turn = degrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
        Stroke stroke(canvas, brush, {}, 1);
        for (int i = 0; i <= 20; ++i) stroke.add({i * 0.01, (i - 10) * c, (i - 10) * s, 0.7, 0, 0, degrees});
        stroke.finish();
        return thickness_of(canvas);
    };
    const Image<float> straight = painted(0);
    for (const double degrees : {90.0, 30.0, 205.0}) {
        const Image<float> turned = painted(degrees);
        const double turn = degrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
        double difference = 0, size = 0, sum = 0, sum_straight = 0;
        for (int y = 30; y < 130; ++y)
            for (int x = 30; x < 130; ++x) {
                const double dx = x - 79.5, dy = 79.5 - y, tx = c * dx - s * dy + 79.5,
                             ty = 79.5 - (s * dx + c * dy);
                const int ix = static_cast<int>(tx), iy = static_cast<int>(ty);
                const double fx = tx - ix, fy = ty - iy;
                const double value = (turned(ix, iy) * (1 - fx) + turned(ix + 1, iy) * fx) * (1 - fy) +
                                     (turned(ix, iy + 1) * (1 - fx) + turned(ix + 1, iy + 1) * fx) * fy;
                difference += std::pow(value - straight(x, y), 2);
                size += std::pow(straight(x, y), 2);
                sum += value;
                sum_straight += straight(x, y);
            }
        EXPECT_LT(std::sqrt(difference / size), degrees == 90 ? 0.05 : 0.25) << degrees;
        EXPECT_NEAR(sum / sum_straight, 1, 0.05) << degrees;
    }
}

TEST(Stroke, ThinPaintKeepsToTheCrestsOfTheWeave) {
    SubstrateOptions options;
    options.width_mm = 40;
    options.height_mm = 20;
    options.pixel_mm = kTestPixel / 2;
    Canvas canvas(std::make_shared<Surface>(make_substrate(SubstrateKind::linen, options)));
    const auto white = add_paint(canvas, "Titanium White");
    BrushSettings settings = brush_presets().at("flat");
    Brush brush(settings, canvas.mm_per_pixel(), 4);
    brush.load({{white, 1}}, 0.04);
    stroke(canvas, brush, {-16, 0}, {16, 0}, 0.1);
    double on = 0, off = 0, n_on = 0, n_off = 0;
    for (int y = 60; y < 100; ++y)
        for (int x = 60; x < 260; ++x) {
            const float z = canvas.dry().height_mm(x, y), mm = canvas.wet().thickness_mm(x, y);
            if (z > 0.03f) on += mm, n_on += 1;
            if (z < -0.03f) off += mm, n_off += 1;
        }
    ASSERT_GT(n_on, 100);
    ASSERT_GT(n_off, 100);
    EXPECT_GT(on / n_on, 3 * off / n_off);
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
    StepScratch scratch;
    paint_dabs(canvas, grazing, std::vector<Dab>(20, Dab{.x = 64, .y = 48, .pressure = 0}), 1, scratch);
    EXPECT_EQ(grazing.volumes_mm3(1)[0], 0);
}

// A brush of less than a pixel has no bristles that could be told apart, but it brings its paint.
TEST(Stroke, ABrushTooSmallForThePixelsPaintsItsVolume) {
    const auto laid = [](const BrushSettings& settings, double pixel_mm, double y_mm) {
        auto ground =
            std::make_shared<Surface>(static_cast<int>(24 / pixel_mm), static_cast<int>(4 / pixel_mm));
        ground->mm_per_pixel = pixel_mm;
        ground->scale_known = true;
        Canvas canvas(ground);
        const auto red = add_paint(canvas, "Pyrrole Red");
        Brush brush(settings, pixel_mm, 4);
        brush.load({{red, 1}}, 1);
        stroke(canvas, brush, {-9, y_mm}, {9, y_mm});
        return canvas.volumes_mm3()[0];
    };
    for (const char* shape : {"round", "flat"})
        for (const double size_mm : {0.1, 0.3, 0.6}) {
            BrushSettings settings = brush_presets().at(shape);
            settings.size_mm = size_mm;
            settings.load_variation = 0;
            const double wanted = laid(settings, size_mm / 15, 0);
            for (const double y_mm : {0.0, 0.04, 0.1, 0.125}) {  // wherever it lies between the pixels
                const double now = laid(settings, 0.25, y_mm);
                EXPECT_GT(now, 0.5 * wanted) << shape << " " << size_mm << " at " << y_mm;
                EXPECT_LT(now, 1.1 * wanted) << shape << " " << size_mm << " at " << y_mm;
            }
        }
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
