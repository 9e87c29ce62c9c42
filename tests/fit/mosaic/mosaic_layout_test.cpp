// mosaic_layout_test.cpp: homographies of positions are recovered from ties, with loops closed.
#include "fit/mosaic/mosaic_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "surface/base/error.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using glm::dvec2;

constexpr int kSide = 400;  // [pixels] of a position

MosaicPosition blank(const std::string& name) {
    MosaicPosition position;
    position.name = name;
    position.width = position.height = kSide;
    return position;
}

// Two rows of three, 280 pixels apart, each turned and tilted a little.
struct Wall {
    std::vector<MosaicPosition> positions;
    std::vector<Homography> to_wall;
    std::vector<PairRegistration> pairs;
};

Wall wall_of(double noise_px, std::uint64_t seed) {
    Wall wall;
    Random random(seed);
    for (int i = 0; i < 6; ++i) {
        wall.positions.push_back(blank(std::to_string(i)));
        const double turn = i == 0 ? 0 : random.real(-0.02, 0.02),
                     zoom = i == 0 ? 1 : random.real(0.99, 1.01);
        const double c = zoom * std::cos(turn), s = zoom * std::sin(turn);
        const double px = i == 0 ? 0 : random.real(-1e-5, 1e-5), py = i == 0 ? 0 : random.real(-1e-5, 1e-5);
        wall.to_wall.emplace_back(c, s, px, -s, c, py, 280.0 * (i % 3), 280.0 * (i / 3), 1);
    }
    for (std::size_t b = 0; b < 6; ++b)
        for (std::size_t a = 0; a < b; ++a) {
            PairRegistration pair;
            pair.first = a, pair.second = b;
            pair.to_second = glm::inverse(wall.to_wall[b]) * wall.to_wall[a];
            for (int y = 20; y < kSide; y += 40)
                for (int x = 20; x < kSide; x += 40) {
                    const dvec2 to = mapped(pair.to_second, dvec2(x, y));
                    if (to.x < 0 || to.y < 0 || to.x >= kSide || to.y >= kSide) continue;
                    pair.ties.push_back({dvec2(x, y), to + noise_px * dvec2(random.normal(), random.normal()),
                                         std::max(noise_px, 0.01), 1});
                }
            if (pair.ties.size() < 4) pair.why = "apart";
            wall.pairs.push_back(pair);
        }
    return wall;
}

double error_of(const MosaicLayout& layout, const Wall& wall, std::size_t i) {
    const Homography shift = layout.positions[0].to_wall;  // the wall begins elsewhere
    double sum = 0, count = 0;
    for (int y = 0; y < kSide; y += 57)
        for (int x = 0; x < kSide; x += 57) {
            const dvec2 off = mapped(layout.positions[i].to_wall, dvec2(x, y)) -
                              mapped(shift * wall.to_wall[i], dvec2(x, y));
            sum += glm::dot(off, off), ++count;
        }
    return std::sqrt(sum / count);
}

TEST(MosaicLayouts, AreRecoveredFromTies) {
    const Wall wall = wall_of(0, 1);
    const MosaicLayout layout = solve_layout(wall.positions, wall.pairs, 0);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_TRUE(layout.positions[i].joined);
        EXPECT_LT(error_of(layout, wall, i), 0.01) << i;
    }
    EXPECT_LT(layout.rms_px, 0.01);
    EXPECT_NEAR(layout.width, 960, 20);
    EXPECT_NEAR(layout.height, 680, 20);
}

TEST(MosaicLayouts, KnowTheirErrors) {
    double ratio = 0;
    constexpr int kWalls = 6;
    for (std::uint64_t seed = 1; seed <= kWalls; ++seed) {
        const Wall wall = wall_of(0.2, seed);
        const MosaicLayout layout = solve_layout(wall.positions, wall.pairs, 0);
        EXPECT_EQ(layout.positions[0].sigma_px, 0);
        for (std::size_t i = 1; i < 6; ++i) {
            EXPECT_LT(error_of(layout, wall, i), 4 * layout.positions[i].sigma_px) << i;
            ratio += std::pow(error_of(layout, wall, i) / layout.positions[i].sigma_px, 2) / (5 * kWalls);
        }
        // Two coordinates, of the noise of one end.
        EXPECT_NEAR(layout.rms_px, 0.2 * std::sqrt(2), 0.05);
    }
    EXPECT_GT(std::sqrt(ratio), 0.4);
    EXPECT_LT(std::sqrt(ratio), 2);
}

TEST(MosaicLayouts, ForgetTiesThatAreWrong) {
    Wall wall = wall_of(0.05, 3);
    for (PairRegistration& pair : wall.pairs)
        for (std::size_t k = 0; k < pair.ties.size(); k += 7) pair.ties[k].second += dvec2(6, -4);
    const MosaicLayout layout = solve_layout(wall.positions, wall.pairs, 0);
    const Wall clean = wall_of(0.05, 3);
    const MosaicLayout without = solve_layout(clean.positions, clean.pairs, 0);
    for (std::size_t i = 1; i < 6; ++i)
        EXPECT_LT(error_of(layout, wall, i), 0.1 + 2 * error_of(without, clean, i)) << i;
}

TEST(MosaicLayouts, LeaveOutWhatNoPairLeadsTo) {
    Wall wall = wall_of(0, 1);
    for (PairRegistration& pair : wall.pairs)
        if (pair.second == 5) pair.why = "nothing of one is found in the other";
    const MosaicLayout layout = solve_layout(wall.positions, wall.pairs, 0);
    EXPECT_FALSE(layout.positions[5].joined);
    EXPECT_TRUE(layout.positions[4].joined);
}

TEST(MosaicLayouts, SayHowPositionsAreTurned) {
    Wall wall = wall_of(0, 1);
    const MosaicLayout layout = solve_layout(wall.positions, wall.pairs, 0);
    for (std::size_t i = 1; i < 6; ++i) {
        // x of the position goes down on the wall where it is turned clockwise, which is below 0. Perspective
        // turns both axes, each by its own.
        const dvec2 middle((kSide - 1) / 2.0);
        const auto along = [&](const dvec2& step) {
            return mapped(wall.to_wall[i], middle + step) - mapped(wall.to_wall[i], middle);
        };
        const dvec2 x = along({1, 0}), y = along({0, 1});
        const double turn = (std::atan2(x.y, x.x) + std::atan2(-y.x, y.y)) / 2;
        EXPECT_NEAR(layout.positions[i].turn_rad, -turn, 0.001) << i;
        EXPECT_NEAR(layout.positions[i].pixel, std::sqrt(x.x * y.y - x.y * y.x), 0.001) << i;
    }
}

TEST(MosaicLayouts, RefuseAWallThatGoesAstray) {
    Wall wall = wall_of(0, 1);
    wall.positions.resize(2), wall.pairs.resize(1);
    for (TiePoint& tie : wall.pairs[0].ties) tie.second *= 1e-4;
    wall.pairs[0].to_second = Homography(1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1);
    EXPECT_THROW(solve_layout(wall.positions, wall.pairs, 0), Error);
}

}  // namespace
}  // namespace tangi
