// lobe_neighbour_prior_test.cpp: neighbours of the same colour say what a pixel's lobe is like.
#include "fit/material/lobe_neighbour_prior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kSize = 24;

// What a fit with a prior makes of what the photographs say.
struct FittedLobes {
    double value, error;
};
FittedLobes fitted(double told, double error, double prior, double prior_sigma) {
    const double information = 1 / (error * error), other = 1 / (prior_sigma * prior_sigma);
    return {(told * information + prior * other) / (information + other),
            std::sqrt(1 / (information + other))};
}

// Left half red and glossy, right half blue and matt; what photographs say of each pixel is as noisy as it
// says, or `noisier` times that. It was fitted with the general prior.
struct TwoPaints {
    Surface surface{kSize, kSize};
    FitErrors errors{kSize, kSize};
    explicit TwoPaints(double ln_alpha_error, double specular_error, double noisier = 1) {
        Random random(5);
        const WardPrior prior;
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const bool left = x < kSize / 2;
                surface.diffuse(x, y) = left ? Rgb(0.5f, 0.1f, 0.1f) : Rgb(0.1f, 0.1f, 0.5f);
                const auto [ln_alpha, alpha_error] =
                    fitted(std::log(left ? 0.1 : 0.4) + noisier * ln_alpha_error * random.normal(),
                           ln_alpha_error, prior.ln_alpha, prior.ln_alpha_sigma);
                const auto [specular, specular_off] =
                    fitted((left ? 0.08 : 0.02) + noisier * specular_error * random.normal(), specular_error,
                           prior.specular, prior.specular_sigma);
                surface.roughness(x, y) = static_cast<float>(std::exp(ln_alpha));
                surface.specular(x, y) = static_cast<float>(specular);
                surface.confidence(x, y) = 1;
                errors.roughness(x, y) = static_cast<float>(alpha_error * std::exp(ln_alpha));
                errors.specular(x, y) = static_cast<float>(specular_off);
            }
    }
};

WardPrior prior_at(const Surface& surface, const FitErrors& errors, const WardPrior& general, int x, int y) {
    LobePriors priors(surface, errors, general);
    priors.advance(0, surface.height());
    return priors.at(x, y);
}

TEST(LobePrior, IsThatOfTheNeighboursOfTheSameColour) {
    const TwoPaints paints(0.2, 0.01);
    for (const int x : {9, 10, 11}) {  // beside the border
        const WardPrior p = prior_at(paints.surface, paints.errors, {}, x, 12);
        EXPECT_NEAR(p.ln_alpha, std::log(0.1), 0.12);
        EXPECT_NEAR(p.specular, 0.08, 0.006);
    }
    for (const int x : {12, 13, 14}) {
        const WardPrior p = prior_at(paints.surface, paints.errors, {}, x, 12);
        EXPECT_NEAR(p.ln_alpha, std::log(0.4), 0.12);
        EXPECT_NEAR(p.specular, 0.02, 0.006);
    }
}

TEST(LobePrior, IsWeakerWhereNeighboursDiffer) {
    const TwoPaints alike(0.05, 0.003), different(0.05, 0.003, 20);
    const WardPrior a = prior_at(alike.surface, alike.errors, {}, 5, 12),
                    b = prior_at(different.surface, different.errors, {}, 5, 12);
    EXPECT_LT(a.ln_alpha_sigma, 0.25);
    EXPECT_GT(b.ln_alpha_sigma, 0.35);
    EXPECT_GT(b.specular_sigma, 2 * a.specular_sigma);
}

// Each pixel hardly knows more than the prior that all of them were fitted with: what they say together is
// what photographs say, not that prior once more.
TEST(LobePrior, OfNeighboursThatKnowLittleIsNotThePriorTheyWereFittedWith) {
    const TwoPaints paints(1.0, 0.003);
    double left = 0, right = 0, sigma = 0;
    int count = 0;
    for (int y = 6; y < 18; ++y)
        for (const int x : {5, 6}) {
            const WardPrior a = prior_at(paints.surface, paints.errors, {}, x, y),
                            b = prior_at(paints.surface, paints.errors, {}, kSize - 1 - x, y);
            left += a.ln_alpha;
            right += b.ln_alpha;
            sigma += a.ln_alpha_sigma;
            ++count;
        }
    EXPECT_GT(sigma / count, 0.2);  // 1 / sqrt(36 neighbours), and the spread of a material
    EXPECT_LT(sigma / count, 0.4);
    // By the general prior alone, whose weight is that of two of them, means are off by 0.04.
    EXPECT_NEAR(left / count, std::log(0.1), 0.15);
    EXPECT_NEAR(right / count, std::log(0.4), 0.15);
}

