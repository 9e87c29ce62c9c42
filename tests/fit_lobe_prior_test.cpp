// fit_lobe_prior_test.cpp: neighbours of the same colour say what a pixel's lobe is like.
#include "fit/lobe_prior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/test_support.h"

namespace tangi {
namespace {

constexpr int kSize = 24;

// Left half red and glossy, right half blue and matt; what is known of each pixel is as noisy as it says.
struct TwoPaints {
    Surface surface{kSize, kSize};
    FitErrors errors{kSize, kSize};
    explicit TwoPaints(double ln_alpha_error, double specular_error) {
        Random random(5);
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const bool left = x < kSize / 2;
                surface.diffuse(x, y) = left ? Rgb(0.5f, 0.1f, 0.1f) : Rgb(0.1f, 0.1f, 0.5f);
                const double alpha = (left ? 0.1 : 0.4) * std::exp(ln_alpha_error * random.normal());
                surface.roughness(x, y) = static_cast<float>(alpha);
                surface.specular(x, y) =
                    static_cast<float>((left ? 0.08 : 0.02) + specular_error * random.normal());
                surface.confidence(x, y) = 1;
                errors.roughness(x, y) = static_cast<float>(ln_alpha_error * alpha);
                errors.specular(x, y) = static_cast<float>(specular_error);
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
    const TwoPaints alike(0.05, 0.003), different(0.5, 0.05);
    const WardPrior a = prior_at(alike.surface, alike.errors, {}, 5, 12),
                    b = prior_at(different.surface, different.errors, {}, 5, 12);
    EXPECT_LT(a.ln_alpha_sigma, 0.25);
    EXPECT_GT(b.ln_alpha_sigma, 0.35);
    EXPECT_GT(b.specular_sigma, 2 * a.specular_sigma);
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
