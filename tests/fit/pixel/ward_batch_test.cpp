// ward_batch_test.cpp: the batched kernel against WardFitter, on every instruction set of this machine.
#include "fit/pixel/ward_batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "surface/base/instruction_sets.h"
#include "tests/support/fit/ward_samples.h"
#include "tests/support/instruction_sets.h"

namespace tangi {
namespace {

WardFitOptions plain_options() {
    WardFitOptions options;
    options.model_error = 0;
    return options;
}

// Rendered once: tests take as many of them as they need.
std::vector<PixelSamples> some_pixels(int count, int channels) {
    static const std::vector<PixelSamples> grey = generated_pixels(101, 1), colour = generated_pixels(401, 3);
    const std::vector<PixelSamples>& all = channels == 1 ? grey : colour;
    return {all.begin(), all.begin() + count};
}

std::vector<WardSolution> in_batches(const std::vector<PixelSamples>& pixels, const WardFitOptions& options,
                                     int lanes = kWardLanes) {
    WardBatchFitter fitter(options);
    const int count = static_cast<int>(pixels.size());
    fitter.start(count);
    WardBatch batch;
    for (int first = 0; first < count; first += lanes) {
        batch.resize(pixels[0].photos(), pixels[0].channels, options.prior);
        for (int k = first; k < std::min(first + lanes, count); ++k)
            batch.set(k - first, k, pixels[static_cast<std::size_t>(k)]);
        fitter.fit(batch);
    }
    fitter.finish();
    return fitter.solutions();
}

double cost_at(const PixelSamples& s, const WardFitOptions& options, const WardEstimate& e) {
    const WardVector theta = {e.slope.x,    e.slope.y,    std::log(e.roughness), e.specular,
                              e.diffuse[0], e.diffuse[1], e.diffuse[2]};
    return WardResiduals(s, options.prior, options.robust_scale, options.reflectance_model)
        .cost(theta.data());
}

class WardBatchFit : public OnInstructionSet {};
INSTANTIATE_TEST_SUITE_P(Sets, WardBatchFit, every_instruction_set(), name_of_set);

// `errors`: part of the pixels whose standard errors are to agree.
void expect_agreement(const std::vector<PixelSamples>& pixels, const WardFitOptions& options,
                      double errors = 0.93) {
    const std::vector<WardSolution> solutions = in_batches(pixels, options);
    WardFitOptions one_start = options;
    one_start.by_highlight = false;  // a batch has one start; RowFitter hands out the second
    WardFitter fitter(one_start);
    const int count = static_cast<int>(pixels.size());
    int cost_agrees = 0, slope_agrees = 0, error_agrees = 0, dearer = 0;
    double ours = 0, theirs = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const WardEstimate e = solutions[k].estimate(pixels[k].channels), f = fitter.fit(pixels[k]);
        ASSERT_EQ(e.valid, f.valid);
        if (!f.valid) continue;
        // Both costs by the residuals of WardFitter, in doubles.
        const double cost = cost_at(pixels[k], options, e), reference = cost_at(pixels[k], options, f);
        EXPECT_NEAR(solutions[k].cost, cost, 1e-3 * std::max(cost, 1.0));
        ours += cost;
        theirs += reference;
        cost_agrees += std::abs(cost - reference) <= 0.01 * reference;
        dearer += cost > 1.01 * reference;
        slope_agrees += glm::length(e.slope - f.slope) < 0.01;
        const auto close = [](double a, double b) { return std::abs(a - b) <= 0.03 * b + 1e-4; };
        error_agrees += close(e.slope_error, f.slope_error) && close(e.specular_error, f.specular_error) &&
                        close(e.diffuse_error, f.diffuse_error);
    }
    std::cout << fmt::format(
        "{} pixels: cost within 1 % for {}, dearer {}, slopes within 0.01 for {}, errors "
        "for {}; mean cost {:.4f}, WardFitter's {:.4f}\n",
        count, cost_agrees, dearer, slope_agrees, error_agrees, ours / count, theirs / count);
    EXPECT_GE(cost_agrees, 0.97 * count);
    EXPECT_LE(dearer, 0.02 * count);
    EXPECT_GE(slope_agrees, 0.96 * count);
    EXPECT_GE(error_agrees, errors * count);
    EXPECT_LE(ours, 1.005 * theirs);
}

TEST_P(WardBatchFit, FindsWhatWardFitterFinds) { expect_agreement(some_pixels(401, 3), plain_options()); }

TEST_P(WardBatchFit, FindsItForGreyPhotographs) { expect_agreement(some_pixels(101, 1), plain_options()); }

TEST_P(WardBatchFit, FindsItWithModelErrorRoughDiffuseReflectionAndSecondLobe) {
    WardFitOptions options;
    options.model_error = 0.05;
    options.reflectance_model = {.diffuse_roughness = 0.4, .second_lobe_weight = 0.3};
    // sigma has the model's error in it once already: costs are compared where the fitter's own adds nothing.
    options.model_error = 0;
    expect_agreement(some_pixels(101, 3), options);
}

TEST_P(WardBatchFit, FindsItWithClippedMissingAndShadowedSamples) {
    std::vector<PixelSamples> pixels = some_pixels(101, 3);
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        PixelSamples& s = pixels[k];
        for (std::size_t i = 0; i < s.value.size(); ++i) {
            if ((i / 3 + k) % 11 == 0) s.value[i] = std::numeric_limits<double>::quiet_NaN(), s.sigma[i] = 0;
            // A lower bound, somewhat below what was seen; in one channel only, too.
            if ((i + k) % 7 == 0 && s.sigma[i] > 0) s.value[i] *= 0.9, s.sigma[i] = -s.sigma[i];
        }
        for (std::size_t i = 0; i < s.ambient.size(); ++i) s.ambient[i] = 0.05;
    }
    // A bound that is just met counts or does not: errors of pixels with one jump.
    expect_agreement(pixels, plain_options(), 0.85);
}

