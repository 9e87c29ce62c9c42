// portable_math_test.cpp: own elementary functions are close to the C library's, and have the same bits
// everywhere.
#include "surface/math/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>

#include "surface/base/noise.h"

namespace tangi {
namespace {

using procedural::hash;
using procedural::uniform;

double drawn(int i, double low, double high) {
    return low + (high - low) * static_cast<double>(hash(7, static_cast<std::uint64_t>(i)) >> 11) * 0x1p-53;
}

constexpr double kUlp = std::numeric_limits<double>::epsilon();
constexpr int kDraws = 20000;

void expect_close(double ours, double theirs, double ulps, double at) {
    EXPECT_LE(std::abs(ours - theirs), ulps * kUlp * std::abs(theirs)) << "at " << at;
}

TEST(PortableMath, ExponentialsAndLogarithmsAreTheLibrarysToRounding) {
    for (int i = 0; i < kDraws; ++i) {
        const double x = drawn(i, -700, 700), small = drawn(i, -1, 1), size = std::exp(x);
        expect_close(portable::exp(x), size, 4, x);
        expect_close(portable::expm1(small), std::expm1(small), 6, small);
        if (std::abs(x) > 1e-3) expect_close(portable::log(size), std::log(size), 4, size);
        expect_close(portable::log1p(small), std::log1p(small), 6, small);
        expect_close(portable::cbrt(size), std::cbrt(size), 4, size);
        const double base = drawn(i, 0, 4), power = drawn(i + kDraws, 0.1, 20);
        expect_close(portable::pow(base, power), std::pow(base, power), 80, base);
    }
}

TEST(PortableMath, AnglesAreTheLibrarysToRounding) {
    for (int i = 0; i < kDraws; ++i) {
        const double x = drawn(i, -1000, 1000), y = drawn(i + kDraws, -1000, 1000);
        EXPECT_NEAR(portable::sin(x), std::sin(x), 4 * kUlp) << x;
        EXPECT_NEAR(portable::cos(x), std::cos(x), 4 * kUlp) << x;
        expect_close(portable::atan2(y, x), std::atan2(y, x), 4, y / x);
        expect_close(portable::hypot(x, y), std::hypot(x, y), 4, y / x);
    }
}

TEST(PortableMath, EndsAreThoseOfIeee754) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(portable::exp(0.0), 1);
    EXPECT_EQ(portable::exp(-1000.0), 0);
    EXPECT_EQ(portable::exp(1000.0), infinity);
    EXPECT_GT(portable::exp(-744.0), 0);  // no normal number
    EXPECT_EQ(portable::log(1.0), 0);
    EXPECT_EQ(portable::log(0.0), -infinity);
    EXPECT_TRUE(std::isnan(portable::log(-1.0)));
    EXPECT_NEAR(portable::log(5e-324), std::log(5e-324), 1e-12);
    EXPECT_EQ(portable::pow(0.0, 3.0), 0);
    EXPECT_EQ(portable::pow(0.3, 1.0), 0.3);
    EXPECT_EQ(portable::pow(0.0, 0.0), 1);
    EXPECT_EQ(portable::cbrt(-27.0), -3);
    EXPECT_EQ(portable::atan2(0.0, 1.0), 0);
    EXPECT_EQ(portable::atan2(0.0, -1.0), std::numbers::pi);
    EXPECT_EQ(portable::atan2(-1.0, 0.0), -std::numbers::pi / 2);
}

// What any build must give: FNV-1a of the results' bits.
TEST(PortableMath, BitsAreTheSameOnEveryProcessor) {
    std::uint64_t sum = 0xcbf29ce484222325;
    const auto take = [&](double value) {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        sum = (sum ^ bits) * 0x100000001b3;
    };
    for (int i = 0; i < 2000; ++i) {
        const double x = drawn(i, -50, 50), y = drawn(i + 2000, -50, 50), size = drawn(i + 4000, 0, 9);
        for (const double value :
             {portable::exp(x), portable::log(size), portable::log1p(size), portable::expm1(x),
              portable::pow(size, y), portable::cbrt(x), portable::sin(x), portable::cos(x),
              portable::atan2(y, x), portable::hypot(x, y)})
            take(value);
    }
    EXPECT_EQ(sum, 12899966748796060709u);
}

}  // namespace
}  // namespace tangi
