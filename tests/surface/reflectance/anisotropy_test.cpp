// anisotropy_test.cpp: lobes that are anisotropic: no light is made, both ways are alike, stretches are
// told in one way only, and stretch 0 is the isotropic lobe.
#include "surface/reflectance/anisotropy.h"

#include <gtest/gtest.h>

#include <numbers>

#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr float kFloatPi = std::numbers::pi_v<float>;

struct Brushed {
    float alpha = 0.2f;
    Stretch stretch{0};

    float lobe(const Vec3& n, const Vec3& l, const Vec3& v, float second_lobe_weight = 0,
               WardModel model = WardModel::bounded) const {
        return anisotropic_lobe(model, ward_angles(n, l, v), n, l + v,
                                {alpha, axes_of(stretch, alpha), second_lobe_weight});
    }
};

Stretch random_stretch(Random& random, double most = 1) {
    const double s = random.uniform(0, most), angle = random.uniform(0, 2 * std::numbers::pi);
    return {static_cast<float>(s * std::cos(angle)), static_cast<float>(s * std::sin(angle))};
}

TEST(Anisotropy, StretchesAreToldInOneWayOnly) {
    Random random(1);
    for (int i = 0; i < 500; ++i) {
        const Stretch stretch = random_stretch(random);
        const auto alpha = static_cast<float>(random.uniform(0.03, 0.7));
        const LobeAxes axes = axes_of(stretch, alpha);
        EXPECT_LE(axes.roughness_v, alpha);
        EXPECT_LE(std::abs(axes.tangent), kFloatPi / 2 + 1e-6f);
        EXPECT_LT(glm::length(stretch_of(axes, alpha) - stretch), 2e-6f);
        // The same lobe, told by the other axis.
        const LobeAxes other{alpha * alpha / axes.roughness_v, axes.tangent + kFloatPi / 2};
        EXPECT_LT(glm::length(stretch_of(other, alpha) - stretch), 3e-6f);
    }
    EXPECT_EQ(axes_of(Stretch(0), 0.3f), (LobeAxes{0.3f, 0}));
    EXPECT_EQ(stretch_of(LobeAxes{0.3f, 1}, 0.3f), Stretch(0)) << "whatever its tangent";
}

TEST(Anisotropy, WithoutStretchTheLobeIsTheIsotropicOne) {
    Random random(2);
    for (int i = 0; i < 500; ++i) {
        const Vec3 n = random.direction(0.2), l = random.direction(0.05), v = random.direction(0.3);
        const Brushed plain{static_cast<float>(random.uniform(0.15, 0.7)), Stretch(0)};
        for (const auto& [model, name, label] : kWardModels) {
            const float is = hazy_lobe(model, ward_angles(n, l, v), plain.alpha, 0.3f);
            EXPECT_NEAR(plain.lobe(n, l, v, 0.3f, model), is, 2e-4f * is + 1e-6f);
        }
    }
}

TEST(Anisotropy, IsReciprocal) {
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const Vec3 n = random.direction(0.2), l = random.direction(0.05), v = random.direction(0.05);
        const Brushed brushed{0.3f, random_stretch(random)};
        const float there = brushed.lobe(n, l, v);
        EXPECT_NEAR(brushed.lobe(n, v, l), there, 1e-4f * there + 1e-9f);
    }
}

