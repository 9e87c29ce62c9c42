// load_rows_test.cpp: loads go from row to row of pixels, whatever the direction.
#include "paint/stroke/load_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "tests/support/test_support.h"

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

// From anywhere, and whatever length steps are to have, the loads lie on each row for exactly its part of the
// way: never longer, never shorter.
TEST(LoadRows, ArePassedOnceEach) {
    Random random(5);
    for (const Direction d : directions())
        for (const double least : {1.0, 0.5, 0.25}) {
            double x = random.real(-9, 9), y = random.real(-9, 9);
            const LoadRows rows = rows_across(d.x, d.y);
            std::map<long, double> passed;  // rows of the way, by the row that loads lie on meanwhile
            for (int i = 0; i < 80; ++i) {
                const double wanted = random.real(least, 1);
                const double way = way_to_row_px(rows, rows.at(x, y), wanted);
                EXPECT_GT(way, 0.07);
                EXPECT_LT(way * std::max(std::abs(d.x), std::abs(d.y)), 1.11) << d.x << ' ' << d.y;
                EXPECT_LT(way, 1.4 * wanted) << d.x << ' ' << d.y;
                x += way * d.x;
                y += way * d.y;
                const LoadPixel pixel = pixel_of_row(x, y, d.x, d.y, 0, true);
                passed[std::lround(rows.at(pixel.x, pixel.y))] += way * rows.per_px;
            }
            // But for the first, which may be begun within, and the last.
            ASSERT_GT(passed.size(), 8u);
            const long first = passed.begin()->first, last = passed.rbegin()->first;
            for (const auto& [row, way] : passed) {
                if (row <= first + 1 || row == last) continue;
                EXPECT_NEAR(way, 1, 1e-9) << d.x << ' ' << d.y;
            }
            EXPECT_EQ(last - first + 1, static_cast<long>(passed.size()));
        }
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
            const LoadPixel pixel = pixel_of_row(x, y, d.x, d.y, (i + 0.5) / shifts - 0.5, false);
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
