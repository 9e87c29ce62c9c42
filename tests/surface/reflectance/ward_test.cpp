// ward_test.cpp: the laws that the Ward lobes obey: energy, reciprocity, symmetry, finite numbers.
#include "surface/reflectance/ward.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <numbers>
#include <sstream>

#include "tests/support/surface/reflectance_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using DVec3 = glm::dvec3;

// Angles in the frame of the surface itself: n = z, tangent = x, bitangent = y.
WardAngles<double> angles_between(const DVec3& l, const DVec3& v) {
    const DVec3 h = l + v;
    return {l.z, v.z, h.z, glm::dot(h, h), h.x, h.y};
}

// Part of the light from `theta_v` that the lobe sends anywhere: the integral of lobe cos(theta_l) over the
// hemisphere, by the midpoint rule in the half vector's slope, tan(delta) = alpha sqrt(1 / u - 1), which also
// covers lobes of longer tails (Trowbridge & Reitz 1975, whose own samples these are). The only kink is the
// horizon of l: N points per axis leave an error of order 1/N.
double albedo(WardModel model, double theta_v, double alpha, int n = 400) {
    const DVec3 v = direction(theta_v, 0);
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double u = (i + 0.5) / n, tangent = alpha * std::sqrt(1 / u - 1);
        for (int j = 0; j < n; ++j) {
            const DVec3 h = direction(std::atan(tangent), kPi * (j + 0.5) / n);  // half the circle: symmetric
            const double v_h = glm::dot(v, h);
            const DVec3 l = 2 * v_h * h - v;
            if (v_h <= 0 || l.z <= 0) continue;
            const double density = u * u / (kPi * alpha * alpha * h.z * h.z * h.z);  // of h per solid angle
            sum += ward_lobe(model, angles_between(l, v), alpha) * l.z * 4 * v_h / density;
        }
    }
    return sum / (n * n);
}

constexpr double kAlphas[] = {0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0};
constexpr double kIncidencesDeg[] = {0, 10, 30, 45, 60, 70, 75, 80, 85, 88, 89, 89.9};
constexpr double kQuadrature = 5e-3;  // twice the kink's 1/N

TEST(WardLobe, BoundedNeverReflectsMoreThanItReceives) {
    for (const double alpha : kAlphas)
        for (const double deg : kIncidencesDeg)
            EXPECT_LE(albedo(WardModel::bounded, deg * kPi / 180, alpha), 1 + kQuadrature)
                << "alpha " << alpha << ", incidence " << deg << " degrees";
}

TEST(WardLobe, Ward1992NeverReflectsMoreThanItReceivesUpTo88Degrees) {
    for (const double alpha : kAlphas)
        for (const double deg : {0, 10, 30, 45, 60, 70, 75, 80, 85, 88})
            EXPECT_LE(albedo(WardModel::ward1992, deg * kPi / 180, alpha), 1 + kQuadrature)
                << "alpha " << alpha << ", incidence " << deg << " degrees";
    // Beyond, its 1 / sqrt(cos) wins for rough surfaces: it is not bounded either, though it needs extremes.
    EXPECT_GT(albedo(WardModel::ward1992, 89.9 * kPi / 180, 0.5), 1.2);
}

TEST(WardLobe, Ward1992DarkensAndDuerExplodesAtGrazingAngles) {
    const double grazing = 88 * kPi / 180;
    EXPECT_LT(albedo(WardModel::ward1992, grazing, 0.2), 0.75);
    EXPECT_GT(albedo(WardModel::duer, grazing, 0.2), 1.5);
    EXPECT_GT(albedo(WardModel::duer, 89.5 * kPi / 180, 0.2), albedo(WardModel::duer, grazing, 0.2));
}

TEST(WardLobe, AllModelsReflectEverythingFromASmoothSurfaceAtNormalIncidence) {
    // To second order in alpha each loses or gains a small multiple of alpha^2: 1e-4 here.
    for (const WardModel model : kModels) EXPECT_NEAR(albedo(model, 0, 0.01), 1, 1e-3) << name_of(model);
}