// The part of the light from v that the lobe sends anywhere: over half vectors that have the density of its
// own Gaussian, as ward_test.cpp does for isotropic ones.
double albedo(const Brushed& brushed, const Vec3& n, const Vec3& v, int count = 160) {
    const LobeAxes axes = axes_of(brushed.stretch, brushed.alpha);
    const float across = axes.roughness_v, along = brushed.alpha * brushed.alpha / across;
    // e1, e2 by their definition.
    const auto e = [&](const Vec3& axis) {
        return axis - glm::dot(axis, n) / (1 + n.z) * (n + Vec3(0, 0, 1));
    };
    const Vec3 e1 = e({1, 0, 0}), e2 = e({0, 1, 0});
    const Vec3 t = std::cos(axes.tangent) * e1 + std::sin(axes.tangent) * e2, b = glm::cross(n, t);
    double sum = 0;
    for (int i = 0; i < count; ++i)
        for (int j = 0; j < count; ++j) {
            const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
            const float angle = 2 * kFloatPi * (static_cast<float>(j) + 0.5f) / static_cast<float>(count);
            const float r = std::sqrt(-std::log(u));
            const float x = along * r * std::cos(angle), y = across * r * std::sin(angle);
            const Vec3 h = glm::normalize(x * t + y * b + n);
            const float v_h = glm::dot(v, h), h_n = glm::dot(h, n);
            const Vec3 l = 2 * v_h * h - v;
            if (v_h <= 0 || glm::dot(l, n) <= 0) continue;
            const double density = u / (kFloatPi * along * across * h_n * h_n * h_n);
            sum += brushed.lobe(n, l, v) * glm::dot(l, n) * 4 * v_h / density;
        }
    return sum / (count * count);
}

TEST(Anisotropy, NeverReflectsMoreThanItReceives) {
    Random random(4);
    for (int i = 0; i < 30; ++i) {
        const Brushed brushed{static_cast<float>(random.uniform(0.05, 0.6)), random_stretch(random)};
        const Vec3 n = random.direction(0.5);
        const Vec3 v = random.direction(0.02);
        if (glm::dot(n, v) < 0.02f) continue;
        EXPECT_LE(albedo(brushed, n, v), 1.02) << brushed.alpha << " " << glm::length(brushed.stretch);
    }
    // Narrow lobes at normal incidence reflect all of it.
    EXPECT_NEAR(albedo({0.03f, {0.6f, 0.3f}}, {0, 0, 1}, {0, 0, 1}), 1, 0.02);
}

// The exponent that the fit and the shaders take is that of Ward's two widths.
TEST(Anisotropy, TheMatrixIsThatOfTheTwoWidths) {
    Random random(5);
    for (int i = 0; i < 300; ++i) {
        const Vec3 n = random.direction(0.3), l = random.direction(0.1), v(0, 0, 1);
        if (glm::dot(n, l) <= 0.05f) continue;
        const Brushed brushed{static_cast<float>(random.uniform(0.15, 0.6)), random_stretch(random)};
        WardAngles<float> angles = ward_angles(n, l, v);
        add_axes(n, l + v, 0, angles);
        EXPECT_NEAR(angles.h_t * angles.h_t + angles.h_b * angles.h_b + angles.h_n * angles.h_n, angles.h_h,
                    1e-5);
        const StretchShape<double> shape = shape_of<double>(brushed.stretch.x, brushed.stretch.y);
        const double x = angles.h_t / angles.h_n, y = angles.h_b / angles.h_n;
        const double tan2 = shape.c * (x * x + y * y) - shape.a * (x * x - y * y) - 2 * shape.b * x * y;
        const double h_n2 = angles.h_n * angles.h_n, alpha2 = brushed.alpha * brushed.alpha;
        const double expected =
            std::exp(-tan2 / alpha2) / (std::numbers::pi * alpha2) * angles.h_h / (h_n2 * h_n2);
        EXPECT_NEAR(brushed.lobe(n, l, v), expected, 2e-4 * expected + 1e-6);
    }
}

TEST(Anisotropy, IsWideAlongItsTangentWhenRelit) {
    Surface s(1, 1);
    s.specular(0, 0) = 0.2f;
    s.roughness(0, 0) = 0.2f;
    s.lobe_axes = Image<LobeAxes>(1, 1, axes_of({0.6f, 0}, 0.2f));  // along x
    const auto shine = [&](const Vec3& to) {
        const Light light = distant_light(to);
        return relight(s, {&light, 1})(0, 0).g;
    };
    EXPECT_GT(shine({0.5f, 0, 1}), 5 * shine({0, 0.5f, 1}));
    s.lobe_axes(0, 0).tangent = kFloatPi / 4;
    EXPECT_GT(shine({0.35f, 0.35f, 1}), 5 * shine({0.35f, -0.35f, 1}));
    s.lobe_axes = {};
    EXPECT_FLOAT_EQ(shine({0.5f, 0, 1}), shine({0, 0.5f, 1}));
}

}  // namespace
}  // namespace tangi
