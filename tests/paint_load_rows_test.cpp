// paint_load_rows_test.cpp: loads go from row to row of pixels, whatever the direction.
#include "paint/load_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/test_support.h"

namespace tangi {
namespace {

struct Direction {
    double x, y;
};

std::vector<Direction> directions() {
    std::vector<Direction> all;
    for (int degrees = 0; degrees < 360; degrees += 3)
        all.push_back(
            {std::cos(degrees * std::numbers::pi / 180), std::sin(degrees * std::numbers::pi / 180)});
    return all;
}

TEST(LoadRows, AreNearlySquareToTheMotion) {
    for (const Direction d : directions()) {
        const LoadRows rows = rows_across(d.x, d.y);
        EXPECT_GT(rows.at(d.x, d.y) / std::hypot(rows.ax, rows.ay), std::cos(22.6 * std::numbers::pi / 180));
        EXPECT_NEAR(rows.per_px, rows.at(d.x, d.y), 1e-12);
    }
    EXPECT_EQ(rows_across(0, 0).ax, 1);
    EXPECT_EQ(rows_across(0, 0).ay, 0);
}

// From anywhere, within a few steps each one brings the loads exactly as many rows on as it does the brush.
TEST(LoadRows, AreMetByEveryStep) {
    Random random(5);
    for (const Direction d : directions())
        for (const double wanted : {1.0, 0.9, 0.5, 0.34}) {
            double x = random.real(-9, 9), y = random.real(-9, 9);
            const LoadRows rows = rows_across(d.x, d.y);
            for (int i = 0; i < 60; ++i) {
                const double way = way_to_row_px(rows, rows.at(x, y), wanted, wanted);
                EXPECT_GT(way, 0);
                EXPECT_LT(way, 1.3 * wanted) << d.x << ' ' << d.y;
                x += way * d.x;
                y += way * d.y;
                const LoadPixel pixel = pixel_of_row(x, y, d.x, d.y, 0);
                const double off = rows.at(pixel.x, pixel.y) - rows.at(x, y);
                const double parts = std::round(1 / (way * rows.per_px));  // steps for a row
                if (i > 30) {
                    EXPECT_LE(std::abs(off), 0.5 - 0.5 / parts + 1e-9);
                }
            }
        }
}

// Long contacts go two diagonals at a time, never two columns.
TEST(LoadRows, MayBeSkipped) {
    EXPECT_NEAR(way_to_row_px(rows_across(1, 0), 3, 1, 1.55), 1, 1e-12);
    const double root = std::sqrt(0.5);
    EXPECT_NEAR(way_to_row_px(rows_across(root, root), 3, 1, 1.55), 2 * root, 1e-12);
    EXPECT_NEAR(way_to_row_px(rows_across(root, root), 3, 1, 1), root, 1e-12);
}

// Over all shifts they are where the way crosses the row; and never farther to the side than half of the way
// to the next pixel of it and the shift.
TEST(LoadRows, ArePixelsThatLieAroundTheWay) {
    Random random(7);
    for (const Direction d : directions()) {
        const double x = random.real(-99, 99), y = random.real(-99, 99);
        const LoadRows rows = rows_across(d.x, d.y);
        const double each = std::hypot(rows.ax, rows.ay);
        double mean_x = 0, mean_y = 0;
        constexpr int shifts = 2000;
        for (int i = 0; i < shifts; ++i) {
            const LoadPixel pixel = pixel_of_row(x, y, d.x, d.y, (i + 0.5) / shifts - 0.5);
            EXPECT_LE(std::abs(rows.at(pixel.x - x, pixel.y - y)), 0.5001);
            mean_x += (pixel.x - x) / shifts;
            mean_y += (pixel.y - y) / shifts;
            EXPECT_LE(std::abs(pixel.y * d.x - pixel.x * d.y - (y * d.x - x * d.y)), each + 0.01);
        }
        EXPECT_NEAR(mean_y * d.x - mean_x * d.y, 0, 2e-3) << d.x << ' ' << d.y;
    }
}

}  // namespace
}  // namespace tangi
