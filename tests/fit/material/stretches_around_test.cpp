// stretches_around_test.cpp: how lobes are anisotropic, by those of the pixels around.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <vector>

#include "fit/material/anisotropy_estimate.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(LobeStretches, AreThoseOfNeighboursOfTheSameLook) {
    const Surface s = metal_beside_paint(40, 24, 10);
    const SampledPixels asked = sampled_pixels(40, 24);
    Image<StretchEvidence> evidence(asked.x.count, asked.y.count);
    ASSERT_EQ(asked.x.apart, 1);
    Random random(7);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 40; ++x) {
            const bool metal = x < 20;
            // Each pixel tells one direction well and the other hardly.
            const double angle = random.uniform(0, 2 * M_PI);
            const glm::dvec2 well(std::cos(angle), std::sin(angle));
            const glm::dvec2 truth = metal ? glm::dvec2(0.5, -0.2) : glm::dvec2(0);
            evidence(x, y) = {
                truth + 0.15 * random.normal() * well + 1.5 * random.normal() * glm::dvec2(-well.y, well.x),
                44.0 * glm::outerProduct(well, well) + glm::dmat2(0.4)};
        }
    const Image<Stretch> stretches = lobe_stretches(s, evidence);
    double metal = 0, paint = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 40; ++x) {
            if (x == 10) continue;
            const Stretch truth = x < 20 ? Stretch(0.5f, -0.2f) : Stretch(0);
            (x < 20 ? metal : paint) += glm::length(stretches(x, y) - truth) / 480;
        }
    EXPECT_LT(metal, 0.1);
    EXPECT_LT(paint, 0.03);
    EXPECT_EQ(stretches(10, 3), Stretch(0)) << "not measured";
}

// What is brushed up and what is brushed across look the same; each pixel tells little.
TEST(LobeStretches, KeepTheLineBetweenTwoWaysOfBrushing) {
    Surface s(40, 24);
    s.confidence = Image<float>(40, 24, 1.0f);
    s.diffuse = Image<Rgb>(40, 24, Rgb(0.2f));
    Image<StretchEvidence> evidence(40, 24);
    Random random(9);
    const auto truth_at = [](int x, int y) { return Stretch(x + y < 32 ? 0.6f : -0.6f, 0); };
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 40; ++x)
            evidence(x, y) = {glm::dvec2(truth_at(x, y)) + 0.2 * glm::dvec2(random.normal(), random.normal()),
                              glm::dmat2(25)};
    const Image<Stretch> stretches = lobe_stretches(s, evidence);
    double beside = 0, elsewhere = 0;
    int few = 0, many = 0;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 40; ++x) {
            const bool near = std::abs(x + y - 32) < 3;
            (near ? beside : elsewhere) += glm::length(stretches(x, y) - truth_at(x, y));
            ++(near ? few : many);
        }
    EXPECT_LT(beside / few, 0.35);  // 0.45 where all neighbours are asked alike
    EXPECT_LT(elsewhere / many, 0.06);
}

// However far apart pixels are asked, the line is not a flight of stairs, and a glint is no hole.
TEST(LobeStretches, DoNotShowWhichPixelsWereAsked) {
    constexpr int kWidth = 900, kHeight = 750;
    Surface s(kWidth, kHeight);
    s.confidence = Image<float>(kWidth, kHeight, 1.0f);
    s.diffuse = Image<Rgb>(kWidth, kHeight, Rgb(0.2f));
    const SampledPixels asked = sampled_pixels(kWidth, kHeight);
    ASSERT_EQ(asked.x.apart, 9);
    const int glint_x = asked.look_x.at(40), glint_y = asked.look_y.at(41);
    s.diffuse(glint_x, glint_y) = Rgb(0.9f);
    Image<StretchEvidence> evidence(asked.x.count, asked.y.count);
    Random random(11);
    const auto side_of = [](int x, int y) { return x + 0.6 * y < 600 ? 1 : -1; };
    for (int j = 0; j < asked.y.count; ++j)
        for (int i = 0; i < asked.x.count; ++i)
            evidence(i, j) = {glm::dvec2(0.6 * side_of(asked.x.at(i), asked.y.at(j)), 0) +
                                  0.15 * glm::dvec2(random.normal(), random.normal()),
                              glm::dmat2(44)};
    const Image<Stretch> stretches = lobe_stretches(s, evidence);
    int wrong = 0, far_off = 0;
    for (int y = 20; y < kHeight - 20; ++y)
        for (int x = 20; x < kWidth - 20; ++x)
            if (!(stretches(x, y).x * static_cast<float>(side_of(x, y)) > 0)) {
                ++wrong;
                far_off += std::abs(x + 0.6 * y - 600) > 9 * std::sqrt(1.36);
            }
    EXPECT_EQ(far_off, 0);
    EXPECT_LT(wrong, 2 * (kHeight - 40));  // 2.5 a row where the nearest that is asked is taken
    EXPECT_GT(std::abs(stretches(glint_x, glint_y).x), 0.4f);
}

TEST(SampledPixels, AreFewEnoughAndTheSameFromAllSides) {
    for (const auto& [width, height] : std::vector<std::array<int, 2>>{{1, 1},
                                                                       {2, 1},
                                                                       {48, 32},
                                                                       {200, 151},
                                                                       {500, 520},
                                                                       {711, 710},
                                                                       {1420, 999},
                                                                       {3000, 1000},
                                                                       {9001, 8000}}) {
        const SampledPixels asked = sampled_pixels(width, height), turned = sampled_pixels(height, width);
        for (const auto& [places, looks, other, pixels] :
             {std::tuple(asked.x, asked.look_x, turned.y, width),
              std::tuple(asked.y, asked.look_y, turned.x, height)}) {
            EXPECT_EQ(places.first, other.first);
            EXPECT_EQ(places.count, other.count);
            EXPECT_EQ(places.apart, other.apart);
            ASSERT_GE(places.first, 0);
            ASSERT_LT(places.at(places.count - 1), pixels);
            if (pixels > 2) {
                EXPECT_EQ(places.first, pixels - 1 - places.at(places.count - 1)) << pixels;
                EXPECT_EQ(looks.first, pixels - 1 - looks.at(looks.count - 1)) << pixels;
            }
            EXPECT_LT(looks.first, 2 * looks.apart);
            EXPECT_LT(places.first, 2 * places.apart);
            for (int i = 0; i < places.count; ++i) {
                EXPECT_TRUE(looks.has(places.at(i)));
                EXPECT_EQ(places.nearest(places.at(i)), i);
            }
        }
        const double all = static_cast<double>(width) * height,
                     count = static_cast<double>(asked.x.count) * asked.y.count;
        EXPECT_LE(count, kAsked * 1.1) << width;
        EXPECT_GE(count, std::min(all / 2, kAsked / 10)) << width;
    }
}

}  // namespace
}  // namespace tangi
