// validation_scores_test.cpp: what is explained of samples, and when that decides between models.
#include "fit/pixel/validation_scores.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace tangi {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(ValidationScores, AreThePartThatIsExplained) {
    ValidationScores exact, noisy, metal;
    exact.add({0, 0, 0, 0}, 1e-4);
    noisy.add({1e-4, 1e-4, 1e-4, 1e-4}, 1e-4);
    metal.add({0, 0, 0, 1e+3}, 1e-4);  // an error, however large, is one sample's
    EXPECT_NEAR(exact.over(noisy).mean, 0.5, 1e-6);
    EXPECT_NEAR(exact.over(metal).mean, 0.25, 1e-6);
    EXPECT_EQ(exact.over(exact).mean, 0);
    EXPECT_EQ(exact.over(exact).sigma, 0);
}

TEST(ValidationScores, CompareSamplesThatBothHave) {
    ValidationScores a, b, marked, rest;
    a.add({0, kNone, 0}, 1);
    b.add({1, 0, kNone}, 1);
    EXPECT_NEAR(a.over(b).mean, 0.5, 1e-6);  // the first alone
    marked.add({5, 0, 5}, 1, {false, true, false});
    rest.add({0, 1, 0}, 1);
    EXPECT_NEAR(marked.over(rest).mean, 0.5, 1e-6);
    ValidationScores nowhere;
    nowhere.add({kNone, kNone, kNone}, 1);
    EXPECT_EQ(nowhere.over(a).mean, 0);
    EXPECT_EQ(nowhere.over(a).sigma, 0);
}

// Two models whose samples differ by noise, and by what each pixel and each photograph has of its own: the
// standard error is the spread that the mean has over many such stacks.
TEST(ValidationScores, StateTheErrorOfTheirMean) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    const int stacks = 400, photos = 12, pixels = 60;
    double squares = 0, stated = 0;
    for (int stack = 0; stack < stacks; ++stack) {
        std::vector<double> of_pixel(pixels);
        for (double& own : of_pixel) own = 0.05 * normal(random);
        ValidationScores a, b;
        for (int i = 0; i < photos; ++i) {
            const double of_photo = 0.02 * normal(random);
            std::vector<double> better(pixels), worse(pixels, 1.0);
            for (std::size_t k = 0; k < better.size(); ++k) {
                const double explained =
                    std::clamp(0.5 + of_pixel[k] + of_photo + 0.03 * normal(random), 0.05, 0.95);
                better[k] = 1 / explained - 1;
            }
            a.add(better, 1);
            b.add(worse, 1);
        }
        const ValidationScores::Gain gain = a.over(b);
        squares += gain.mean * gain.mean / stacks;
        stated += gain.sigma * gain.sigma / stacks;
    }
    EXPECT_NEAR(std::sqrt(stated / squares), 1, 0.1);
}

TEST(SelectModel, TakesTheSimplestWithinAStandardErrorOfTheBest) {
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    ValidationScores simple, better, as_good;
    for (int i = 0; i < 20; ++i) {
        std::vector<double> a(50), b(50), c(50);
        for (std::size_t k = 0; k < a.size(); ++k) {
            const double error = std::abs(normal(random));
            a[k] = 4 * error;
            b[k] = error;
            c[k] = error * std::exp(0.01 * normal(random));
        }
        simple.add(a, 1);
        better.add(b, 1);
        as_good.add(c, 1);
    }
    EXPECT_EQ(select_model(std::array<const ValidationScores*, 3>{&simple, &better, &as_good}), 1u);
    EXPECT_EQ(select_model(std::array<const ValidationScores*, 2>{&better, &simple}), 0u);
    EXPECT_EQ(select_model(std::array<const ValidationScores*, 2>{&as_good, &better}), 0u);
    EXPECT_EQ(select_model(std::array<const ValidationScores*, 1>{&simple}), 0u);
}

TEST(SelectModel, LeavesWhatExplainsHardlyMore) {
    ValidationScores simple, better;
    for (int i = 0; i < 20; ++i) {
        simple.add(std::vector(50, 1.0), 1);
        better.add(std::vector(50, 0.97), 1);  // for sure, by 0.008
    }
    EXPECT_EQ(select_model(std::array<const ValidationScores*, 2>{&simple, &better}), 0u);
}

}  // namespace
}  // namespace tangi
