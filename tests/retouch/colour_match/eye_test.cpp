// eye_test.cpp: what the eye has of a picture from a distance.
#include <gtest/gtest.h>

#include "retouch/colour_match/viewing_distance.h"
#include "surface/image/colour.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(Eye, SeesMiddleFrequenciesBest) {
    double best = 0, at = 0;
    for (double f = 0.1; f < 60; f *= 1.05)
        if (contrast_sensitivity(f, 100, 10) > best) best = contrast_sensitivity(f, 100, 10), at = f;
    // What every measurement has: a peak of some hundreds at 2 to 6 cycles a degree, nothing beyond 60.
    EXPECT_GT(at, 2);
    EXPECT_LT(at, 6);
    EXPECT_GT(best, 200);
    EXPECT_LT(best, 700);
    EXPECT_LT(contrast_sensitivity(70, 100, 10), 2);
    EXPECT_GT(contrast_sensitivity(20, 500, 10), contrast_sensitivity(20, 1, 10))
        << "more light, finer detail";
}

TEST(Eye, LeavesPlainColoursAsTheyAre) {
    const Image<Rgb> plain(60, 50, Rgb(0.3f, 0.15f, 0.4f));
    const Image<Rgb> seen = seen_from(plain, 0.2, 1);
    for (const Rgb& c : seen.pixels())
        EXPECT_LT(delta_e_2000(lab_from_linear(c), lab_from_linear(plain(0, 0))), 0.05);
}

// White, black and red strokes on green: as people are shown it from afar, grey stays grey, and no colour
// comes about that none of it has.
TEST(Eye, ShowsNoColoursThatAreNotThere) {
    const auto strokes = [](const Rgb& ground, const Rgb& third) {
        Image<Rgb> picture(160, 120, ground);
        for (int y = 10; y < 110; ++y)
            for (int x = 0; x < 160; ++x) {
                if (x >= 30 && x < 50) picture(x, y) = Rgb(0.85f);
                if (x >= 70 && x < 80) picture(x, y) = Rgb(0.02f);
                if (x >= 110 && x < 118) picture(x, y) = third;
            }
        return picture;
    };
    for (const double distance_m : {0.5, 1.0, 2.0, 5.0}) {
        const Image<Rgb> grey = shown_from(strokes(Rgb(0.2f), Rgb(0.5f)), 0.25, distance_m);
        for (const Rgb& c : grey.pixels())
            EXPECT_LT(std::max({c.r, c.g, c.b}) - std::min({c.r, c.g, c.b}), 1e-4f);
        const Rgb ground(0.05f, 0.25f, 0.08f), red(0.5f, 0.05f, 0.05f);
        const Image<Rgb> seen = shown_from(strokes(ground, red), 0.25, distance_m);
        for (const Rgb& c : seen.pixels()) {
            const float all = c.r + c.g + c.b;
            if (all < 0.01f) continue;  // black has no colour
            EXPECT_LT(c.b / all, 0.36f) << "nothing is blue";
            EXPECT_GT(c.b / all, 0.05f);
            EXPECT_LT(c.g / all, 0.70f) << "nothing is greener than the ground";
            EXPECT_LT(c.r / all, 0.88f);
        }
    }
}

// Lines of two colours become the mean of both.
TEST(Eye, ShowsFineLinesAsTheirMean) {
    const Rgb a(0.5f, 0.1f, 0.1f), b(0.1f, 0.3f, 0.1f);
    Image<Rgb> lines(200, 60);
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 200; ++x) lines(x, y) = x % 2 == 0 ? a : b;
    const Image<Rgb> seen = shown_from(lines, 0.2, 5);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen(100, 30)[c], (a[c] + b[c]) / 2, 0.01f);
}

// Vertical bars of black and white, with their mean as target.
Fusion fusion_of_bars(int pitch_px) {
    Image<Rgb> bars(240, 120), grey(240, 120, Rgb(0.25f));
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 240; ++x) bars(x, y) = Rgb(x % pitch_px < pitch_px / 2 ? 0.4f : 0.1f);
    Mask mask(240, 120);
    for (int y = 20; y < 100; ++y)
        for (int x = 20; x < 220; ++x) mask(x, y) = 1;
    for (std::size_t i = 0; i < mask.size(); ++i)
        if (!(mask.pixels()[i] > 0)) bars.pixels()[i] = grey.pixels()[i];
    return fusion_of(bars, grey, mask, pitch_px, 0.25, {});
}

TEST(Eye, FusesLinesFartherOffWhereTheyAreWider) {
    const Fusion fine = fusion_of_bars(4), coarse = fusion_of_bars(8);
    ASSERT_TRUE(fine.fuses && coarse.fuses);
    EXPECT_NEAR(coarse.distance_m / fine.distance_m, 2, 0.3);
    // 1 mm of a grating of full contrast: 40 to 60 cycles a degree, so 2 to 4 m.
    EXPECT_GT(fine.distance_m, 1.5);
    EXPECT_LT(fine.distance_m, 4);
    EXPECT_LT(fine.delta_e_fused, fine.delta_e_near);
    EXPECT_LT(fine.delta_e_fused, 1.5);
}

}  // namespace
}  // namespace tangi
