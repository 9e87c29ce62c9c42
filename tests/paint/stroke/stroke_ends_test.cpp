// stroke_ends_test.cpp: where brushes are put down and lifted: rims, no ramps; dabs that are round; and
// thin paint, which lies in streaks.
#include <gtest/gtest.h>

#include <numeric>

#include "paint/exchange/squeeze_out.h"
#include "paint/stroke/stroke.h"
#include "paint/substrate/substrate.h"
#include "tests/support/paint/paint_support.h"

namespace tangi {
namespace {

constexpr double kFine = 0.125;  // [mm] pixels

Canvas fine_canvas(int width, int height) {
    auto ground = std::make_shared<Surface>(width, height);
    ground->mm_per_pixel = kFine;
    ground->scale_known = true;
    return Canvas(ground);
}

BrushSettings without_chance(const char* preset, double size_mm) {
    BrushSettings settings = brush_presets().at(preset);
    settings.size_mm = size_mm;
    settings.groove_mm = settings.load_variation = settings.grain = 0;
    return settings;
}

// What is laid begins and ends as thick as it goes on, and higher at the very ends, where pressure drove it
// to.
TEST(StrokeEnds, HaveRimsAndNoRamps) {
    for (const char* preset : {"round", "flat", "filbert"}) {
        Canvas canvas = fine_canvas(480, 160);
        const auto white = add_paint(canvas, "Titanium White");
        Brush brush(without_chance(preset, 8), kFine, 1);
        brush.load({{white, 1}}, 2);
        stroke(canvas, brush, {-22, 0}, {16, 0}, 0.7);
        const Image<float> mm = thickness_of(canvas);
        std::vector<double> along;  // the middle millimetre
        for (int x = 0; x < mm.width(); ++x) {
            along.push_back(0);
            for (int y = 76; y < 84; ++y) along.back() += mm(x, y) / 8;
        }
        const auto mean = [](auto begin, auto end) {
            return std::accumulate(begin, end, 0.0) / static_cast<double>(end - begin);
        };
        const auto lies = [](double there) { return there > 0.01; };
        const auto first = std::find_if(along.begin(), along.end(), lies);
        const auto last = std::find_if(along.rbegin(), along.rend(), lies).base();
        ASSERT_GT(last - first, 280) << preset;
        const double begun = mean(first + 80, first + 100), ended = mean(last - 100, last - 80);
        // From 1 to 2 mm inside of the ends.
        EXPECT_GT(mean(first + 8, first + 16), 0.7 * begun) << preset;
        EXPECT_GT(mean(last - 16, last - 8), 0.7 * ended) << preset;
        // Within 1.5 mm of them.
        EXPECT_GT(*std::max_element(first, first + 12), 1.2 * begun) << preset;
        EXPECT_GT(*std::max_element(last - 12, last), 1.1 * ended) << preset;
    }
}

TEST(StrokeEnds, ADabHasARim) {
    Canvas canvas = fine_canvas(160, 160);
    const auto white = add_paint(canvas, "Titanium White");
    Brush brush(without_chance("round", 10), kFine, 1);
    brush.load({{white, 1}}, 1);
    const auto before = on_both(canvas, brush);
    Stroke dab(canvas, brush, {}, 1);
    dab.add({0, 0, 0, 0.6, 0, 0, 0});
    dab.finish();
    EXPECT_NEAR(on_both(canvas, brush)[0] / before[0], 1, 1e-5);
    const Image<float> mm = thickness_of(canvas);
    double middle = 0, count = 0;
    std::array<double, 4> rims{};  // the highest towards the right, left, below and above
    for (int y = 0; y < 160; ++y)
        for (int x = 0; x < 160; ++x) {
            const double dx = x - 79.5, dy = y - 79.5;
            if (std::hypot(dx, dy) < 16) {
                middle += mm(x, y);
                ++count;
            } else if (double& rim = rims[std::abs(dx) > std::abs(dy) ? (dx < 0) : 2 + (dy < 0)];
                       mm(x, y) > rim)
                rim = mm(x, y);
        }
    for (const double rim : rims) EXPECT_GT(rim, 1.3 * middle / count);
}

// Small dabs are as wide along the pixels' diagonals as along their rows.
TEST(StrokeEnds, SmallDabsAreRound) {
    for (const double size_mm : {0.6, 0.9, 1.2, 2.0}) {
        Canvas canvas = fine_canvas(80, 80);
        const auto white = add_paint(canvas, "Titanium White");
        Brush brush(without_chance("round", size_mm), kFine, 1);
        brush.load({{white, 1}}, 1);
        Stroke dab(canvas, brush, {}, 1);
        dab.add({0, kFine / 2, kFine / 2, 1, 0, 0, 0});  // the middle of a pixel
        dab.finish();
        const Image<float> mm = thickness_of(canvas);
        // Fourth harmonic of the second moment: positive for a diamond, negative for a square.
        double fourth = 0, all = 0;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 80; ++x) {
                const double dx = x - 40, dy = y - 39, r2 = dx * dx + dy * dy;
                if (r2 == 0) continue;
                const double c = (dx * dx - dy * dy) / r2, s = 2 * dx * dy / r2;  // of twice the angle
                fourth += mm(x, y) * r2 * r2 * (c * c - s * s);
                all += mm(x, y) * r2 * r2;
            }
        RecordProperty(std::to_string(size_mm), std::to_string(fourth / all));
        EXPECT_NEAR(fourth / all, 0, 0.28) << size_mm;  // half a pixel of the radius
    }
}

// Streaks run together where the brush was lifted, and not from one pixel to the next where its rear was.
TEST(StrokeEnds, StreaksFadeTowardsTheEnd) {
    constexpr int kSeeds = 12, kWidth = 480;
    std::vector<double> rough(kWidth, 0.0);  // [mm] of the rows in the middle, at each column
    for (int seed = 1; seed <= kSeeds; ++seed) {
        Canvas canvas = fine_canvas(kWidth, 160);
        const auto white = add_paint(canvas, "Titanium White");
        BrushSettings settings = brush_presets().at("flat");
        settings.size_mm = 8;
        Brush brush(settings, kFine, static_cast<std::uint64_t>(seed));
        brush.load({{white, 1}}, 2);
        stroke(canvas, brush, {-22, 0}, {16, 0}, 0.7, static_cast<std::uint64_t>(seed));
        const Image<float> mm = thickness_of(canvas);
        for (int x = 0; x < kWidth; ++x)
            for (int y = 64; y < 96; ++y)
                rough[static_cast<std::size_t>(x)] +=
                    std::abs(mm(x, y + 1) - 2 * mm(x, y) + mm(x, y - 1)) / (32 * kSeeds);
    }
    // Of 2 by 2 columns from well inside of the stroke to 1.5 mm before its end.
    const auto end = std::find_if(rough.rbegin(), rough.rend(), [](double mm) { return mm > 1e-4; }).base();
    double along = 0, most = 0;
    for (auto at = end - 80; at < end - 68; ++at) along += *at / 12;
    const auto pair = [](auto at) { return (at[0] + at[1]) / 2; };
    for (auto at = end - 60; at < end - 12; ++at) most = std::max(most, pair(at) - pair(at + 4));
    const double drop = along - pair(end - 12);
    EXPECT_GT(drop, 0.4 * along);
    EXPECT_LT(most, 0.6 * drop);
}

// Where a stroke turns back, the hand pulls the flat the other way and does not turn it round.
TEST(StrokeEnds, AFlatGoesBackAsItCame) {
    Canvas canvas = fine_canvas(320, 160);
    const auto white = add_paint(canvas, "Titanium White");
    Brush brush(without_chance("flat", 9), kFine, 1);
    brush.load({{white, 1}}, 1);
    Stroke s(canvas, brush, {}, 1);
    for (int i = 0; i <= 40; ++i) {
        const double x = i <= 20 ? i - 10 : 30 - i;  // [mm] to 10 and back
        s.add({i * 0.02, x, 0, 0.6, 0, 0, 0});
    }
    s.finish();
    const Image<float> mm = thickness_of(canvas);
    double beyond = 0;
    for (int y = 0; y < 160; ++y)
        for (int x = 160 + static_cast<int>(13 / kFine); x < 320; ++x) beyond += mm(x, y);
    EXPECT_EQ(beyond, 0) << "half of its width is 4.5 mm";
}

// Little paint on an even ground lies in streaks, not in grains of single pixels.
TEST(StrokeEnds, ThinPaintLiesInStreaks) {
    for (const char* preset : {"round", "flat", "filbert"}) {
        Canvas canvas = fine_canvas(480, 160);
        const auto white = add_paint(canvas, "Titanium White");
        Brush brush(brush_presets().at(preset), kFine, 1);
        brush.load({{white, 1}}, 0.25);
        stroke(canvas, brush, {-24, 0}, {24, 0}, 0.5);
        const Image<float> mm = thickness_of(canvas);
        double along = 0, across = 0;
        for (int y = 64; y < 96; ++y)
            for (int x = 120; x < 280; ++x) {
                along += std::pow(mm(x + 1, y) + mm(x - 1, y) - 2 * mm(x, y), 2);
                across += std::pow(mm(x, y + 1) + mm(x, y - 1) - 2 * mm(x, y), 2);
            }
        EXPECT_LT(std::sqrt(along / across), 0.5) << preset;
    }
}

// Where a brush is lifted, thin paint stays on the crests of a weave, as along the stroke: it does not run
// off into outlines around them.
TEST(StrokeEnds, ThinPaintStaysOnTheCrests) {
    for (const double pixel : {0.1, 0.2}) {
        const auto ground = std::make_shared<const Surface>(
            make_substrate(SubstrateKind::canvas, {.width_mm = 44, .height_mm = 16, .pixel_mm = pixel}));
        Canvas canvas(ground);
        const auto black = add_paint(canvas, "Bone Black");
        BrushSettings settings = brush_presets().at("flat");
        settings.size_mm = 10;
        Brush brush(settings, pixel, 1);
        brush.load({{black, 1}}, 0.1);
        stroke(canvas, brush, {-17, 0}, {17, 0}, 0.6);
        const Image<float> mm = thickness_of(canvas);
        const int rows = static_cast<int>(3.5 / pixel), middle = mm.height() / 2;
        int end = 0;
        for (int x = 0; x < mm.width(); ++x)
            if (mm(x, middle) > 0.001f) end = x;
        std::vector<std::pair<float, float>> of_height;  // relief and paint of the last 1.8 mm
        for (int y = middle - rows; y < middle + rows; ++y)
            for (int x = end - static_cast<int>(1.8 / pixel); x < end; ++x)
                of_height.emplace_back(ground->height_mm(x, y), mm(x, y));
        std::sort(of_height.begin(), of_height.end());
        const auto covered = [&](auto from, auto to) {
            return static_cast<double>(
                       std::count_if(from, to, [](const auto& p) { return p.second > 0.001f; })) /
                   static_cast<double>(to - from);
        };
        const auto fifth = static_cast<std::ptrdiff_t>(of_height.size() / 5);
        const double crests = covered(of_height.end() - fifth, of_height.end()),
                     valleys = covered(of_height.begin(), of_height.begin() + fifth);
        EXPECT_GT(crests, 0.5) << pixel;
        EXPECT_GT(crests, valleys + 0.3) << pixel;
    }
}

}  // namespace
}  // namespace tangi
