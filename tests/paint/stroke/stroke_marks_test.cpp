// stroke_marks_test.cpp: what strokes look like: streaks, ridges, weave that shows or
// is closed; in any direction and at any size of the pixels.
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "paint/stroke/stroke.h"
#include "paint/substrate/substrate.h"
#include "tests/support/paint/paint_samples.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(StrokeMarks, LeavesARidgeWhereItEnds) {
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

// What bristles or a blade press out stays as a lip at either side, on a dry ground too, where there is paint
// enough.
TEST(StrokeMarks, PressesOutLipsAtItsSides) {
    // The highest within 1.5 mm of the print's ends over the mean of what lies 2 to 4 mm further in, without
    // tufts.
    const auto lip = [](const char* preset, double load, double pressure) {
        constexpr double pixel_mm = 0.125;
        Canvas canvas = flat_canvas(480, 200, pixel_mm);
        const auto white = add_paint(canvas, "Titanium White");
        BrushSettings settings = brush_presets().at(preset);
        settings.size_mm = 14;
        settings.groove_mm = settings.load_variation = settings.grain = 0;
        Brush brush(settings, pixel_mm, 1);
        brush.load({{white, 1}}, load);
        stroke(canvas, brush, {-25, 0}, {25, 0}, pressure);
        const Image<float> mm = thickness_of(canvas);
        std::vector<double> across;  // where the stroke has gone some 10 mm
        for (int y = 0; y < mm.height(); ++y) {
            across.push_back(0);
            for (int x = 120; x < 160; ++x) across.back() += mm(x, y) / 40;
        }
        const auto lies = [](double there) { return there > 0.005; };
        const auto first = std::find_if(across.begin(), across.end(), lies);
        const auto last = std::find_if(across.rbegin(), across.rend(), lies).base();
        if (last - first < 70) return 0.0;
        const double sum =
            std::accumulate(first + 16, first + 32, 0.0) + std::accumulate(last - 32, last - 16, 0.0);
        return (*std::max_element(first, first + 12) + *std::max_element(last - 12, last)) / 2 / (sum / 32);
    };
    for (const char* preset : {"round", "flat", "filbert", "knife"}) {
        // A brush's dome alone makes 1.6 to 2.0: bristles rise towards the rim. A blade's edge is straight.
        EXPECT_GT(lip(preset, 1.5, 0.7), std::string(preset) == "knife" ? 1.1 : 2.5) << preset;
        EXPECT_LT(lip(preset, 0.1, 0.7), 1.1) << preset;
    }
}

// They swell and break off: no edge is as if drawn with a ruler. A blade's is.
TEST(StrokeMarks, LipsAreUneven) {
    // Of the highest paint within 2 mm of either edge, over its mean along 8 mm: how much it varies.
    const auto unevenness = [](const char* preset) {
        constexpr double pixel_mm = 0.125;
        double sum = 0;
        for (const std::uint64_t seed : {1, 2, 3, 4}) {
            Canvas canvas = flat_canvas(480, 200, pixel_mm);
            const auto white = add_paint(canvas, "Titanium White");
            BrushSettings settings = brush_presets().at(preset);
            settings.size_mm = 14;
            Brush brush(settings, pixel_mm, seed);
            brush.load({{white, 1}}, 1.5);
            Stroke s(canvas, brush, {}, seed);
            for (int i = 0; i <= 50; ++i) s.add({i * 0.01, i - 25.0, 0, 0.7, 0, 0, 0});
            s.finish();
            const Image<float> mm = thickness_of(canvas);
            for (const int side : {-1, 1}) {
                std::vector<double> highest;
                for (int x = 68; x < 332; ++x) {
                    int edge = side < 0 ? 0 : mm.height() - 1;
                    while (edge != mm.height() / 2 && mm(x, edge) < 0.005f) edge -= side;
                    float high = 0;
                    for (int k = 0; k < 16; ++k) high = std::max(high, mm(x, edge - side * k));
                    highest.push_back(high);
                }
                double squares = 0, count = 0;
                for (auto at = highest.begin() + 32; at + 32 < highest.end(); ++at, ++count) {
                    const double around = std::accumulate(at - 32, at + 33, 0.0) / 65;
                    squares += std::pow(*at / around - 1, 2);
                }
                sum += std::sqrt(squares / count) / 8;
            }
        }
        return sum;
    };
    for (const char* preset : {"round", "flat", "filbert"}) EXPECT_GT(unevenness(preset), 0.03) << preset;
    EXPECT_LT(unevenness("knife"), 0.02);
}

