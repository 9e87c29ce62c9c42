// specular_error_test.cpp: what is said of rho_s where alpha is not known.
#include "fit/pixel/specular_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

TEST(LobeError, IsTheRootOfTheVarianceWhereAlphaIsKnown) {
    const double alpha = 0.15, rho = 0.05;
    EXPECT_NEAR(specular_error(rho, std::log(alpha), {.specular = 1e-6}, {}), 1e-3, 1e-9);
    // Alpha to 3 %: half a hundredth more.
    const double error = specular_error(rho, std::log(alpha),
                                        {.ln_alpha = 9e-4, .specular = 1e-6, .both = 0.5 * 0.03 * 1e-3}, {});
    EXPECT_GE(error, 1e-3);
    EXPECT_LT(error, 1.01e-3);
}

// By drawing ln alpha and the peak at random: alpha to a factor of 1.3 and 1.6, in the middle of its bounds
// and near the wider one.
TEST(LobeError, IsTheSpreadOfRhoSWherePeakAndAlphaAreIndependent) {
    const WardBounds bounds;
    for (const double alpha : {0.1, 0.2, 0.4})
        for (const double sigma : {0.25, 0.45}) {
            const double rho = 0.004, peak_sigma = 0.5 * rho;  // of the peak, times alpha^2
            Random random(3);
            double square = 0;
            constexpr int kDraws = 100000;
            for (int i = 0; i < kDraws; ++i) {
                const double other = std::clamp(std::log(alpha) + sigma * random.normal(),
                                                std::log(bounds.alpha_min), std::log(bounds.alpha_max));
                const double drawn =
                    (rho + peak_sigma * random.normal()) * std::exp(2 * (other - std::log(alpha)));
                square += (drawn - rho) * (drawn - rho) / kDraws;
            }
            // What the Gaussian around the solution has: rho_s = peak alpha^2.
            const double linear = std::hypot(peak_sigma, 2 * rho * sigma);
            const double error = specular_error(
                rho, std::log(alpha),
                {.ln_alpha = sigma * sigma, .specular = linear * linear, .both = 2 * rho * sigma * sigma},
                bounds);
            EXPECT_NEAR(error / std::sqrt(square), 1, 0.2) << alpha << ", " << sigma;
            EXPECT_GE(error, linear);
        }
}

TEST(LobeError, IsFiniteWhereNothingIsKnown) {
    const double error =
        specular_error(0.01, std::log(0.2), {.ln_alpha = 1e4, .specular = 1e4, .both = -1e3}, {});
    EXPECT_TRUE(std::isfinite(error));
    EXPECT_GE(error, 100);
    EXPECT_EQ(specular_error(0, std::log(0.2), {}, {}), 0);
}

}  // namespace
}  // namespace tangi