TEST(WardLobe, PeaksAtTheMirrorDirectionWithThePublishedValue) {
    // Ward 1992, eq. 5 at delta = 0, theta_i = theta_r: 1 / (4 pi alpha^2 cos); all three agree at normal
    // incidence.
    const double alpha = 0.15, theta = 0.6;
    const auto mirror = angles_between(direction(theta, 0), direction(theta, kPi));
    const double expected = 1 / (4 * kPi * alpha * alpha * std::cos(theta));
    EXPECT_NEAR(ward_lobe(WardModel::ward1992, mirror, alpha), expected, 1e-12 * expected);
    EXPECT_NEAR(ward_lobe(WardModel::duer, mirror, alpha), expected / std::cos(theta), 1e-9);
    EXPECT_NEAR(ward_lobe(WardModel::bounded, mirror, alpha), expected / std::cos(theta), 1e-9);
    const auto above = angles_between({0, 0, 1}, {0, 0, 1});
    for (const WardModel model : kModels)
        EXPECT_NEAR(ward_lobe(model, above, alpha), 1 / (4 * kPi * alpha * alpha), 1e-9) << name_of(model);
}

TEST(WardLobe, IsReciprocal) {
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const DVec3 l = random.direction(0.01), v = random.direction(0.01);
        const double alpha = random.uniform(0.05, 1), beta = random.uniform(0.05, 1);
        for (const WardModel model : kModels) {
            const double there = ward_lobe(model, angles_between(l, v), alpha);
            EXPECT_NEAR(ward_lobe(model, angles_between(v, l), alpha), there, 1e-12 * there)
                << name_of(model);
            const double there2 = ward_lobe(model, angles_between(l, v), alpha, beta);
            EXPECT_NEAR(ward_lobe(model, angles_between(v, l), alpha, beta), there2, 1e-12 * there2)
                << name_of(model);
        }
    }
}

TEST(WardLobe, AnisotropicWithEqualAlphasIsIsotropic) {
    Random random(2);
    for (int i = 0; i < 2000; ++i) {
        const DVec3 l = random.direction(0.02), v = random.direction(0.02);
        const double alpha = random.uniform(0.02, 1);
        for (const WardModel model : kModels) {
            const double isotropic = ward_lobe(model, angles_between(l, v), alpha);
            // The exponent, up to 1e7 here, loses its last digits to the difference of squares in one of the
            // two.
            EXPECT_NEAR(ward_lobe(model, angles_between(l, v), alpha, alpha), isotropic,
                        1e-8 * isotropic + 1e-290)
                << name_of(model);
        }
    }
}

TEST(WardLobe, AnisotropicIsWiderAcrossTheBrushHairs) {
    // alpha_x = 0.3 along x and 0.05 along y: a half vector tilted along x is brighter than one tilted along
    // y.
    for (const WardModel model : kModels)
        EXPECT_GT(ward_lobe(model, angles_between(direction(0.4, 0), {0, 0, 1}), 0.3, 0.05),
                  10 * ward_lobe(model, angles_between(direction(0.4, kPi / 2), {0, 0, 1}), 0.3, 0.05))
            << name_of(model);
}

