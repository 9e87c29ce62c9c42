// ward_bounds_test.cpp: the robust loss of a pixel's residuals and the bounds of its parameters.
#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fit/pixel/ward_residual.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(RootCauchy, IsTheIdentityAtZero) {
    for (const double c : {0.5, 3.0, 100.0}) {
        EXPECT_EQ(root_cauchy(0, c).value, 0);
        EXPECT_EQ(root_cauchy(0, c).derivative, 1);
        // r (1 - s / 4) and 1 - 3 s / 4 for small s = r^2 / c^2; next terms are O(s^2).
        const double r = 1e-3 * c, s = 1e-6;
        EXPECT_NEAR(root_cauchy(r, c).value, r * (1 - s / 4), 1e-11 * c);
        EXPECT_NEAR(root_cauchy(r, c).derivative, 1 - 0.75 * s, 1e-11);
    }
}

TEST(RootCauchy, SquaredIsCeresCauchyLoss) {
    for (const double c : {0.5, 3.0, 100.0}) {
        const ceres::CauchyLoss loss(c);
        for (double r = 1e-9; r < 1e12; r *= 3) {
            double rho[3];
            loss.Evaluate(r * r, rho);
            for (const double signed_r : {r, -r}) {
                const RobustValue value = root_cauchy(signed_r, c);
                // Below s = 1e-8 the series is cut after its first term: 5e-9 relative in the square, 7.5e-9
                // in the slope.
                // Ceres' ln(1 + s) is off by the rounding of 1 + s.
                EXPECT_NEAR(value.value * value.value, rho[0], 1e-8 * rho[0] + 3e-16 * c * c) << r;
                EXPECT_NEAR(value.value * value.derivative, signed_r * rho[1], 1e-8 * r * rho[1]) << r;
                EXPECT_EQ(value.value < 0, signed_r < 0);
            }
        }
    }
}

TEST(RootCauchy, DerivativeIsThatOfTheValueAndItGrowsWithTheResidual) {
    constexpr double c = 3;
    double before = -std::numeric_limits<double>::infinity();
    for (double r = -300; r <= 300; r += 0.37) {
        const double h = 1e-5,
                     numeric = (root_cauchy(r + h, c).value - root_cauchy(r - h, c).value) / (2 * h);
        EXPECT_NEAR(root_cauchy(r, c).derivative, numeric, 1e-8) << r;  // h^2 / 6 and 1e-15 / h
        EXPECT_GT(root_cauchy(r, c).value, before) << r;
        before = root_cauchy(r, c).value;
    }
    // Across the place where the series takes over.
    const double edge = 1e-4 * c;
    EXPECT_NEAR(root_cauchy(edge * (1 - 1e-9), c).value, root_cauchy(edge * (1 + 1e-9), c).value,
                1e-8 * edge);
}

TEST(Bounds, HoldForEveryUnboundedNumber) {
    Random random(9);
    const WardBounds bounds;
    for (int trial = 0; trial < 2000; ++trial) {
        WardVector u{};
        for (double& value : u) value = random.uniform(-1, 1) * std::pow(10, random.uniform(-3, 6));
        const WardVector theta = natural_of(u.data(), bounds, nullptr);
        for (int i = 0; i < kWardParameters; ++i) {
            const auto [low, high] = ward_interval(bounds, i);
            EXPECT_GE(theta[static_cast<std::size_t>(i)], low - 1e-12);
            EXPECT_LE(theta[static_cast<std::size_t>(i)], high + 1e-12);
        }
    }
}

TEST(Bounds, RoundTripGivesTheParametersBack) {
    Random random(10);
    const WardBounds bounds;
    for (int trial = 0; trial < 200; ++trial) {
        WardVector theta;
        for (int i = 0; i < kWardParameters; ++i) {
            const auto [low, high] = ward_interval(bounds, i);
            theta[static_cast<std::size_t>(i)] = low + (high - low) * random.uniform(0.005, 0.995);
        }
        const WardVector back = natural_of(unbounded_of(theta, bounds).data(), bounds, nullptr);
        for (std::size_t i = 0; i < kWardParameters; ++i)
            EXPECT_NEAR(back[i], theta[i], 1e-12) << i;  // sin(asin(t)) at |t| <= 0.9995
    }
}

TEST(Bounds, StartsAtOrBeyondABoundMoveJustInsideWhereTheyCanStillMove) {
    const WardBounds bounds;
    for (const double beyond : {0.0, 0.5}) {
        for (const bool upper : {false, true}) {
            WardVector theta{};
            for (int i = 0; i < kWardParameters; ++i) {
                const auto [low, high] = ward_interval(bounds, i);
                theta[static_cast<std::size_t>(i)] = upper ? high + beyond : low - beyond;
            }
            const WardVector u = unbounded_of(theta, bounds);
            double derivative[kWardParameters];
            const WardVector inside = natural_of(u.data(), bounds, derivative);
            for (int i = 0; i < kWardParameters; ++i) {
                const auto [low, high] = ward_interval(bounds, i);
                const auto at = static_cast<std::size_t>(i);
                EXPECT_GT(inside[at], low);
                EXPECT_LT(inside[at], high);
                EXPECT_LT(std::abs(inside[at] - (upper ? high : low)), 1e-3 * (high - low));
                EXPECT_GT(derivative[i], 0.01 * (high - low));
            }
        }
    }
}

TEST(Bounds, DerivativeIsThatOfTheNaturalParameters) {
    Random random(11);
    const WardBounds bounds;
    for (int trial = 0; trial < 100; ++trial) {
        WardVector u{};
        for (double& value : u) value = random.uniform(-3, 3);
        double derivative[kWardParameters];
        natural_of(u.data(), bounds, derivative);
        for (std::size_t i = 0; i < kWardParameters; ++i) {
            const double h = 1e-6;
            WardVector up = u, down = u;
            up[i] += h;
            down[i] -= h;
            const double numeric =
                (natural_of(up.data(), bounds, nullptr)[i] - natural_of(down.data(), bounds, nullptr)[i]) /
                (2 * h);
            EXPECT_NEAR(derivative[i], numeric, 1e-8);  // rounding 6 * 1e-16 / h
        }
    }
}

}  // namespace
}  // namespace tangi
