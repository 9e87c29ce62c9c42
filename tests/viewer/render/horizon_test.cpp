// horizon_test.cpp: horizons of walls and planes, whose angles are known.
#include "viewer/render/horizon.h"

#include <cmath>
#include <numbers>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(Horizon, OfAPlaneIsFlat) {
    const HorizonMap map = horizon_map({Image<float>(20, 16, 0.5f), 0.1});
    EXPECT_EQ(map.values.size(), 20u * 16 * HorizonMap::kAzimuths);
    for (const std::uint8_t value : map.values) EXPECT_EQ(value, 0);
}

TEST(Horizon, OfAWallIsItsAngle) {
    Image<float> z(64, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 40; x < 64; ++x) z(x, y) = 2;
    const HorizonMap map = horizon_map({z, 0.1});
    // Azimuth 0 is x, counter-clockwise: the wall stands to the right.
    for (const int distance : {4, 10}) {
        const double expected = std::atan(2 / (0.1 * distance)) * 180 / std::numbers::pi;
        EXPECT_NEAR(map.elevation_deg(40 - distance, 32, 0), expected, 1.5) << distance;
    }
    EXPECT_NEAR(map.elevation_deg(30, 32, 2),
                std::atan(2 / (1.0 * std::numbers::sqrt2)) * 180 / std::numbers::pi, 3);
    EXPECT_EQ(map.elevation_deg(30, 32, 8), 0) << "and nothing to the left";
    EXPECT_EQ(map.elevation_deg(50, 32, 0), 0) << "nor on top";
}

TEST(Horizon, UpIsUp) {
    Image<float> z(32, 32);
    for (int x = 0; x < 32; ++x) z(x, 4) = 1;  // a ridge near the upper edge
    const HorizonMap map = horizon_map({z, 0.1});
    EXPECT_GT(map.elevation_deg(16, 10, 4), 30);  // 90 degrees: up
    EXPECT_EQ(map.elevation_deg(16, 10, 12), 0);
}

TEST(Horizon, TowardsALampLiesBetweenItsNeighbours) {
    HorizonMap map{3, 2, std::vector<std::uint8_t>(16 * 6)};
    for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] = static_cast<std::uint8_t>(37 * i);
    std::vector<std::uint16_t> roots(6);
    for (const auto& [azimuth_deg, first, part] :
         {std::tuple(0.0, 0, 0.0), {22.5, 1, 0.0}, {33.75, 1, 0.5}, {-11.25, 15, 0.5}, {725.625, 0, 0.25}}) {
        horizon_towards(map, azimuth_deg, roots);
        for (std::size_t i = 0; i < 6; ++i) {
            const double a = map.values[static_cast<std::size_t>(first) * 6 + i];
            const double b = map.values[static_cast<std::size_t>((first + 1) % 16) * 6 + i];
            EXPECT_NEAR(roots[i] / 257.0, a + part * (b - a), 0.51) << azimuth_deg;
            if (part == 0) {
                EXPECT_EQ(roots[i], 257 * map.values[static_cast<std::size_t>(first) * 6 + i]);
            }
        }
    }
}

TEST(Horizon, CoarseHeightsAreMeans) {
    Image<float> z(2000, 10);
    for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 2000; ++x) z(x, y) = static_cast<float>(x);
    const CoarseHeights coarse = coarse_heights(z, 0.1);
    EXPECT_EQ(coarse.height_mm.width(), 1000);
    EXPECT_EQ(coarse.height_mm.height(), 5);
    EXPECT_DOUBLE_EQ(coarse.mm_per_texel, 0.2);
    EXPECT_FLOAT_EQ(coarse.height_mm(7, 3), 14.5f);
    EXPECT_EQ(coarse_heights(z, 0.1, 4000).height_mm.width(), 2000);
}

TEST(Horizon, CanBeStopped) {
    EXPECT_THROW(horizon_map({Image<float>(20, 16), 1}, [](auto, double) { return false; }), Cancelled);
}

}  // namespace
}  // namespace tangi
