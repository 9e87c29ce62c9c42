// pixel_scores_test.cpp: how many pixels are better off, whatever the picture's mean says.
#include "fit/pixel/pixel_scores.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tangi {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(PixelScores, CountPixelsNotErrors) {
    PixelScores metal, paint;  // one model that helps the pixel that is worst, one that helps the others
    metal.add({1e-2, 4e-4, 4e-4, 4e-4}, 0);
    paint.add({1e+0, 1e-4, 1e-4, 1e-4}, 0);
    EXPECT_EQ(metal.part_better_than(paint), 0.25);
    EXPECT_EQ(paint.part_better_than(metal), 0.75);
    EXPECT_EQ(paint.part_better_than(paint), 0);
    EXPECT_NEAR(paint.median_gain_db(metal), 10 * std::log10(4), 1e-9);
    EXPECT_EQ(paint.median_gain_db(PixelScores()), 0);
}

TEST(PixelScores, AreMeansOverThePhotographsThatShowThePixel) {
    PixelScores a, b;
    a.add({1e-2, kNone, 1e-4}, 0);
    a.add({1e-4, 1e-3, 1e-4}, 0);
    b.add({5e-4, 1e-2, kNone}, 0);
    b.add({5e-4, 1e-2, kNone}, 0);
    EXPECT_EQ(a.part_better_than(b), 0.5);  // 20 and 40 against 33 dB, 30 against 20
    EXPECT_EQ(b.part_better_than(a), 0.5);
    PixelScores halves, rest;  // the same in two parts
    halves.add({1e-2, kNone, 1e-4}, 0);
    rest.add({1e-4, 1e-3, 1e-4}, 0);
    halves.add(rest);
    EXPECT_EQ(halves.part_better_than(b), a.part_better_than(b));
}

TEST(PixelScores, TakeErrorsBelowTheNoiseForNone) {
    PixelScores exact, noisy;
    exact.add({0, 0, 1e-9}, 1e-4);
    noisy.add({1e-9, 1e-3, 0}, 1e-4);
    EXPECT_NEAR(exact.part_better_than(noisy), 2 / 3.0, 1e-12);
    PixelScores of_marked;
    of_marked.add({0, 0, 0}, 1e-4, {false, true, false});
    EXPECT_EQ(of_marked.part_better_than(noisy), 1);
    EXPECT_EQ(PixelScores().part_better_than(noisy), 0);
}

}  // namespace
}  // namespace tangi
