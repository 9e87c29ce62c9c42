// subpixel_slopes_test.cpp: slopes of what pixels mix, against quadrature and against known heights.
#include "fit/height/subpixel_slopes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <numbers>

#include "fit/height/height.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// The mean over a pixel of the normals of slopes that change evenly along x.
Vec3 mean_normal(double slope, double change) {
    constexpr int parts = 1000;
    glm::dvec3 sum(0);
    for (int i = 0; i < parts; ++i) {
        const double s = slope + change * ((i + 0.5) / parts - 0.5);
        sum += glm::dvec3(-s, 0, 1) / std::sqrt(1 + s * s);
    }
    return Vec3(glm::normalize(sum));
}

TEST(MixedSlopes, WhatAPixelMixesIsLessCertain) {
    Image<Vec3> normal(6, 3, Vec3(0, 0, 1));
    for (int y = 0; y < 3; ++y) normal(5, y) = glm::normalize(Vec3(-0.4f, 0, 1));
    Image<float> known(6, 3, 1.0f);
    known(0, 0) = 0;
    Image<HalfError> error(6, 3, HalfError(0.001f));
    error(0, 0) = HalfError(0);
    add_mixing_error(normal, known, error);
    EXPECT_EQ(float(error(0, 0)), 0.0f) << "not measured";
    EXPECT_NEAR(float(error(2, 1)), 0.001f, 1e-5f) << "as its neighbours";
    EXPECT_GT(float(error(4, 1)), 0.004f) << "beside an edge";
    EXPECT_LT(float(error(4, 1)), 0.4f / std::sqrt(12.0f)) << "no more than all of the edge within it";
}

// The mean slope is that of the middle; at 0.8 +- 0.25 the normal is less steep by 0.6 %, at 0.8 +- 0.5
// by 2.6 %.
TEST(MixedSlopes, MeanSlopesOfAnEvenChangeComeBack) {
    for (const double change : {0.5, 1.0})
        for (const double slope : {0.3, 0.8, 1.5}) {
            Image<Vec3> normal(5, 5);
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 5; ++x) normal(x, y) = mean_normal(slope + change * (x - 2), change);
            const Image<float> known(5, 5, 1.0f);
            const double before = slope_of(normal(2, 2)).x,
                         after = slope_of(steepened_normals(normal, known, 1.0 / 12)(2, 2)).x;
            EXPECT_LT(before, slope) << slope << ' ' << change;
            EXPECT_LT(std::abs(after - slope), 0.35 * std::abs(before - slope)) << slope << ' ' << change;
        }
}

// Ridges and valleys, a period of 8 pixels: as they are, slopes of means over pixels lose height.
TEST(MixedSlopes, ShortWavesKeepTheirHeight) {
    constexpr int size = 64;
    constexpr double k = 2 * std::numbers::pi / 8;
    const auto gain_of = [&](double amplitude, double mixing) {
        Image<Vec3> normal(size, size);
        Image<float> truth(size, size), known(size, size, 1.0f), z;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                glm::dvec3 sum(0);
                double height = 0;
                constexpr int parts = 16;
                for (int i = 0; i < parts; ++i) {
                    const double u = x + (i + 0.5) / parts - 0.5, s = amplitude * k * std::cos(k * u);
                    sum += glm::dvec3(-s, 0, 1) / std::sqrt(1 + s * s);
                    height += amplitude * std::sin(k * u) / parts;
                }
                normal(x, y) = Vec3(glm::normalize(sum));
                truth(x, y) = static_cast<float>(height);
            }
        if (mixing >= 0) normal = steepened_normals(normal, known, mixing);
        integrate_normals({normal, known, 1}, z, {.robust_sweeps = 0});
        double product = 0, square = 0;
        for (std::size_t i = 0; i < z.size(); ++i) {
            product += z.pixels()[i] * truth.pixels()[i];
            square += truth.pixels()[i] * truth.pixels()[i];
        }
        return product / square;
    };
    const double raw = gain_of(0.05, -1), fourth_order = gain_of(0.05, 0);
    const double steep_raw = gain_of(1, -1), steep = gain_of(1, 1.0 / 12);
    std::cout << fmt::format(
        "[  FIGURE  ] height of waves of 8 pixels: flat {:.4f}, {:.4f}; steep {:.4f}, {:.4f}\n", raw,
        fourth_order, steep_raw, steep);
    EXPECT_LT(raw, 0.96);  // a trapezoid: 1 - k^2 / 12
    EXPECT_NEAR(fourth_order, 1, 0.01);
    EXPECT_LT(steep_raw, 0.95);
    EXPECT_NEAR(steep, 1, 0.01);
}

TEST(MixedSlopes, PlanesStayAsTheyAre) {
    const Image<Vec3> normal(6, 5, normal_of({0.4f, -0.7f}));
    const Image<Vec3> result = steepened_normals(normal, Image<float>(6, 5, 1.0f), 0.8);
    for (const Vec3& n : result.pixels()) EXPECT_LT(glm::length(n - normal(0, 0)), 1e-6f);
}

TEST(MixedSlopes, WhatWasNotMeasuredStaysAndHasNoSay) {
    Image<Vec3> normal(5, 5, normal_of({0.4f, -0.7f}));
    Image<float> confidence(5, 5, 1.0f);
    normal(2, 2) = Vec3(0, 0, 1);
    confidence(2, 2) = 0;
    const Image<Vec3> result = steepened_normals(normal, confidence, 0.8);
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 5; ++x)
            EXPECT_LT(glm::length(result(x, y) - normal(x, y)), 1e-6f) << x << ' ' << y;
}

// To the bit, as all of a fit.
TEST(MixedSlopes, MirroredSlopesGiveMirroredOnes) {
    Random random(5);
    Image<Vec3> normal(9, 7), mirrored(9, 7);
    Image<float> confidence(9, 7), mirrored_confidence(9, 7);
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x) {
            const Vec3 n =
                normal_of({static_cast<float>(random.normal()), static_cast<float>(random.normal())});
            normal(x, y) = n;
            mirrored(8 - x, y) = Vec3(-n.x, n.y, n.z);
            confidence(x, y) = mirrored_confidence(8 - x, y) = random.uniform() < 0.1 ? 0.0f : 0.9f;
        }
    const Image<Vec3> a = steepened_normals(normal, confidence, 0.4),
                      b = steepened_normals(mirrored, mirrored_confidence, 0.4);
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x)
            EXPECT_EQ(b(8 - x, y), Vec3(-a(x, y).x, a(x, y).y, a(x, y).z)) << x << ' ' << y;
}

}  // namespace
}  // namespace tangi
