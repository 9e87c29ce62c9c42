// height_error_test.cpp: the standard error of a height holds the truth, where slopes are as certain as
// they say; and what it is made of.
#include "fit/height/height_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fit/height/height.h"
#include "surface/base/parallel.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Waves of 24 pixels' length, slopes of two certainties in patches of 40 pixels.
struct NoisyWaves {
    Image<Vec3> normal;
    Image<float> confidence, height;

    NoisyWaves(int width, int height_px, double noise)
        : normal(width, height_px), confidence(width, height_px), height(width, height_px) {
        Random random(7);
        constexpr double k = 2 * std::numbers::pi / 24, amplitude = 0.6;
        for (int y = 0; y < height_px; ++y)
            for (int x = 0; x < width; ++x) {
                const double sigma = ((x / 40 + y / 40) % 2 ? 0.02 : 0.06) * noise;
                height(x, y) = static_cast<float>(amplitude * std::sin(k * x) * std::cos(k * y));
                const double sx = amplitude * k * std::cos(k * x) * std::cos(k * y);
                const double sy = amplitude * k * std::sin(k * x) * std::sin(k * y);  // y up
                normal(x, y) = normal_of({static_cast<float>(sx + sigma * random.normal()),
                                          static_cast<float>(sy + sigma * random.normal())});
                const double t = sigma / 0.1;
                confidence(x, y) = static_cast<float>(1 / (1 + t * t));
            }
    }
};

Image<float> without_mean(Image<float> z) {
    Image<float> mean = z;
    box_mean(z, kHeightErrorWindow / 2, mean);
    for (std::size_t i = 0; i < z.size(); ++i) z.pixels()[i] -= mean.pixels()[i];
    return z;
}

TEST(HeightError, HoldsTheTruthInIts95PercentInterval) {
    const NoisyWaves waves(240, 200, 1);
    Image<float> z;
    Image<HalfError> error;
    integrate_normals({waves.normal, waves.confidence, 1}, z, {}, {}, {.error_mm = &error});
    for (std::size_t i = 0; i < z.size(); ++i) z.pixels()[i] -= waves.height.pixels()[i];
    const Image<float> off = without_mean(z);
    double inside[2] = {}, count[2] = {}, square[2] = {}, stated[2] = {};
    for (int y = 0; y < z.height(); ++y)
        for (int x = 0; x < z.width(); ++x) {
            const int good = (x / 40 + y / 40) % 2;
            inside[good] += std::abs(off(x, y)) < 1.96f * error(x, y);
            square[good] += double(off(x, y)) * off(x, y);
            stated[good] += double(error(x, y)) * error(x, y);
            ++count[good];
        }
    for (const int good : {0, 1}) {
        std::cout << fmt::format(
            "[  FIGURE  ] height, slopes known to {}: {:.1f} % inside the 95 % interval, off by {:.4f} px "
            "rms, stated {:.4f}\n",
            good ? 0.02 : 0.06, 100 * inside[good] / count[good], std::sqrt(square[good] / count[good]),
            std::sqrt(stated[good] / count[good]));
        EXPECT_GE(inside[good] / count[good], 0.90) << good;
        EXPECT_LE(inside[good] / count[good], 0.995) << good;
    }
    EXPECT_LT(stated[1], stated[0]);
}

TEST(HeightError, IsProportionalToThatOfTheSlopesAndToThePixel) {
    const auto mean_error = [](double noise, double mm_per_pixel) {
        const NoisyWaves waves(120, 100, noise);
        Image<float> z;
        Image<HalfError> error;
        integrate_normals({waves.normal, waves.confidence, mm_per_pixel}, z, {}, {}, {.error_mm = &error});
        double sum = 0;
        for (const HalfError e : error.pixels()) sum += e / static_cast<double>(error.size());
        return sum;
    };
    const double one = mean_error(1, 1);
    EXPECT_NEAR(mean_error(1, 0.25) / one, 0.25, 0.005);
    // What slopes that differ between neighbours leave open grows with the noise, too.
    EXPECT_NEAR(mean_error(0.5, 1) / one, 0.5, 0.06);
}

TEST(HeightError, IsZeroWhereNothingWasMeasuredAndLargerBesideIt) {
    NoisyWaves waves(120, 100, 0.2);
    for (int y = 40; y < 60; ++y)
        for (int x = 50; x < 70; ++x) {
            waves.confidence(x, y) = 0;
            waves.normal(x, y) = Vec3(0, 0, 1);
        }
    Image<float> z;
    Image<HalfError> error;
    integrate_normals({waves.normal, waves.confidence, 1}, z, {}, {}, {.error_mm = &error});
    EXPECT_EQ(error(60, 50), 0.0f);
    EXPECT_GT(error(47, 50), 1.5f * error(10, 50));
}