TEST(LobePrior, ListensToThosePixelsThatKnow) {
    TwoPaints paints(0.05, 0.003);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize / 2; x += 4) {  // columns that saw no highlight
            paints.surface.roughness(x, y) = 0.6f;
            paints.errors.roughness(x, y) = 0.6f * 0.7f;
            paints.surface.specular(x, y) = 0.5f;
            paints.errors.specular(x, y) = 0.4f;
        }
    const WardPrior p = prior_at(paints.surface, paints.errors, {}, 6, 12);
    EXPECT_NEAR(p.ln_alpha, std::log(0.1), 0.15);
    EXPECT_NEAR(p.specular, 0.08, 0.01);
}

TEST(LobePrior, IsTheGeneralOneWhereNoNeighbourIsAlike) {
    TwoPaints paints(0.05, 0.003);
    const WardPrior general;
    paints.surface.diffuse(6, 6) = Rgb(0.1f, 0.9f, 0.1f);
    WardPrior p = prior_at(paints.surface, paints.errors, general, 6, 6);
    EXPECT_NEAR(p.ln_alpha, general.ln_alpha, 1e-6);
    EXPECT_NEAR(p.specular, general.specular, 1e-6);
    for (float& confidence : paints.surface.confidence.pixels()) confidence = 0;
    p = prior_at(paints.surface, paints.errors, general, 3, 12);
    EXPECT_NEAR(p.ln_alpha, general.ln_alpha, 1e-6);
}

TEST(LobePrior, DoesNotHearThePixelItself) {
    TwoPaints paints(0.05, 0.003);
    const WardPrior before = prior_at(paints.surface, paints.errors, {}, 6, 12);
    paints.surface.roughness(6, 12) = 0.7f;
    paints.surface.specular(6, 12) = 1;
    const WardPrior after = prior_at(paints.surface, paints.errors, {}, 6, 12);
    EXPECT_EQ(before.ln_alpha, after.ln_alpha);
    EXPECT_EQ(before.specular, after.specular);
}

// A lobe that is wide enough looks like matt paint: a pixel that was fitted as one, and has hardly any rho_d
// left, is of the material of its neighbours all the same. A narrow lobe of that strength is another
// material.
TEST(LobePrior, IsThatOfTheNeighboursWhereALobeStandsInForMattPaint) {
    TwoPaints paints(0.05, 0.003);
    paints.surface.diffuse(16, 12) = Rgb(0, 0, 0.35f);
    paints.surface.specular(16, 12) = 0.15f;
    paints.surface.roughness(16, 12) = 0.5f;
    const WardPrior general, p = prior_at(paints.surface, paints.errors, general, 16, 12);
    EXPECT_NEAR(p.ln_alpha, std::log(0.4), 0.12);
    EXPECT_NEAR(p.specular, 0.02, 0.006);
    paints.surface.roughness(16, 12) = 0.2f;
    const WardPrior narrow = prior_at(paints.surface, paints.errors, general, 16, 12);
    EXPECT_GT(narrow.specular_sigma, 3 * p.specular_sigma);
}

TEST(LobePrior, IsTheSameWhereRowsAreOverwrittenOnceTheyWereUsed) {
    const TwoPaints paints(0.2, 0.01);
    LobePriors whole(paints.surface, paints.errors, {});
    whole.advance(0, kSize);
    for (const int rows : {1, 5, 7, 20}) {
        TwoPaints used = paints;
        LobePriors priors(used.surface, used.errors, {});
        for (int y0 = 0; y0 < kSize; y0 += rows) {
            const int y1 = std::min(y0 + rows, kSize);
            priors.advance(y0, y1);
            for (int y = y0; y < y1; ++y)
                for (int x = 0; x < kSize; ++x) {
                    const WardPrior expected = whole.at(x, y), p = priors.at(x, y);
                    ASSERT_EQ(p.ln_alpha, expected.ln_alpha) << x << ", " << y << ", " << rows << " at once";
                    ASSERT_EQ(p.ln_alpha_sigma, expected.ln_alpha_sigma);
                    ASSERT_EQ(p.specular, expected.specular);
                    ASSERT_EQ(p.specular_sigma, expected.specular_sigma);
                    used.surface.roughness(x, y) = used.surface.specular(x, y) = 0.5f;
                    used.surface.diffuse(x, y) = Rgb(0.9f);
                    used.errors.specular(x, y) = 1;
                }
        }
    }
}

}  // namespace
}  // namespace tangi
