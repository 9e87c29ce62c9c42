// ggx_test.cpp: the laws of a physically plausible lobe.
#include "datasets/ggx.h"

#include <gtest/gtest.h>

#include "surface/reflectance/ward.h"

namespace tangi {
namespace {

constexpr Vec3 kUp{0, 0, 1};

Vec3 at_angle(double from_normal, double azimuth) {
    return {static_cast<float>(std::sin(from_normal) * std::cos(azimuth)),
            static_cast<float>(std::sin(from_normal) * std::sin(azimuth)),
            static_cast<float>(std::cos(from_normal))};
}

// Integral over the hemisphere, by the midpoint rule in angle from the normal and azimuth.
template <class Function>
double over_hemisphere(Function&& f) {
    constexpr int rings = 400, sectors = 400;
    constexpr double pi = std::numbers::pi;
    double sum = 0;
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) {
            const double angle = (i + 0.5) * pi / 2 / rings;
            sum += f(at_angle(angle, (j + 0.5) * 2 * pi / sectors)) * std::sin(angle);
        }
    return sum * (pi / 2 / rings) * (2 * pi / sectors);
}

TEST(Ggx, MicrofacetsCoverTheSurfaceExactlyOnce) {
    for (const float alpha : {0.1f, 0.3f, 0.6f, 1.0f}) {
        const double covered =
            over_hemisphere([&](const Vec3& h) { return ggx_distribution(h.z, alpha) * h.z; });
        EXPECT_NEAR(covered, 1, 2e-3) << "alpha " << alpha;
    }
}

double albedo(float alpha, const Vec3& view) {
    return over_hemisphere([&](const Vec3& light) { return ggx_lobe(1, alpha, kUp, light, view) * light.z; });
}

// White furnace: without Fresnel losses (F0 = 1) one bounce reflects at most what arrives.
TEST(Ggx, ReflectsAtMostTheLightThatArrives) {
    for (const float alpha : {0.1f, 0.3f, 0.6f, 1.0f})
        for (const double angle : {0.0, 0.5, 1.0, 1.4})
            EXPECT_LE(albedo(alpha, at_angle(angle, 0.3)), 1 + 2e-3)
                << "alpha " << alpha << ", angle " << angle;
}

// Smooth surfaces lose next to nothing. At alpha = 1 the lobe is 1 / (2 pi (n.l + n.v)), so from the front
// the albedo is the integral of m / (1 + m) over 0..1: the rest bounces more than once.
TEST(Ggx, LosesWhatBouncesTwice) {
    EXPECT_GT(albedo(0.1f, kUp), 0.98);
    EXPECT_NEAR(albedo(1, kUp), 1 - std::log(2.0), 1e-3);
}

TEST(Ggx, IsReciprocal) {
    const Vec3 n = glm::normalize(Vec3(0.2f, -0.1f, 1));
    for (int i = 0; i < 100; ++i) {
        const Vec3 l = at_angle(0.013 * i, 1.7 * i), v = at_angle(1.3 - 0.012 * i, 0.9 * i);
        const float there = ggx_lobe(0.04f, 0.3f, n, l, v), back = ggx_lobe(0.04f, 0.3f, n, v, l);
        EXPECT_NEAR(there, back, 1e-5f * (1 + there));
    }
}

TEST(Ggx, IsDarkBelowTheHorizon) {
    EXPECT_EQ(ggx_lobe(0.04f, 0.3f, kUp, Vec3(1, 0, 0), kUp), 0);
    EXPECT_EQ(ggx_lobe(0.04f, 0.3f, kUp, Vec3(0.6f, 0, -0.8f), kUp), 0);
}

TEST(Ggx, HasThePeakOfTheWardLobeWithTheSameNumbers) {
    for (const float alpha : {0.05f, 0.2f, 0.6f}) {
        const float ward = 0.04f * ward_lobe(WardModel::bounded, ward_angles(kUp, kUp, kUp), alpha);
        EXPECT_NEAR(ggx_lobe(0.04f, alpha, kUp, kUp, kUp) / ward, 1, 1e-4) << "alpha " << alpha;
    }
}

TEST(Ggx, FresnelRisesFromF0ToOne) {
    EXPECT_FLOAT_EQ(schlick_fresnel(0.04f, 1), 0.04f);
    EXPECT_FLOAT_EQ(schlick_fresnel(0.04f, 0), 1);
    EXPECT_LT(schlick_fresnel(0.04f, 0.6f), schlick_fresnel(0.04f, 0.5f));
}

}  // namespace
}  // namespace tangi
