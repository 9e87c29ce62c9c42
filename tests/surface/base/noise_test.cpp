// noise_test.cpp: hashed randomness has the distributions it promises.
#include "surface/base/noise.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tangi::procedural {
namespace {

TEST(Noise, UniformNumbersFillTheIntervalEvenly) {
    constexpr int count = 100000;
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        const float u = uniform(hash(7, static_cast<std::uint64_t>(i)), -1, 3);
        ASSERT_GE(u, -1);
        ASSERT_LT(u, 3);
        sum += u;
        squares += u * u;
    }
    const double variance = 16.0 / 12, mean = sum / count;
    EXPECT_NEAR(mean, 1, 4 * std::sqrt(variance / count));
    EXPECT_NEAR(squares / count - mean * mean, variance, 0.02);
}

TEST(Noise, NormalNumbersHaveUnitVarianceAndDoNotDependOnEachOther) {
    constexpr int count = 100000;
    double first = 0, second = 0, first2 = 0, second2 = 0, product = 0;
    for (int i = 0; i < count; ++i) {
        const auto [a, b] = normal_pair(hash(3, i % 317, i / 317));
        first += a;
        second += b;
        first2 += a * a;
        second2 += b * b;
        product += a * b;
    }
    const double four_sigma = 4 / std::sqrt(static_cast<double>(count));
    EXPECT_NEAR(first / count, 0, four_sigma);
    EXPECT_NEAR(second / count, 0, four_sigma);
    EXPECT_NEAR(product / count, 0, four_sigma);
    EXPECT_NEAR(first2 / count, 1, std::sqrt(2.0) * four_sigma);
    EXPECT_NEAR(second2 / count, 1, std::sqrt(2.0) * four_sigma);
}

TEST(Noise, GradientNoiseIsZeroOnTheGridBoundedAndSmooth) {
    float largest = 0;
    for (int i = 0; i < 20000; ++i) {
        const float x = uniform(hash(1, i, 0), -50, 50), y = uniform(hash(1, i, 1), -50, 50);
        const float value = noise(x, y, 5);
        largest = std::max(largest, std::abs(value));
        ASSERT_LE(std::abs(noise(x + 1e-3f, y, 5) - value), 5e-3f) << x << ' ' << y;
    }
    EXPECT_LE(largest, 1);
    EXPECT_GT(largest, 0.7f);
    EXPECT_EQ(noise(3, -4, 5), 0);
}

TEST(Noise, EdgeDistanceGrowsNoFasterThanThePathFromTheEdge) {
    float smallest = 1;
    for (int i = 0; i < 20000; ++i) {
        const float x = uniform(hash(2, i, 0), -20, 20), y = uniform(hash(2, i, 1), -20, 20);
        const float here = voronoi_edge_distance(x, y, 9), there = voronoi_edge_distance(x + 0.02f, y, 9);
        ASSERT_GE(here, 0);
        ASSERT_LE(here, 1.5f);
        ASSERT_LE(std::abs(here - there), 0.0201f) << x << ' ' << y;
        smallest = std::min(smallest, here);
    }
    EXPECT_LT(smallest, 0.002f);
}

}  // namespace
}  // namespace tangi::procedural
