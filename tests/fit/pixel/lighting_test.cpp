// lighting_test.cpp: what the noise model makes of samples, clipped ones among them.
#include "fit/pixel/lighting.h"

#include <gtest/gtest.h>

#include <limits>

namespace tangi {
namespace {

TEST(NoiseModel, LeavesOutWhatIsClipped) {
    const NoiseModel model(Transfer{}, 0.006, true);
    EXPECT_NEAR(model.sigma(0.5f), 0.006, 1e-6);
    EXPECT_GT(model.sigma(0.99f), 0);
    EXPECT_LT(model.sigma(1.0f), 0);  // clipped: a lower bound
    EXPECT_EQ(model.sigma(std::numeric_limits<float>::quiet_NaN()), 0);
    EXPECT_GT(NoiseModel(Transfer{}, 0.006, false).sigma(3.0f), 0);
}

TEST(NoiseModel, TakesTheLevelFromWhichADevelopedStackIsClipped) {
    // A flat field brought values in a dim corner above 1, which are as good as others.
    const NoiseModel model(Transfer{Transfer::Kind::srgb}, 0.01, true, 1.7f);
    EXPECT_GT(model.sigma(1.2f), 0);
    EXPECT_GT(model.sigma(1.69f), 0);
    EXPECT_LT(model.sigma(1.7f), 0);
    // The noise is that of the files: what a step of sRGB is worth in linear light.
    const Transfer srgb{Transfer::Kind::srgb};
    const float stored = srgb.encode(0.2f);
    EXPECT_NEAR(model.sigma(0.2f), (srgb.decode(stored + 0.01f) - srgb.decode(stored - 0.01f)) / 2, 1e-4);
}

}  // namespace
}  // namespace tangi
