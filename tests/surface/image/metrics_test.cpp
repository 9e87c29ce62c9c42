#include "surface/image/metrics.h"

#include <cmath>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A picture of blotches, the same on every machine.
Image<Rgb> blotches(int width, int height, unsigned seed = 1) {
    Image<Rgb> picture(width, height);
    unsigned state = seed;
    for (Rgb& pixel : picture.pixels())
        for (int c = 0; c < 3; ++c) {
            state = state * 1664525u + 1013904223u;
            pixel[c] = static_cast<float>(state >> 8) / static_cast<float>(1 << 24);
        }
    return picture;
}

template <class Change>
Image<Rgb> changed(Image<Rgb> picture, Change&& change) {
    for (Rgb& pixel : picture.pixels()) pixel = change(pixel);
    return picture;
}

TEST(Psnr, OfAKnownErrorIsWhatItsDefinitionSays) {
    const Image<Rgb> black(7, 5, Rgb(0));
    EXPECT_NEAR(psnr_db(black, Image<Rgb>(7, 5, Rgb(0.1f))), 20, 1e-5);  // 10 log10(1 / 0.01)
    EXPECT_NEAR(psnr_db(black, Image<Rgb>(7, 5, Rgb(1))), 0, 1e-9);
    EXPECT_NEAR(psnr_db(black, Image<Rgb>(7, 5, Rgb(0.3f, 0, 0))), -10 * std::log10(0.03),
                1e-5);  // one channel in 3
}

TEST(Psnr, OfUniformNoiseMatchesItsVariance) {
    const Image<Rgb> grey(200, 200, Rgb(0.5f));
    const Image<Rgb> noise = blotches(200, 200);
    Image<Rgb> noisy = grey;
    for (std::size_t i = 0; i < noisy.size(); ++i) noisy.pixels()[i] += 0.2f * (noise.pixels()[i] - 0.5f);
    // Variance of a uniform deviate of width 0.2 is 0.04 / 12; 120 000 values fix it to about 0.3 %.
    EXPECT_NEAR(psnr_db(grey, noisy), -10 * std::log10(0.04 / 12), 0.05);
}

TEST(Psnr, IsSymmetricInfiniteForEqualPicturesAndClamps) {
    const Image<Rgb> a = blotches(31, 17, 1), b = blotches(31, 17, 2);
    EXPECT_EQ(psnr_db(a, b), psnr_db(b, a));
    EXPECT_TRUE(std::isinf(psnr_db(a, a)));
    EXPECT_TRUE(std::isinf(psnr_db(Image<Rgb>(3, 3, Rgb(1)), Image<Rgb>(3, 3, Rgb(7)))));
    EXPECT_TRUE(std::isinf(psnr_db(Image<Rgb>(3, 3, Rgb(0)), Image<Rgb>(3, 3, Rgb(-1)))));
}

TEST(Psnr, LeavesOutWhatTheMaskLeavesOut) {
    Image<Rgb> a(8, 8, Rgb(0.2f)), b(8, 8, Rgb(0.3f));
    PixelMask mask(8, 8, 1);
    for (int x = 0; x < 8; ++x) {
        b(x, 3) = Rgb(0.9f);
        mask(x, 3) = 0;
    }
    EXPECT_NEAR(psnr_db(a, b, mask), 20, 1e-5);
    EXPECT_NEAR(mean_difference(a, b, mask), 0.1, 1e-6);
    EXPECT_LT(psnr_db(a, b), 15);
}

TEST(Metrics, RefusePicturesOfDifferentSizeAndEmptyMasks) {
    const Image<Rgb> a(4, 4), b(4, 5);
    EXPECT_THROW(psnr_db(a, b), ContractError);
    EXPECT_THROW(ssim(a, b), ContractError);
    EXPECT_THROW(delta_e_2000_map(a, b), ContractError);
    EXPECT_THROW(psnr_db(a, a, PixelMask(4, 4, 0)), ContractError);
    EXPECT_THROW(psnr_db(a, a, PixelMask(5, 4, 1)), ContractError);
}

TEST(MeanDifference, IsSigned) {
    const Image<Rgb> a(5, 5, Rgb(0.5f)), b(5, 5, Rgb(0.4f));
    EXPECT_NEAR(mean_difference(a, b), -0.1, 1e-6);
    EXPECT_NEAR(mean_difference(b, a), +0.1, 1e-6);
    EXPECT_NEAR(luma_difference(a, b)(2, 2), -0.1, 1e-6);
}

TEST(LumaCorrelation, IsTheSignOfALinearDependenceAndNothingOfAFlatPicture) {
    Image<Rgb> ramp(40, 30), opposite(40, 30), other(40, 30);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            const float u = static_cast<float>(x) / 39, v = static_cast<float>(y) / 29;
            ramp(x, y) = Rgb(0.2f + 0.5f * u), opposite(x, y) = Rgb(0.9f - 0.3f * u), other(x, y) = Rgb(v);
        }
    EXPECT_NEAR(luma_correlation(ramp, ramp).value(), 1, 1e-6);
    EXPECT_NEAR(luma_correlation(ramp, opposite).value(), -1, 1e-6);
    EXPECT_NEAR(luma_correlation(ramp, other).value(), 0, 1e-6);
    EXPECT_FALSE(luma_correlation(ramp, Image<Rgb>(40, 30, Rgb(0.5f))).has_value());
    PixelMask half(40, 30, 1);  // what is masked away would turn the sign
    for (int y = 0; y < 30; ++y)
        for (int x = 20; x < 40; ++x)
            half(x, y) = 0, opposite(x, y) = Rgb(0.5f + 0.5f * static_cast<float>(x) / 39);
    EXPECT_NEAR(luma_correlation(ramp, opposite, half).value(), -1, 1e-6);
}

