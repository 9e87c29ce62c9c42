// oren_nayar_test.cpp: the laws that rough diffuse reflection obeys.
#include "surface/reflectance/oren_nayar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "surface/reflectance/ward.h"
#include "tests/support/surface/reflectance_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr double kRoughnesses[] = {0, 0.1, 0.3, 0.6, 1};

TEST(RoughDiffuse, IsLambertsLawWhereItIsNotRough) {
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        const double n_l = random.uniform(0.01, 1), n_v = random.uniform(0.01, 1);
        const DiffuseTerms<double> t = rough_diffuse(n_l, n_v, random.uniform(-1, 1), 0.0);
        EXPECT_EQ(t.value, n_l);
        EXPECT_EQ(t.by_n_l, 1);
        EXPECT_EQ(t.by_n_v, 0);
    }
}

TEST(RoughDiffuse, IsReciprocal) {
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 l(random.direction(0.01)), v(random.direction(0.01));
        for (const double sigma : kRoughnesses)  // f n.l n.v, either way round
            EXPECT_NEAR(rough_diffuse(l.z, v.z, glm::dot(l, v), sigma).value * v.z,
                        rough_diffuse(v.z, l.z, glm::dot(l, v), sigma).value * l.z, 1e-6);
    }
}

// The midpoint rule over the hemisphere of l; its error is O(1 / n^2).
TEST(RoughDiffuse, ReflectsNoMoreThanItReceivesAndIsNeverNegative) {
    constexpr int n = 200;
    for (const double sigma : kRoughnesses)
        for (double theta_v = 0; theta_v < 89; theta_v += 11) {
            const glm::dvec3 v = direction(theta_v * kPi / 180, 0);
            double albedo = 0;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const double theta = kPi / 2 * (i + 0.5) / n;
                    const glm::dvec3 l = direction(theta, kPi * (j + 0.5) / n);
                    const double value = rough_diffuse(l.z, v.z, glm::dot(l, v), sigma).value;
                    ASSERT_GE(value, 0);
                    albedo += value / kPi * std::sin(theta) * (kPi / 2 / n) * (2 * kPi / n);
                }
            EXPECT_LE(albedo, 1 + 1e-4) << "sigma " << sigma << ", viewed from " << theta_v;
            EXPECT_GE(albedo, 0.6) << "sigma " << sigma << ", viewed from " << theta_v;
        }
}

TEST(RoughDiffuse, IsBrighterTowardsTheLightThanLambertAndDarkerAwayFromIt) {
    const double up = std::cos(1.2);
    const auto relative = [&](double phi) {  // light and camera both 69 degrees from the normal
        const double l_v = glm::dot(direction(1.2, 0), direction(1.2, phi));
        return rough_diffuse(up, up, l_v, 0.5).value / rough_diffuse(up, 1.0, up, 0.5).value;
    };
    EXPECT_GT(relative(0), 1.3);
    EXPECT_LT(relative(kPi), 0.7);
}

TEST(RoughDiffuse, DerivativesAreThoseOfCentralDifferences) {
    Random random(3);
    constexpr double h = 1e-6;
    int same_side = 0;
    for (int i = 0; i < 1000; ++i) {
        const double n_l = random.uniform(0.1, 1), n_v = random.uniform(0.1, 1),
                     l_v = random.uniform(-0.9, 1);
        const double sigma = random.uniform(0, 1);
        if (std::abs(n_l - n_v) < 1e-3 || std::abs(l_v - n_l * n_v) < 1e-3) continue;  // the kinks
        same_side += l_v > n_l * n_v;
        const DiffuseTerms<double> t = rough_diffuse(n_l, n_v, l_v, sigma);
        const auto value = [&](double a, double b) { return rough_diffuse(a, b, l_v, sigma).value; };
        EXPECT_NEAR(t.by_n_l, (value(n_l + h, n_v) - value(n_l - h, n_v)) / (2 * h), 1e-6);
        EXPECT_NEAR(t.by_n_v, (value(n_l, n_v + h) - value(n_l, n_v - h)) / (2 * h), 1e-6);
        const auto of = [&](double c, double rough) { return rough_diffuse(n_l, n_v, c, rough).value; };
        EXPECT_NEAR(t.by_l_v, (of(l_v + h, sigma) - of(l_v - h, sigma)) / (2 * h), 1e-6);
        EXPECT_NEAR(t.by_sigma, (of(l_v, sigma + h) - of(l_v, sigma - h)) / (2 * h), 1e-6);
    }
    EXPECT_GT(same_side, 100);
    EXPECT_LT(same_side, 900);
}

TEST(SecondLobe, IsTheLobeWithoutItAndTheWiderOneWithNothingElse) {
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const glm::dvec3 l(random.direction(0.1)), v(random.direction(0.1)), h = l + v;
        const WardAngles<double> a{l.z, v.z, h.z, glm::dot(h, h)};
        const double alpha = random.uniform(0.05, 0.4);
        for (const auto& [model, name, label] : kWardModels) {
            const double core = ward_lobe(model, a, alpha),
                         wide = ward_lobe(model, a, kSecondLobeWidth * alpha);
            EXPECT_EQ(hazy_lobe(model, a, alpha, 0.0), core);
            EXPECT_DOUBLE_EQ(hazy_lobe(model, a, alpha, 1.0), wide);
            // A mixture: what bounds both bounds it, so its albedo is at most 1 as theirs is.
            EXPECT_NEAR(hazy_lobe(model, a, alpha, 0.4), 0.6 * core + 0.4 * wide, 1e-12 * (core + wide));
        }
    }
}

}  // namespace
}  // namespace tangi
