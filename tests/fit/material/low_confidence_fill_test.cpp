// low_confidence_fill_test.cpp: pixels that photographs say little of have the slope and colour of what is
// around.
#include "fit/material/low_confidence_fill.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace tangi {
namespace {

Vec3 normal_with_slopes(float slope_x, float slope_y) { return glm::normalize(Vec3(-slope_x, -slope_y, 1)); }

// A slope of 0.2 along x, and a crack across it that passes for a steep dark flank.
Surface cracked() {
    Surface s(40, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            const bool crack = x >= 18 && x < 21;
            s.normal(x, y) = crack ? normal_with_slopes(1.8f, -1) : normal_with_slopes(0.2f, 0);
            s.diffuse(x, y) = crack ? Rgb(0.05f) : Rgb(0.6f, 0.5f, 0.4f);
            s.specular(x, y) = crack ? 0.4f : 0.03f;
            s.roughness(x, y) = crack ? 0.05f : 0.2f;
            s.confidence(x, y) = crack ? 0.02f : 0.99f;
        }
    return s;
}

TEST(Unseen, BorrowWhatIsAround) {
    const Surface before = cracked();
    Surface s = before;
    fill_low_confidence(s);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            EXPECT_EQ(s.confidence(x, y), before.confidence(x, y));
            if (x >= 18 && x < 21) {
                const Slope slope = slope_of(s.normal(x, y));
                EXPECT_NEAR(slope.x, 0.2, 0.02);
                EXPECT_NEAR(slope.y, 0, 0.02);
                EXPECT_GT(s.diffuse(x, y).r, 0.59f);
                EXPECT_LT(s.specular(x, y), 0.04f);
                EXPECT_GT(s.roughness(x, y), 0.19f);
            } else {
                EXPECT_EQ(s.normal(x, y), before.normal(x, y));
                EXPECT_EQ(s.diffuse(x, y), before.diffuse(x, y));
            }
        }
}

// The less what is around agrees, the more of the pixel's own is left.
TEST(Unseen, KeepTheirOwnWhereNeighboursDiffer) {
    Surface s = cracked();
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x)
            if (s.confidence(x, y) > 0.5f)
                s.normal(x, y) = normal_with_slopes(y % 2 == 0 ? 1.5f : -1.5f, 0);
            else
                s.confidence(x, y) = 0.2f;
    const Surface before = s;
    fill_low_confidence(s);
    EXPECT_NEAR(slope_of(s.normal(19, 15)).x, 1.8, 0.25);
}

TEST(Unseen, StayWhereNothingAroundIsSurer) {
    Surface s = cracked();
    for (float& confidence : s.confidence.pixels()) confidence = 0.1f;
    s.confidence(2, 2) = 0;
    s.normal(2, 2) = normal_with_slopes(3, 3);
    const Surface before = s;
    fill_low_confidence(s);
    for (std::size_t i = 0; i < s.normal.size(); ++i) {
        EXPECT_EQ(s.normal.pixels()[i], before.normal.pixels()[i]);
        EXPECT_EQ(s.diffuse.pixels()[i], before.diffuse.pixels()[i]);
    }
}

}  // namespace
}  // namespace tangi