TEST(Ssim, IsOneForEqualPicturesAndSymmetric) {
    const Image<Rgb> a = blotches(40, 30, 1), b = blotches(40, 30, 2);
    EXPECT_NEAR(ssim(a, a), 1, 1e-6);
    EXPECT_NEAR(ssim(a, b), ssim(b, a), 1e-9);
    EXPECT_LT(ssim(a, b), 0.2);
}

TEST(Ssim, OfFlatPicturesIsTheLuminanceTermOfThePaper) {
    const double x = 0.3, y = 0.6, c1 = 1e-4;
    const double expected = (2 * x * y + c1) / (x * x + y * y + c1);
    const Image<Rgb> a(30, 30, Rgb(0.3f)), b(30, 30, Rgb(0.6f));
    EXPECT_NEAR(ssim(a, b), expected, 1e-3);  // variances of constants are rounding errors beside c2 = 9e-4
}

TEST(Ssim, OfInvertedContrastIsNegative) {
    const Image<Rgb> a = blotches(64, 64);
    const Image<Rgb> inverted = changed(a, [](const Rgb& c) { return Rgb(1) - c; });
    EXPECT_LT(ssim(a, inverted), -0.8);
}

// sigma_ab = k sigma_aa where b = mean + k (a - mean): contrast term (2k + e) / (1 + k^2 + e), e = c2 /
// sigma_aa.
TEST(Ssim, OfLoweredContrastFollowsTheContrastTerm) {
    const Image<Rgb> a = changed(blotches(200, 200), [](const Rgb& c) { return Rgb(luminance(c)); });
    const Image<Rgb> lowered = changed(a, [](const Rgb& c) { return 0.5f + 0.5f * (c - 0.5f); });
    const double k = 0.5;
    EXPECT_NEAR(ssim(a, lowered), 2 * k / (1 + k * k), 0.02);
}

TEST(Ssim, MaskedPixelsTouchNeitherTheMeanNorTheirNeighbours) {
    const Image<Rgb> a = blotches(40, 40);
    Image<Rgb> b = a;
    PixelMask mask(40, 40, 1);
    for (int y = 15; y < 25; ++y)
        for (int x = 15; x < 25; ++x) {
            b(x, y) = Rgb(1) - a(x, y);
            mask(x, y) = 0;
        }
    EXPECT_NEAR(ssim(a, b, mask), 1, 1e-5);
    EXPECT_EQ(ssim_map(a, b, mask)(20, 20), 0);
    EXPECT_LT(ssim(a, b), 0.95);
}

TEST(Ssim, WorksOnPicturesSmallerThanItsWindow) {
    const Image<Rgb> a = blotches(4, 3);
    EXPECT_NEAR(ssim(a, a), 1, 1e-6);
    EXPECT_NEAR(ssim(Image<Rgb>(1, 1, Rgb(0.5f)), Image<Rgb>(1, 1, Rgb(0.5f))), 1, 1e-6);
}

TEST(DeltaE2000, OfGreysIsTheirWeightedLightnessDifference) {
    // White against L* = 50 (Y = 0.18418651851): S_L = 1 + 0.015 * 25^2 / sqrt(20 + 25^2), chroma 0.
    const float grey = 0.18418651851f;
    const Image<float> map = delta_e_2000_map(Image<Rgb>(2, 2, Rgb(1)), Image<Rgb>(2, 2, Rgb(grey)));
    const double s_l = 1 + 0.015 * 625 / std::sqrt(645.0);
    EXPECT_NEAR(map(1, 1), 50 / s_l, 0.01);
}

TEST(DeltaE2000, IsZeroForEqualAndSymmetric) {
    const Image<Rgb> a = blotches(12, 9, 1), b = blotches(12, 9, 2);
    const Image<float> there = delta_e_2000_map(a, b), back = delta_e_2000_map(b, a);
    for (std::size_t i = 0; i < there.size(); ++i) EXPECT_NEAR(there.pixels()[i], back.pixels()[i], 1e-4);
    EXPECT_EQ(mean(delta_e_2000_map(a, a)), 0);
}

TEST(Percentile, IsTheValueAtThatRank) {
    Image<float> values(101, 1);
    for (int x = 0; x <= 100; ++x) values(x, 0) = static_cast<float>(100 - x);
    EXPECT_EQ(percentile(values, 0.95), 95);
    EXPECT_EQ(percentile(values, 0), 0);
    EXPECT_EQ(percentile(values, 1), 100);
    values(0, 0) = std::nanf("");  // 100 is gone
    EXPECT_EQ(percentile(values, 1), 99);
    PixelMask mask(101, 1, 0);
    EXPECT_TRUE(std::isnan(percentile(values, 0.5, mask)));
    mask(40, 0) = 1;
    EXPECT_EQ(percentile(values, 0.5, mask), 60);
}

TEST(Measured, IsWhereConfidenceIsNotZero) {
    Image<float> confidence(2, 1);
    confidence(1, 0) = 0.01f;
    const PixelMask mask = measured(confidence);
    EXPECT_EQ(mask(0, 0), 0);
    EXPECT_EQ(mask(1, 0), 1);
}

}  // namespace
}  // namespace tangi