TEST(HeightError, DoesNotDependOnTheNumberOfThreads) {
    const NoisyWaves waves(131, 97, 1);
    const auto errors = [&](int threads) {
        set_thread_count(threads);
        Image<float> z;
        Image<HalfError> error;
        integrate_normals({waves.normal, waves.confidence, 1}, z, {}, {}, {.error_mm = &error});
        return error;
    };
    const Image<HalfError> one = errors(1), two = errors(2);
    set_thread_count(0);
    EXPECT_TRUE(images_identical(one, two));
}

// Relief of waves whose slopes are known exactly: what is left is the trapezoids' error.
TEST(HeightError, HoldsTheTruthWhereSlopesAreRightAndReliefIsAsFineAsPixels) {
    Image<Vec3> normal(120, 120);
    const Image<float> known(120, 120, 1.0f);
    Image<float> truth(120, 120), z;
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 120; ++x) {
            const double k = 2 * std::numbers::pi / 6, u = k * (x + 0.4 * y), v = k * (y - 0.3 * x);
            truth(x, y) = static_cast<float>(0.3 * (std::sin(u) + std::sin(v)));
            normal(x, y) = normal_of({static_cast<float>(0.3 * k * (std::cos(u) - 0.3 * std::cos(v))),
                                      static_cast<float>(-0.3 * k * (0.4 * std::cos(u) + std::cos(v)))});
        }
    Image<HalfError> error;
    integrate_normals({normal, known, 1}, z, {.robust_sweeps = 0}, {}, {.error_mm = &error});
    for (std::size_t i = 0; i < z.size(); ++i) z.pixels()[i] -= truth.pixels()[i];
    const Image<float> off = without_mean(z);
    double inside = 0;
    for (std::size_t i = 0; i < z.size(); ++i)
        inside +=
            std::abs(off.pixels()[i]) < 1.96f * error.pixels()[i] ? 1.0 / static_cast<double>(z.size()) : 0;
    EXPECT_GE(inside, 0.9);
}

// One pixel's normal is wrong, and does not know: its edges disagree with the height, which says so.
TEST(HeightError, IsLargerWhereEdgesDisagreeWithTheHeight) {
    Image<Vec3> normal(60, 60, Vec3(0, 0, 1));
    const Image<float> confidence(60, 60, 0.999f);
    const auto error_at_the_pixel = [&] {
        Image<float> z;
        Image<HalfError> error;
        integrate_normals({normal, confidence, 1}, z, {.robust_sweeps = 0}, {}, {.error_mm = &error});
        return float(error(30, 30));
    };
    // Relief all around, so that spreads are alike with and without.
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 60; ++x) normal(x, y) = normal_of({(x + y) % 2 ? 0.05f : -0.05f, 0});
    const float before = error_at_the_pixel();
    normal(30, 30) = normal_of({2, 0});
    const float spread_alone = kOffset * 2.05f * 3 / 13;  // 9 of 169 pixels have it
    EXPECT_GT(error_at_the_pixel(), 1.1f * std::hypot(before, spread_alone));
}

TEST(HeightError, GrowsByWhatTwoHeightsDisagreeAbout) {
    Image<float> one(80, 80), other(80, 80);
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 80; ++x)
            other(x, y) = 7 + (x < 40 ? 0.0f : (x + y) % 2 ? 0.3f : -0.3f);  // the constant is the window's
    Image<HalfError> errors(80, 80, HalfError(0.4f));
    errors(70, 41) = 0;
    add_disagreement(one, other, errors);
    EXPECT_NEAR(errors(70, 40), 0.5, 0.005);
    EXPECT_NEAR(errors(8, 40), 0.4, 0.003);
    EXPECT_EQ(errors(70, 41), 0.0f);
}

TEST(BoxMean, IsTheMeanOfThePixelsAround) {
    Random random(3);
    Image<float> image(21, 600);  // more than two strips
    for (float& value : image.pixels()) value = random.real();
    Image<float> expected(image.width(), image.height());
    constexpr int kRadius = 4;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            double sum = 0;
            int count = 0;
            for (int v = std::max(y - kRadius, 0); v <= std::min(y + kRadius, image.height() - 1); ++v)
                for (int u = std::max(x - kRadius, 0); u <= std::min(x + kRadius, image.width() - 1); ++u) {
                    sum += image(u, v);
                    ++count;
                }
            expected(x, y) = static_cast<float>(sum / count);
        }
    Image<float> mean = image;
    box_mean(image, kRadius, mean);
    EXPECT_TRUE(images_near(mean, expected, 1e-5));
    Image<float> small(2, 1, 3.0f), same(2, 1);
    box_mean(small, 7, same);
    EXPECT_EQ(same(0, 0), 3.0f);
}

}  // namespace
}  // namespace tangi