TEST(WardLobe, StaysTheSameWhenTheWholeFrameTurns) {
    Random random(3);
    for (int i = 0; i < 500; ++i) {
        const Vec3 l = random.direction(0.05), v = random.direction(0.05);
        // A random rotation, as the columns it turns x, y, z into.
        const Vec3 n = random.direction(-1);
        const Vec3 t = glm::normalize(glm::cross(n, random.direction(-0.9))), b = glm::cross(n, t);
        const auto turned = [&](const Vec3& a) { return a.x * t + a.y * b + a.z * n; };
        for (const WardModel model : kModels) {
            const float flat =
                ward_lobe(model, ward_angles({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, l, v), 0.3f, 0.2f);
            const float tilted = ward_lobe(model, ward_angles(n, t, b, turned(l), turned(v)), 0.3f, 0.2f);
            // Relative error: of each cosine (>= 0.05) about 2e-6, in the exponent times twice its value (<
            // 200).
            EXPECT_NEAR(tilted, flat, 1e-3f * flat + 1e-6f) << name_of(model);
        }
    }
}

TEST(WardLobe, IsZeroBelowTheSurface) {
    for (const WardModel model : kModels) {
        EXPECT_EQ(ward_lobe(model, angles_between(direction(1.7, 0), {0, 0, 1}), 0.2), 0);
        EXPECT_EQ(ward_lobe(model, angles_between({0, 0, 1}, direction(1.7, 0)), 0.2), 0);
        EXPECT_EQ(ward_lobe(model, angles_between({1, 0, 0}, {0, 0, 1}), 0.2, 0.2), 0);
    }
}

TEST(WardLobe, IsFiniteForEveryRoughnessAndDirectionOfTheThesis) {
    // Down to the last bits of a float: light, viewer and normal within 1e-7 of grazing, and mirrored
    // exactly.
    const float cosines[] = {1e-37f, 1e-30f, 1e-20f, 1e-10f, 1e-7f, 1e-4f, 0.01f, 0.3f, 0.8f, 1.0f};
    const float alphas[] = {1e-4f, 1e-3f, 0.01f, 0.1f, 1.0f};
    for (const float n_l : cosines)
        for (const float n_v : cosines)
            for (int turn = 0; turn <= 180; turn += 15) {
                const auto vector = [](float z, double phi) {
                    return Vec3(direction(std::acos(double(z)), phi).x,
                                direction(std::acos(double(z)), phi).y, z);
                };
                const Vec3 l = vector(n_l, turn * kPi / 180), v = vector(n_v, 0);
                const WardAngles<float> a = ward_angles({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, l, v);
                for (const float alpha : alphas)
                    for (const WardModel model : kModels)
                        for (const float lobe :
                             {ward_lobe(model, a, alpha), ward_lobe(model, a, alpha, 1.0f)}) {
                            const float shaded = 0.1f * lobe * n_l;  // rho_s = 0.1, as radiance
                            ASSERT_TRUE(std::isfinite(shaded) && shaded >= 0)
                                << name_of(model) << ", alpha " << alpha << ", n.l " << n_l << ", n.v " << n_v
                                << ", turn " << turn << ": " << lobe;
                        }
            }
}

TEST(WardLobe, IsFiniteForRandomNormalsInFloat) {
    Random random(4);
    for (int i = 0; i < 200000; ++i) {
        const Vec3 n = random.direction(0.0), l = random.direction(-0.1);
        const float alpha = std::pow(10.0f, random.real(-4, 0)), specular = random.real(0, 0.1);
        for (const WardModel model : kModels) {
            const float shaded = specular * ward_lobe(model, ward_angles(n, l, {0, 0, 1}), alpha);
            ASSERT_TRUE(std::isfinite(shaded) && shaded >= 0) << name_of(model) << ", alpha " << alpha;
        }
    }
}

TEST(WardModel, NamesRoundTrip) {
    for (const WardModel model : kModels) EXPECT_EQ(ward_model_named(name_of(model)), model);
    for (const char* unknown : {"", "ward", "Bounded", "duer ", "ward1992x"})
        EXPECT_FALSE(ward_model_named(unknown)) << unknown;
}

// The fits of 100 measured materials by Ngan, Durand and Matusik 2005; there kd is the BRDF's value, rho_d =
// pi kd.
TEST(DataWardMerl, MeasuredMaterialsReflectNoMoreThanTheyReceiveExceptTheFourOfDoubtfulFit) {
    TP_DATA(tables, "tables");
    std::ifstream file(tables / "ward_merl.csv");
    std::string line;
    std::getline(file, line);
    ASSERT_TRUE(line.starts_with("material,kd_r,kd_g,kd_b,ks_r,ks_g,ks_b,alpha")) << line;
    int materials = 0;
    std::vector<std::string> too_bright;
    double brightest = 0;
    while (std::getline(file, line)) {
        ++materials;
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        std::string name;
        double kd[3], ks[3], alpha = 0;
        fields >> name >> kd[0] >> kd[1] >> kd[2] >> ks[0] >> ks[1] >> ks[2] >> alpha;
        ASSERT_TRUE(fields) << line;
        const double lobe = albedo(WardModel::ward1992, 0, alpha, 100);
        double total = 0;
        for (int c = 0; c < 3; ++c) total = std::max(total, kPi * kd[c] + ks[c] * lobe);
        if (!(total <= 1.05)) too_bright.push_back(name);
        brightest = std::max(brightest, total);
    }
    EXPECT_EQ(materials, 100);
    // These are fits to saturated paints and to sugar, whose scattering below the surface no BRDF describes.
    EXPECT_EQ(too_bright,
              (std::vector<std::string>{"light-red-paint", "orange-paint", "pink-plastic", "sugar"}));
    EXPECT_LE(brightest, 1.32);
}

}  // namespace
}  // namespace tangi
