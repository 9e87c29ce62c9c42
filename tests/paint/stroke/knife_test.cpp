// knife_test.cpp: the palette knife: it spreads smooth sheets, and scrapes where it brings no paint.
#include <gtest/gtest.h>

#include <complex>
#include <numbers>
#include <numeric>

#include "paint/stroke/stroke.h"
#include "tests/support/paint/paint_samples.h"
#include "tests/support/paint/paint_support.h"

namespace tangi {
namespace {

// A knife on something flat, its thickness along the stroke's middle every millimetre, and the roughness
// that it left: root mean square of second differences over 4 pixels, as a slope.
struct Sheet {
    std::vector<double> middle_mm;
    double roughness = 0;
    double lattice_mm = 0;  // rms of pixels against the mean of those beside them
};

Sheet knife_sheet(double degrees, double pixel_mm) {
    auto ground = std::make_shared<Surface>(static_cast<int>(70 / pixel_mm), static_cast<int>(70 / pixel_mm));
    ground->mm_per_pixel = pixel_mm;
    ground->scale_known = true;
    Canvas canvas(ground);
    const auto white = add_paint(canvas, "Titanium White");
    Brush brush(brush_presets().at("knife"), pixel_mm, 4);
    brush.load({{white, 1}}, 1);
    const double c = std::cos(degrees * std::numbers::pi / 180),
                 s = std::sin(degrees * std::numbers::pi / 180);
    stroke(canvas, brush, {-25 * c, -25 * s}, {25 * c, 25 * s});
    const Image<float> mm = thickness_of(canvas);
    const auto at = [&](double along, double across) {
        const double x = (along * c - across * s) / pixel_mm + (mm.width() - 1) / 2.0,
                     y = (mm.height() - 1) / 2.0 - (along * s + across * c) / pixel_mm;
        return sampled(mm, x, y);
    };
    Sheet sheet;
    const double step = 2 * pixel_mm;
    double squares = 0, count = 0;
    for (int along = -20; along <= 20; ++along) sheet.middle_mm.push_back(at(along, 0));
    for (double along = -20; along <= 15; along += pixel_mm)
        for (double across = -6; across <= 6; across += 0.7) {
            const double middle = 2 * at(along, across);
            squares += std::pow(at(along + step, across) + at(along - step, across) - middle, 2) +
                       std::pow(at(along, across + step) + at(along, across - step) - middle, 2);
            count += 2;
        }
    sheet.roughness = std::sqrt(squares / count) / step;
    squares = count = 0;
    for (int y = 1; y + 1 < mm.height(); ++y)
        for (int x = 1; x + 1 < mm.width(); ++x) {
            const double dx = (x - (mm.width() - 1) / 2.0) * pixel_mm,
                         dy = ((mm.height() - 1) / 2.0 - y) * pixel_mm;
            if (std::abs(c * dx + s * dy) > 10 || std::abs(c * dy - s * dx) > 6) continue;
            const float beside = mm(x - 1, y) + mm(x + 1, y) + mm(x, y - 1) + mm(x, y + 1);
            squares += std::pow(static_cast<double>(mm(x, y) - beside / 4), 2);
            ++count;
        }
    sheet.lattice_mm = std::sqrt(squares / count);
    return sheet;
}

// No crosshatch at any angle, and no cliff where the load runs out.
TEST(Knife, SpreadsASmoothSheetThatTapers) {
    for (const double degrees : {0.0, 10.0, 22.0, 45.0}) {
        const Sheet sheet = knife_sheet(degrees, 0.2);
        EXPECT_LT(sheet.roughness, 0.03) << degrees;
        EXPECT_LT(sheet.lattice_mm, 0.5e-3) << degrees;
        for (std::size_t i = 1; i < sheet.middle_mm.size(); ++i) {
            EXPECT_NEAR(sheet.middle_mm[i], sheet.middle_mm[i - 1], 0.15 * sheet.middle_mm[i - 1])
                << degrees << " " << i;
        }
        EXPECT_GT(sheet.middle_mm.front(), 0.15) << degrees;
        EXPECT_LT(sheet.middle_mm.back(), 0.9 * sheet.middle_mm.front()) << degrees;
        EXPECT_GT(sheet.middle_mm.back(), 0.05) << degrees;
    }
}

// A blade without paint scrapes wet paint to a film and leaves it beside its way and at the end of it, in any
// direction and with any pixels.
TEST(Knife, ScrapesWhereItBringsNoPaint) {
    for (const auto& [degrees, pixel_mm] :
         {std::pair(0.0, 0.25), {30.0, 0.25}, {0.0, 0.125}, {30.0, 0.125}}) {
        const auto what = std::to_string(degrees) + " " + std::to_string(pixel_mm);
        const int side = static_cast<int>(64 / pixel_mm);
        Canvas canvas = flat_canvas(side, side, pixel_mm);
        const auto blue = add_paint(canvas, "Ultramarine Blue");
        const double c = std::cos(degrees * std::numbers::pi / 180),
                     s = std::sin(degrees * std::numbers::pi / 180);
        BrushSettings flat = brush_presets().at("flat");
        flat.size_mm = 24;
        Brush brush(flat, pixel_mm, 4);
        brush.load({{blue, 1}}, 3);
        stroke(canvas, brush, {-25 * c, -25 * s}, {12 * c, 12 * s});
        const Image<float> before = thickness_of(canvas);
        BrushSettings settings = brush_presets().at("knife");
        settings.size_mm = 12;
        Brush knife(settings, pixel_mm, 5);
        const auto volume = on_both(canvas, knife);
        stroke(canvas, knife, {-26 * c, -26 * s}, {20 * c, 20 * s});
        EXPECT_NEAR(on_both(canvas, knife)[0] / volume[0], 1, 1e-5) << what;
        const Image<float> after = thickness_of(canvas);
        // From there to there [mm], along the stroke and across it.
        const auto over = [&, pixel_mm = pixel_mm](const Image<float>& mm, double x0, double y0, double x1,
                                                   double y1) {
            std::vector<double> there;
            for (double x = x0; x < x1; x += pixel_mm)
                for (double y = y0; y < y1; y += pixel_mm)
                    there.push_back(sampled(mm, (side - 1) / 2.0 + (c * x - s * y) / pixel_mm,
                                            (side - 1) / 2.0 - (s * x + c * y) / pixel_mm));
            return there;
        };
        const auto mean = [](const std::vector<double>& mm) {
            return std::accumulate(mm.begin(), mm.end(), 0.0) / static_cast<double>(mm.size());
        };
        const double there = mean(over(before, -15, -3.75, 5, 3.75)),
                     film = mean(over(after, -15, -3.75, 5, 3.75));
        EXPECT_GT(there, 0.15) << what;
        EXPECT_LT(film, 0.4 * there) << what;
        EXPECT_GT(film, 0.005) << what;
        // Beside the blade's ends, 6 mm from its middle, and where it was lifted.
        EXPECT_GT(mean(over(after, -15, 6, 5, 7)), mean(over(before, -15, 6, 5, 7)) + 0.02) << what;
        const auto end = over(after, 18, -0.25, 24, 0.25);
        EXPECT_GT(*std::max_element(end.begin(), end.end()), there) << what;
    }
}

// Pushed through a heap, what stands high before the blade climbs its face and comes along on it: before, it
// stood there as a wall, one or two pixels wide: of a heap of 1.5 mm, 13 to 35 mm high.
TEST(Knife, LiftsWhatItHeapsUp) {
    constexpr double pixel_mm = 0.25, heap_mm = 2;
    for (const double degrees : {0.0, 20.0, 90.0}) {
        Canvas canvas = flat_canvas(280, 280, pixel_mm);
        const auto white = add_paint(canvas, "Titanium White"), blue = add_paint(canvas, "Ultramarine Blue");
        PaintLayer& wet = canvas.writable_wet();
        for (int y = 0; y < 280; ++y)
            for (int x = 0; x < 280; ++x)
                if (std::hypot(x - 139.5, y - 139.5) < 60)
                    wet.writable({x / kTileSize, y / kTileSize})
                        .writable_plane(
                            x < 140
                                ? white
                                : blue)[static_cast<std::size_t>(y % kTileSize * kTileSize + x % kTileSize)] =
                        static_cast<float>(heap_mm);
        Brush knife(brush_presets().at("knife"), pixel_mm, 5);
        const auto before = on_both(canvas, knife);
        const double c = std::cos(degrees * std::numbers::pi / 180),
                     s = std::sin(degrees * std::numbers::pi / 180);
        stroke(canvas, knife, {-24 * c, -24 * s}, {24 * c, 24 * s});
        const auto after = on_both(canvas, knife);
        for (const IngredientId paint : {white, blue}) {
            EXPECT_NEAR(after[paint] / before[paint], 1, 1e-5) << degrees;
            EXPECT_GT(knife.volumes_mm3(2)[paint], 0.1 * before[paint]) << degrees;
        }
        const Image<float> left = thickness_of(canvas);
        for (const float mm : left.pixels()) ASSERT_LT(mm, 3 * heap_mm) << degrees;
    }
}

// Relief higher than that is nobody's paint: a blade goes over it, with paint on it or none at all.
TEST(Knife, LeavesHighReliefAsItIs) {
    for (const bool painted : {false, true}) {
        auto ground = flat_surface(96, 96);
        for (int y = 40; y < 56; ++y)
            for (int x = 40; x < 56; ++x) ground->height_mm(x, y) = 20;
        Canvas canvas(ground);
        std::vector<double> before;
        Brush blade(brush_presets().at("scrape"), kTestPixel, 5);
        if (painted) {
            const auto white = add_paint(canvas, "Titanium White");
            for (int y = 40; y < 56; ++y)
                for (int x = 40; x < 56; ++x)
                    canvas.writable_wet()
                        .writable({x / kTileSize, y / kTileSize})
                        .writable_plane(
                            white)[static_cast<std::size_t>(y % kTileSize * kTileSize + x % kTileSize)] =
                        0.1f;
            before = on_both(canvas, blade);
        }
        stroke(canvas, blade, {-10, 0}, {10, 0});
        const auto after = on_both(canvas, blade);
        ASSERT_EQ(after.size(), painted ? 1u : 0u);
        if (painted) {
            EXPECT_NEAR(after[0] / before[0], 1, 1e-5);
            EXPECT_GT(canvas.wet().thickness_mm(48, 48), 0) << "a film stays";
        }
    }
}

// On a tight curve the load turns with the blade in small steps: where these were of three pixels at its
// ends, paint lay in rungs as far apart, a sixth of its thickness high.
TEST(Knife, LeavesNoRungsOnATightCurve) {
    constexpr double pi = std::numbers::pi, radius_mm = 9, size_mm = 6;
    for (const double pixel_mm : {0.1, 0.2}) {
        const int side = static_cast<int>(28 / pixel_mm);
        Canvas canvas = flat_canvas(side, side, pixel_mm);
        const auto white = add_paint(canvas, "Titanium White");
        BrushSettings settings = brush_presets().at("knife");
        settings.size_mm = size_mm;
        Brush brush(settings, pixel_mm, 4);
        brush.load({{white, 1}}, 1);
        Stroke s(canvas, brush, {}, 1);
        for (int i = 0; i <= 18; ++i)
            s.add({i * 0.05, radius_mm * std::cos(0.3 * i), radius_mm * std::sin(0.3 * i), 0.6, 0, 0, 0});
        s.finish();
        const Image<float> mm = thickness_of(canvas);
        for (const double lane_mm : {-2.0, 2.0}) {
            const double radius_px = (radius_mm + lane_mm) / pixel_mm, begin = 40 * pi / 180,
                         end = 290 * pi / 180;
            const auto at = [&](double angle) {
                return sampled(mm, (side - 1) / 2.0 + radius_px * std::cos(angle),
                               (side - 1) / 2.0 - radius_px * std::sin(angle));
            };
            // Of the thickness over its mean around, the part that repeats with each such step.
            const double period = 3 / (std::hypot(1, settings.thickness) * size_mm / pixel_mm / 2 + 2.5);
            for (const double of_it : {0.94, 1.0, 1.06}) {
                std::complex<double> wave = 0;
                int count = 0;
                for (double angle = begin; angle < end; angle += 0.002, ++count) {
                    double around = 0;
                    for (int i = -30; i <= 30; ++i) around += at(angle + i * period / 60) / 61;
                    wave += (at(angle) / around - 1) * std::polar(1.0, 2 * pi * angle / (period * of_it));
                }
                EXPECT_LT(2 * std::abs(wave) / count, 0.06) << pixel_mm << " " << lane_mm << " " << of_it;
            }
        }
    }
}

}  // namespace
}  // namespace tangi