TEST_P(WardBatchFit, TakesShadowsAndModelErrorAsWardFitterDoes) {
    std::vector<PixelSamples> pixels = some_pixels(101, 3);
    for (PixelSamples& s : pixels)
        for (std::size_t i = 0; i < s.visible.size(); ++i) s.visible[i] = i % 5 == 0 ? 0.2 : 1.0;
    WardFitOptions options;
    WardFitter fitter(options);
    const std::vector<WardSolution> solutions = in_batches(pixels, options);
    int agrees = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const WardEstimate e = solutions[k].estimate(3), f = fitter.fit(pixels[k]);
        agrees += std::abs(e.rms_residual / f.rms_residual - 1) < 0.005;
    }
    EXPECT_GE(agrees, 97);
}

TEST_P(WardBatchFit, LeavesWhatCannotBeMeasured) {
    std::vector<PixelSamples> pixels = some_pixels(18, 3);
    for (double& v : pixels[3].value) v = 0;  // dark under every light
    for (double& v : pixels[7].sigma) v = 0;  // nothing usable
    for (std::size_t i = 6; i < pixels[9].sigma.size(); ++i) pixels[9].sigma[i] = 0;     // two lights
    for (std::size_t i = 12; i < pixels[11].sigma.size(); ++i) pixels[11].sigma[i] = 0;  // four
    const WardFitOptions options = plain_options();
    WardFitter fitter(options);
    const std::vector<WardSolution> solutions = in_batches(pixels, options);
    for (const std::size_t k : {3u, 7u, 9u}) {
        EXPECT_FALSE(solutions[k].valid) << k;
        EXPECT_FALSE(fitter.fit(pixels[k]).valid) << k;
    }
    EXPECT_EQ(solutions[11].valid, fitter.fit(pixels[11]).valid);
    EXPECT_TRUE(solutions[0].valid);
}

TEST_P(WardBatchFit, GivesTheSameBitsWhateverAPixelsNeighboursAre) {
    const std::vector<PixelSamples> pixels = some_pixels(67, 3);
    const auto together = in_batches(pixels, plain_options());
    for (const int lanes : {1, 5, 13}) {
        const auto apart = in_batches(pixels, plain_options(), lanes);
        for (std::size_t k = 0; k < pixels.size(); ++k) {
            EXPECT_EQ(apart[k].theta, together[k].theta) << lanes << " lanes, pixel " << k;
            EXPECT_EQ(apart[k].slope_error, together[k].slope_error);
            EXPECT_EQ(apart[k].iterations, together[k].iterations);
        }
    }
}

TEST_P(WardBatchFit, StaysInsideItsBoundsOnNoise) {
    // Values that no surface has: what is found must be finite and in range, and doubtful where not
    // converged.
    std::vector<PixelSamples> pixels = some_pixels(48, 3);
    std::uint64_t state = 1;
    for (PixelSamples& s : pixels)
        for (double& v : s.value) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            v = std::ldexp(static_cast<double>(state >> 40), -24);
        }
    const WardFitOptions options = plain_options();
    for (const WardSolution& s : in_batches(pixels, options)) {
        if (!s.valid) continue;
        for (int i = 0; i < kWardParameters; ++i) {
            const auto [low, high] = ward_interval(options.bounds, i);
            EXPECT_GE(s.theta[static_cast<std::size_t>(i)], low - 1e-6);
            EXPECT_LE(s.theta[static_cast<std::size_t>(i)], high + 1e-6);
        }
        EXPECT_TRUE(std::isfinite(s.cost));
        EXPECT_TRUE(s.converged || s.doubtful);
    }
}

TEST(WardBatchSets, WithFusedProductsGiveTheSameBits) {
    const std::vector<PixelSamples> pixels = some_pixels(67, 3);
    std::vector<WardSolution> first;
    std::string name;
    for (const std::string& set : instruction_sets()) {
        if (set.starts_with("SS") || set == "SCALAR" || set == "EMU128") continue;  // not fused
        use_instruction_set(set);
        const auto solutions = in_batches(pixels, plain_options());
        if (first.empty()) {
            first = solutions;
            name = set;
            continue;
        }
        for (std::size_t k = 0; k < pixels.size(); ++k)
            EXPECT_EQ(solutions[k].theta, first[k].theta) << set << " and " << name << ", pixel " << k;
    }
    use_instruction_set("");
    if (name.empty()) GTEST_SKIP() << "this machine has no instruction set with fused products";
}

}  // namespace
}  // namespace tangi
