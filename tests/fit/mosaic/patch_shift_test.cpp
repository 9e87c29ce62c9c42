// patch_shift_test.cpp: shifts of patches are recovered to a fraction of a pixel, as certain as they say.
#include "fit/mosaic/patch_shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "surface/base/noise.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using glm::dvec2;

constexpr int kPatchSize = 96;

// Relief of several scales, moved by `shift`, with noise.
Image<float> moved_texture(const dvec2& shift, float noise_rms, std::uint64_t seed) {
    Image<float> image(kPatchSize, kPatchSize);
    Random random(seed);
    for (int y = 0; y < kPatchSize; ++y)
        for (int x = 0; x < kPatchSize; ++x) {
            const auto u = static_cast<float>((x - shift.x) / 7), v = static_cast<float>((y - shift.y) / 7);
            image(x, y) = 0.3f * procedural::fractal_noise(u, v, 2, 5) +
                          noise_rms * static_cast<float>(random.normal());
        }
    return image;
}

PatchShift shift_between(const Image<float>& own, const Image<float>& other,
                         const Homography& between = Homography(1)) {
    return patch_shift({own, own}, {other, other}, dvec2(48), 24, between, 8);
}

TEST(PatchShifts, AreRecovered) {
    const Image<float> own = moved_texture({0, 0}, 0, 1);
    for (const dvec2& shift : {dvec2(0), dvec2(0.25, -0.4), dvec2(1.6, 0.7), dvec2(-2.3, 1.1)}) {
        const PatchShift found = shift_between(own, moved_texture(shift, 0, 2));
        ASSERT_TRUE(found.found) << shift.x;
        EXPECT_NEAR(found.shift.x, shift.x, 0.02);
        EXPECT_NEAR(found.shift.y, shift.y, 0.02);
        EXPECT_GT(found.correlation, 0.98);
    }
}

TEST(PatchShifts, GoOnFromTheHomography) {
    const dvec2 shift(31.3, 12.2);
    const Homography near(1, 0, 0, 0, 1, 0, 31, 12, 1);
    Image<float> own = moved_texture({0, 0}, 0, 1), other = moved_texture(shift, 0, 2);
    const PatchShift found = patch_shift({own, own}, {other, other}, dvec2(30), 20, near, 8);
    ASSERT_TRUE(found.found);
    EXPECT_NEAR(found.shift.x, 0.3, 0.02);
    EXPECT_NEAR(found.shift.y, 0.2, 0.02);
}

// As local contrast is: noise is smoothed with what it is noise of.
Image<float> smoothed(const Image<float>& image) {
    constexpr int kReach = 3;
    constexpr float kSigma = 0.8f;
    Image<float> result(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            float sum = 0, weights = 0;
            for (int j = -kReach; j <= kReach; ++j)
                for (int i = -kReach; i <= kReach; ++i) {
                    const float weight = std::exp(-static_cast<float>(i * i + j * j) / (2 * kSigma * kSigma));
                    sum += weight * image.clamped(x + i, y + j), weights += weight;
                }
            result(x, y) = sum / weights;
        }
    return result;
}

// The errors of many patches are about as large as they say.
TEST(PatchShifts, KnowTheirErrors) {
    double squares = 0;
    constexpr int kTimes = 40;
    for (int i = 0; i < kTimes; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        // Two kinds of picture, whose noise is their own.
        std::array<Image<float>, 2> own, other;
        for (std::uint64_t kind = 0; kind < 2; ++kind) {
            own[kind] = smoothed(moved_texture({0, 0}, 0.05f, 4 * seed + 2 * kind));
            other[kind] = smoothed(moved_texture({0.3, 0.2}, 0.05f, 4 * seed + 2 * kind + 1));
        }
        const PatchShift found =
            patch_shift({own[0], own[1]}, {other[0], other[1]}, dvec2(48), 24, Homography(1), 8);
        ASSERT_TRUE(found.found);
        const dvec2 off = (found.shift - dvec2(0.3, 0.2)) / found.sigma;
        squares += glm::dot(off, off) / 2;
    }
    EXPECT_GT(std::sqrt(squares / kTimes), 0.6);
    EXPECT_LT(std::sqrt(squares / kTimes), 1.5);
}

TEST(PatchShifts, AreNotFoundWhereNothingTells) {
    EXPECT_FALSE(
        shift_between(moved_texture({0, 0}, 0, 1), Image<float>(kPatchSize, kPatchSize, 0.5f)).found);
    EXPECT_FALSE(
        shift_between(Image<float>(kPatchSize, kPatchSize), Image<float>(kPatchSize, kPatchSize)).found);
    const Image<float> unknown(kPatchSize, kPatchSize, std::numeric_limits<float>::quiet_NaN());
    EXPECT_FALSE(shift_between(unknown, moved_texture({0, 0}, 0, 1)).found);
    Image<float> stripes(kPatchSize, kPatchSize);  // which say nothing along themselves
    for (int y = 0; y < kPatchSize; ++y)
        for (int x = 0; x < kPatchSize; ++x) stripes(x, y) = std::sin(0.5f * static_cast<float>(x));
    EXPECT_FALSE(shift_between(stripes, stripes).found);
}

}  // namespace
}  // namespace tangi