TEST(StrokeMarks, BristlesLeaveStreaksAlongIt) {
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
TEST(StrokeMarks, ATurningBrushLeavesCleanStreaks) {
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
            return sampled(mm, x, y);
        };
        // Curvature over two pixels, along the stroke and across.
        double along = 0, across = 0, count = 0;
        for (double r = radius_px - 45; r < radius_px + 45; ++r)
            for (double angle = 120 * pi / 180; angle < 175 * pi / 180; angle += 0.007) {
                const double step = 2 / r, middle = 2 * at(r, angle);
                along += std::pow(at(r, angle + step) + at(r, angle - step) - middle, 2), ++count;
                across += std::pow(at(r + 2, angle) + at(r - 2, angle) - middle, 2);
            }
        EXPECT_LT(std::sqrt(along / across), load > 2 ? 0.12 : 0.24) << load;
        // Rungs [mm]; streaks are as high as the paint is thick.
        EXPECT_LT(std::sqrt(along / count), load > 2 ? 0.008 : 0.016) << load;
    }
}

// Where a stroke crosses wet paint, its bristles drag streaks of both colours along.
TEST(StrokeMarks, CrossingWetPaintLeavesStreaksOfBoth) {
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

TEST(StrokeMarks, TurningItTurnsTheResult) {
    const auto painted = [](const char* preset, double degrees) {
        Canvas canvas = flat_canvas(160, 160);
        const auto red = add_paint(canvas, "Pyrrole Red");
        BrushSettings settings = brush_presets().at(preset);
        settings.size_mm = 8;
        Brush brush(settings, kTestPixel, 4);
        brush.load({{red, 1}}, 1);
        const double turn = degrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
        Stroke stroke(canvas, brush, {}, 1);
        for (int i = 0; i <= 20; ++i)
            stroke.add({i * 0.01, (i - 10) * c, (i - 10) * s, 0.7, 0, 0, settings.follow ? 0 : degrees});
        stroke.finish();
        return thickness_of(canvas);
    };
    // By a quarter turn pixels come on pixels; of what is rougher, resampling takes more.
    for (const auto& [preset, any] : {std::pair("round", 0.06), {"flat", 0.11}, {"knife", 0.11}}) {
        const Image<float> straight = painted(preset, 0);
        for (const double degrees : {90.0, 30.0, 205.0}) {
            const Image<float> turned = painted(preset, degrees);
            const double turn = degrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
            double difference = 0, size = 0, sum = 0, sum_straight = 0;
            for (int y = 30; y < 130; ++y)
                for (int x = 30; x < 130; ++x) {
                    const double dx = x - 79.5, dy = 79.5 - y, tx = c * dx - s * dy + 79.5,
                                 ty = 79.5 - (s * dx + c * dy);
                    const double value = sampled(turned, tx, ty);
                    difference += std::pow(value - straight(x, y), 2);
                    size += std::pow(straight(x, y), 2);
                    sum += value;
                    sum_straight += straight(x, y);
                }
            EXPECT_LT(std::sqrt(difference / size), degrees == 90 ? 0.03 : any) << preset << degrees;
            EXPECT_NEAR(sum / sum_straight, 1, 0.03) << preset << degrees;
        }
    }
}

TEST(StrokeMarks, ThinPaintKeepsToTheCrestsOfTheWeave) {
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

// A brush of less than a pixel has no bristles that could be told apart, but it brings its paint.
TEST(StrokeMarks, ABrushTooSmallForThePixelsPaintsItsVolume) {
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

// Thick paint closes the holes of a weave: what is seen is more level than the cloth, without pits.
TEST(StrokeMarks, ThickPaintClosesTheWeave) {
    for (const SubstrateKind kind : {SubstrateKind::linen, SubstrateKind::burlap}) {
        SubstrateOptions options;
        options.width_mm = 40;
        options.height_mm = 20;
        options.pixel_mm = 0.1;
        Canvas canvas(std::make_shared<Surface>(make_substrate(kind, options)));
        const auto white = add_paint(canvas, "Titanium White");
        Brush brush(brush_presets().at("flat"), canvas.mm_per_pixel(), 4);
        brush.load({{white, 1}}, 2);
        stroke(canvas, brush, {-16, 0}, {16, 0});
        // Along the stroke, over half a thread's distance: across it lie streaks.
        const int half = kind == SubstrateKind::linen ? 3 : 9;
        const auto top = [&](int x, int y, bool with_paint) {
            return canvas.dry().height_mm(x, y) + (with_paint ? canvas.wet().thickness_mm(x, y) : 0.0f);
        };
        double bare = 0, painted = 0, open = 0, count = 0;
        for (int y = 70; y < 130; ++y)
            for (int x = 80; x < 200; ++x) {
                for (const bool with_paint : {false, true})
                    (with_paint ? painted : bare) +=
                        std::pow(top(x - half, y, with_paint) + top(x + half, y, with_paint) -
                                     2 * top(x, y, with_paint),
                                 2);
                open += canvas.wet().thickness_mm(x, y) < 0.01f;
                ++count;
            }
        EXPECT_LT(std::sqrt(painted / bare), 0.8) << name_of(kind);
        EXPECT_LT(open / count, 0.01) << name_of(kind);
    }
}

TEST(StrokeMarks, HowMuchIsLaidDoesNotDependOnPixels) {
    for (const char* preset : {"round", "flat", "filbert", "fan", "knife"}) {
        const auto laid = [&](double pixel_mm) {
            double sum = 0;
            for (const std::uint64_t seed : {1, 2, 3}) {
                auto ground = std::make_shared<Surface>(static_cast<int>(64 / pixel_mm),
                                                        static_cast<int>(30 / pixel_mm));
                ground->mm_per_pixel = pixel_mm;
                ground->scale_known = true;
                Canvas canvas(ground);
                const auto white = add_paint(canvas, "Titanium White");
                Brush brush(brush_presets().at(preset), pixel_mm, seed);
                brush.load({{white, 1}}, 1);
                stroke(canvas, brush, {-20, 0.3}, {20, 0.3});
                sum += canvas.volumes_mm3()[0];
            }
            return sum;
        };
        const double fine = laid(0.2);
        EXPECT_NEAR(laid(0.4) / fine, 1, 0.1) << preset;
        // A fan of three pixels' thickness keeps less of its arc.
        EXPECT_NEAR(laid(1) / fine, 1, std::string(preset) == "fan" ? 0.15 : 0.1) << preset;
    }
}

// A brush with little paint lays thinner streaks of it, not nothing.
TEST(StrokeMarks, HowMuchIsLaidIsInProportionToTheLoad) {
    for (const char* preset : {"round", "flat", "filbert", "fan", "knife"}) {
        const auto laid = [&](double load) {
            Canvas canvas = flat_canvas(320, 120);
            const auto white = add_paint(canvas, "Titanium White");
            Brush brush(brush_presets().at(preset), kTestPixel, 1);
            brush.load({{white, 1}}, load);
            stroke(canvas, brush, {-30, 0}, {30, 0});
            return canvas.volumes_mm3()[0];
        };
        const double full = laid(1);
        double before = full;
        for (const double load : {0.5, 0.2, 0.1}) {
            const double now = laid(load);
            EXPECT_GT(now, 0.4 * load * full) << preset << " " << load;
            EXPECT_LT(now, 1.2 * load * full) << preset << " " << load;
            EXPECT_LT(now, before) << preset << " " << load;
            before = now;
        }
    }
}

}  // namespace
}  // namespace tangi
