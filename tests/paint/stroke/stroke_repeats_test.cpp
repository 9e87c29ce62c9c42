// stroke_repeats_test.cpp: what varies along a stroke: it does not repeat, and there are no rungs.
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "paint/stroke/stroke.h"
#include "tests/support/paint/paint_samples.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

struct Marks {
    double largest = 0;  // correlation with itself, past the dab
    double rungs = 0;    // [1] rms of what all rows have in common, of their thickness
};

// Of a stroke at an angle. `half` of the pixels over which the mean around is taken; `width` [1] of the
// brush's that is looked at.
Marks marks_of(const char* preset, double size_mm, double load, double degrees, std::uint64_t seed,
               int half = 10, double width = 0.5) {
    constexpr int side = 840, first = 60, count = 640;
    Canvas canvas = flat_canvas(side, side);
    const auto red = add_paint(canvas, "Pyrrole Red");
    BrushSettings settings = brush_presets().at(preset);
    settings.size_mm = size_mm;
    Brush brush(settings, kTestPixel, seed);
    brush.load({{red, 1}}, load);
    const double turn = degrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
    stroke(canvas, brush, {-95 * c, -95 * s}, {95 * c, 95 * s}, 0.6, seed);
    const Image<float> mm = thickness_of(canvas);
    const auto at = [&](int along, int across) {
        const double x = along - 380, y = across, middle = (side - 1) / 2.0;
        return static_cast<double>(sampled(mm, middle + c * x - s * y, middle - s * x - c * y));
    };
    // Each row over its mean around, which falls as the brush runs dry.
    std::vector<std::vector<double>> rows;
    const int rim = static_cast<int>(size_mm / kTestPixel / 2 * width);
    for (int y = -rim; y <= rim; ++y) {
        rows.emplace_back();
        for (int i = first; i < first + count; ++i) {
            double mean = 0;
            for (int k = -half; k <= half; ++k) mean += at(i + k, y) / (2 * half + 1);
            rows.back().push_back((at(i, y) - mean) / (mean + 0.002));
        }
    }
    Marks marks;
    for (int i = 0; i < count; ++i) {
        double common = 0;
        for (const auto& row : rows)
            common += row[static_cast<std::size_t>(i)] / static_cast<double>(rows.size());
        marks.rungs += common * common / count;
    }
    marks.rungs = std::sqrt(marks.rungs);
    for (int lag = static_cast<int>(size_mm / kTestPixel) + 2; lag < count / 2; ++lag) {
        double both = 0, one = 0, other = 0;
        for (const auto& row : rows)
            for (std::size_t i = 0, j = static_cast<std::size_t>(lag); j < row.size(); ++i, ++j) {
                both += row[i] * row[j];
                one += row[i] * row[i];
                other += row[j] * row[j];
            }
        marks.largest = std::max(marks.largest, both / std::sqrt(one * other));
    }
    return marks;
}

TEST(StrokeRepeats, MarksDoNotRepeat) {
    for (const char* preset : {"round", "flat", "filbert", "fan", "knife"})
        for (const std::uint64_t seed : {1, 4, 9})
            EXPECT_LT(marks_of(preset, 5, 3, 0, seed).largest, 0.5) << preset << " " << seed;
    // Over two dabs, where the load lasts.
    for (const std::uint64_t seed : {1, 4, 9})
        EXPECT_LT(marks_of("round", 5, 3, 0, seed, 20).largest, 0.5) << seed;
}

// With its lips, which swell and break off.
TEST(StrokeRepeats, NorDoLips) {
    for (const char* preset : {"round", "flat", "filbert", "fan", "knife"})
        for (const std::uint64_t seed : {1, 4, 9})
            EXPECT_LT(marks_of(preset, 5, 3, 0, seed, 10, 1.1).largest, 0.5) << preset << " " << seed;
}

// Loads lie on whole pixels, wherever a slanting stroke goes.
TEST(StrokeRepeats, SlantingStrokesHaveNoRungs) {
    for (const char* preset : {"round", "flat", "filbert", "knife"})
        for (const double degrees : {20.0, 45.0}) {
            const Marks marks = marks_of(preset, 10, 1.5, degrees, 4);
            EXPECT_LT(marks.largest, 0.5) << preset << " " << degrees;
            EXPECT_LT(marks.rungs, std::string(preset) == "knife" ? 0.035 : 0.05) << preset << " " << degrees;
        }
}

// [1] Rms of what varies along a stroke of a small flat brush that runs dry, from what is around it: of the
// outermost pixel and a half at either side with what lies beyond, and of all between.
struct Small {
    double edges = 0, rungs = 0;
};

Small marks_of_small(double size_mm, double degrees) {
    constexpr double pixel = 0.15;
    constexpr int side = 400, count = 200, half = 6, seeds = 4;
    const double turn = degrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
    const double rim = size_mm / pixel / 2, end = 130 * pixel;
    Small marks;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        Canvas canvas = flat_canvas(side, side, pixel);
        const auto red = add_paint(canvas, "Pyrrole Red");
        BrushSettings settings = brush_presets().at("flat");
        settings.size_mm = size_mm;
        Brush brush(settings, pixel, seed);
        brush.load({{red, 1}}, 2);
        stroke(canvas, brush, {-end * c, -end * s}, {end * c, end * s}, 0.6, seed);
        const Image<float> mm = thickness_of(canvas);
        std::vector<double> edges(count + 2 * half, 0.0), inner(edges.size(), 0.0);
        for (std::size_t i = 0; i < edges.size(); ++i)
            for (double y = -rim - 3; y <= rim + 3; y += 0.5) {
                const double x = static_cast<double>(i) - 110, middle = (side - 1) / 2.0;
                (std::abs(y) > rim - 1.5 ? edges : inner)[i] +=
                    0.5 * static_cast<double>(sampled(mm, middle + c * x - s * y, middle - s * x - c * y));
            }
        const auto unevenness = [&](const std::vector<double>& sums, double little) {
            double squares = 0;
            for (auto at = sums.begin() + half; at < sums.end() - half; ++at) {
                const double mean = std::accumulate(at - half, at + half + 1, 0.0) / (2 * half + 1);
                squares += std::pow((*at - mean) / (mean + little), 2) / count;
            }
            return std::sqrt(squares) / seeds;
        };
        marks.edges += unevenness(edges, 0.01);
        marks.rungs += unevenness(inner, 0.02);
    }
    return marks;
}

// Loads and contact are no part of a pixel apart that matters: no ticks beside slanting strokes of brushes
// that are a few pixels thin.
TEST(StrokeRepeats, SmallSlantingOnesHaveCleanEdges) {
    for (const double degrees : {1.5, 4.0, 9.0, 21.0, 27.0, 42.0}) {
        const Small three = marks_of_small(3, degrees), four = marks_of_small(4, degrees);
        EXPECT_LT(three.edges, 0.145) << degrees;
        EXPECT_LT(three.rungs, 0.034) << degrees;
        EXPECT_LT(four.edges, 0.09) << degrees;
        EXPECT_LT(four.rungs, 0.018) << degrees;
    }
}

}  // namespace
}  // namespace tangi
