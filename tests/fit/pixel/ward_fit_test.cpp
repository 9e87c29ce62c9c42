// ward_fit_test.cpp: WardFitter recovers what the samples were made from, and its errors are what it
// says.
#include "fit/pixel/ward_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <limits>

#include "tests/support/fit/fit_test_support.h"

namespace tangi {
namespace {

WardVector random_paint(Random& random) {
    WardVector theta = {0.3 * random.normal(), 0.3 * random.normal(), std::log(random.uniform(0.12, 0.4)),
                        random.uniform(0.03, 0.15)};
    for (int c = 0; c < 3; ++c) theta[static_cast<std::size_t>(kWardCommon + c)] = random.uniform(0.15, 0.9);
    return theta;
}

// What the photographs would say of the paint, without noise. sigma is what is expected of them.
PixelSamples samples_of(const WardVector& theta, int photos, int channels, double sigma) {
    PixelSamples s;
    s.resize(photos, channels);
    const std::vector<Light> lights = dome_lights(photos);
    std::size_t at = 0;
    for (int i = 0; i < photos; ++i) {
        const glm::dvec3 l = glm::normalize(glm::dvec3(lights[static_cast<std::size_t>(i)].direction));
        s.light[static_cast<std::size_t>(i)] = l;
        const WardTerms t = ward_terms(theta.data(), l, {0, 0, 1});
        for (int c = 0; c < channels; ++c, ++at) {
            s.irradiance[at] = 0.75;
            s.value[at] =
                0.75 * (theta[static_cast<std::size_t>(kWardCommon + c)] * t.matt + theta[3] * t.lobe);
            s.sigma[at] = sigma;
        }
    }
    return s;
}

void add_noise(PixelSamples& s, Random& random) {
    for (std::size_t i = 0; i < s.value.size(); ++i)
        s.value[i] = std::max(s.value[i] + s.sigma[i] * random.normal(), 0.0);
}

double angle_deg(const glm::dvec2& slope, const WardVector& theta) {
    const glm::dvec3 a = glm::normalize(glm::dvec3(-slope, 1)),
                     b = glm::normalize(glm::dvec3(-theta[0], -theta[1], 1));
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / kDegree;
}

double quantile(std::vector<double> values, double part) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

WardFitter exact_fitter() {
    WardFitOptions options;
    options.model_error = 0;  // the samples are the model's
    return WardFitter(options);
}

void expect_recovery(int channels) {
    constexpr int kPixels = 500;
    constexpr double kSigma = 0.005;
    Random random(21);
    WardFitter fitter = exact_fitter();
    int inside = 0, near_specular = 0, near_roughness = 0;
    double z2 = 0;
    std::vector<double> diffuse_errors;
    for (int pixel = 0; pixel < kPixels; ++pixel) {
        const WardVector theta = random_paint(random);
        PixelSamples s = samples_of(theta, 40, channels, kSigma);
        add_noise(s, random);
        const WardEstimate e = fitter.fit(s);
        ASSERT_TRUE(e.valid);
        for (int i = 0; i < 2; ++i) {
            const double z = (e.slope[i] - theta[static_cast<std::size_t>(i)]) / e.slope_error;
            inside += std::abs(z) < 1.96;
            z2 += z * z;
        }
        near_specular += std::abs(e.specular - theta[3]) < 4 * e.specular_error;
        near_roughness += std::abs(e.roughness - std::exp(theta[2])) < 4 * e.roughness_error;
        for (int c = 0; c < channels; ++c)
            diffuse_errors.push_back(
                std::abs(e.diffuse[c] - theta[static_cast<std::size_t>(kWardCommon + c)]));
    }
    const double coverage = inside / (2.0 * kPixels), spread = std::sqrt(z2 / (2 * kPixels));
    std::cout << fmt::format(
        "{} channels: slope inside its 95 % interval {:.3f}, rms of error / stated error {:.2f}, "
        "rho_s within 4 errors {:.3f}, alpha {:.3f}, rho_d off by {:.4f} (median)\n",
        channels, coverage, spread, near_specular / double(kPixels), near_roughness / double(kPixels),
        quantile(diffuse_errors, 0.5));
    EXPECT_GE(coverage, 0.85);
    EXPECT_LE(coverage, 1.0);
    EXPECT_GT(spread, 0.5);  // errors that are stated too large would cover everything
    // 4 standard errors hold 99.99 % of a normal distribution; a skewed likelihood in alpha and the prior
    // take some.
    EXPECT_GE(near_specular, 0.95 * kPixels);
    EXPECT_GE(near_roughness, 0.95 * kPixels);
    // 40 samples of mean square n.l 0.4 and irradiance 0.75 leave sigma / 3 = 0.0017 for rho_d alone; sharing
    // them with lobe and slope costs a factor of two or so.
    EXPECT_LT(quantile(diffuse_errors, 0.5), 0.004);
}

TEST(WardFitter, RecoversPaintFromNoisySamplesWithinItsStatedErrors) { expect_recovery(3); }

TEST(WardFitter, RecoversPaintFromGreyPhotographs) { expect_recovery(1); }

TEST(WardFitter, GivesTheSameDiffuseInAllChannelsOfGreyPhotographs) {
    Random random(22);
    WardFitter fitter = exact_fitter();
    const WardEstimate e = fitter.fit(samples_of(random_paint(random), 30, 1, 0.005));
    ASSERT_TRUE(e.valid);
    EXPECT_EQ(e.diffuse[0], e.diffuse[1]);
    EXPECT_EQ(e.diffuse[0], e.diffuse[2]);
    EXPECT_GT(e.diffuse[0], 0.1);
}

TEST(WardFitter, NormalsStandCastShadowsAndClippedHighlights) {
    constexpr int kPixels = 400;
    Random random(23);
    WardFitter fitter{WardFitOptions{}};
    std::vector<double> errors;
    int clipped = 0;
    for (int pixel = 0; pixel < kPixels; ++pixel) {
        WardVector theta = random_paint(random);
        theta[3] *= 2;  // highlights bright enough to clip
        PixelSamples s = samples_of(theta, 40, 3, 0.006);
        // 15 % of the photographs in cast shadow, where a twentieth of the light is left.
        for (int i = 0; i < s.photos(); ++i)
            if (random.uniform() < 0.15)
                for (int c = 0; c < 3; ++c) s.value[static_cast<std::size_t>(3 * i + c)] *= 0.05;
        add_noise(s, random);
        for (std::size_t i = 0; i < s.value.size(); ++i)
            if (s.value[i] >= 0.9) {
                s.value[i] = 0.9;
                s.sigma[i] = 0;
                ++clipped;
            }
        const WardEstimate e = fitter.fit(s);
        ASSERT_TRUE(e.valid);
        errors.push_back(angle_deg(e.slope, theta));
    }
    double mean = 0;
    int within = 0;
    for (const double error : errors) {
        mean += error / kPixels;
        within += error < 1;
    }
    std::cout << fmt::format(
        "15 % shadows, {} clipped values: normals off by {:.3f} deg on average, {:.3f} in the median, {:.1f} "
        "% within 1 "
        "deg, {:.2f} at most\n",
        clipped, mean, quantile(errors, 0.5), 100.0 * within / kPixels, quantile(errors, 1));
    EXPECT_GT(clipped, kPixels);  // more than one a pixel
    // 102 lit samples of relative error 0.008 / 0.5 leave 0.2 deg; where a lobe takes the lit samples and
    // clipping those, single pixels find another minimum.
    EXPECT_LT(mean, 1.0);
    EXPECT_GE(within, 0.9 * kPixels);
}

TEST(WardFitter, FindsNothingWhereEveryPhotographIsDark) {
    WardFitter fitter{WardFitOptions{}};
    PixelSamples s = samples_of({}, 30, 3, 0.006);
    for (double& value : s.value) value = 0;
    EXPECT_FALSE(fitter.fit(s).valid);
}

TEST(WardFitter, FindsNothingWhereEveryValueIsClipped) {
    WardFitter fitter{WardFitOptions{}};
    PixelSamples s = samples_of({0, 0, -1.6, 0, 0.5, 0.5, 0.5}, 30, 3, 0);
    EXPECT_FALSE(fitter.fit(s).valid);
}

void expect_near(const WardEstimate& a, const WardEstimate& b, double tolerance) {
    ASSERT_TRUE(a.valid);
    ASSERT_TRUE(b.valid);
    for (int i = 0; i < 2; ++i) ASSERT_NEAR(a.slope[i], b.slope[i], tolerance);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(a.diffuse[c], b.diffuse[c], tolerance);
    ASSERT_NEAR(a.specular, b.specular, tolerance);
    ASSERT_NEAR(a.roughness, b.roughness, tolerance);
    ASSERT_NEAR(a.slope_error, b.slope_error, tolerance);
    ASSERT_NEAR(a.rms_residual, b.rms_residual, tolerance * 10);
}

// The solver takes the same steps on the same numbers, so results differ only by rounding, which some 20
// steps amplify: 1e-6 leaves room for a factor of 1e9.
constexpr double kRounding = 1e-6;

TEST(WardFitter, DoesNotChangeWhenExposureAndWhiteLevelScaleTogether) {
    Random random(24);
    WardFitter fitter{WardFitOptions{}};
    for (int pixel = 0; pixel < 50; ++pixel) {
        PixelSamples s = samples_of(random_paint(random), 32, 3, 0.005);
        add_noise(s, random);
        const WardEstimate before = fitter.fit(s);
        for (std::size_t i = 0; i < s.value.size(); ++i) {
            s.value[i] *= 3;
            s.irradiance[i] *= 3;
            s.sigma[i] *= 3;
        }
        expect_near(fitter.fit(s), before, kRounding);
        if (testing::Test::HasFatalFailure()) return;
    }
}

TEST(WardFitter, DoesNotDependOnTheOrderOfThePhotographs) {
    Random random(25);
    WardFitter fitter{WardFitOptions{}};
    for (int pixel = 0; pixel < 50; ++pixel) {
        PixelSamples s = samples_of(random_paint(random), 32, 3, 0.005);
        add_noise(s, random);
        const WardEstimate before = fitter.fit(s);
        for (int i = s.photos() - 1; i > 0; --i) {  // Fisher and Yates' shuffle
            const int j = random.below(i + 1);
            std::swap(s.light[static_cast<std::size_t>(i)], s.light[static_cast<std::size_t>(j)]);
            for (int c = 0; c < 3; ++c) {
                const auto a = static_cast<std::size_t>(3 * i + c), b = static_cast<std::size_t>(3 * j + c);
                std::swap(s.value[a], s.value[b]);
                std::swap(s.sigma[a], s.sigma[b]);
                std::swap(s.irradiance[a], s.irradiance[b]);
            }
        }
        expect_near(fitter.fit(s), before, kRounding);
        if (testing::Test::HasFatalFailure()) return;
    }
}

TEST(WardFitter, TurnsItsNormalsWithTheLights) {
    Random random(26);
    WardFitter fitter{WardFitOptions{}};
    for (int pixel = 0; pixel < 50; ++pixel) {
        PixelSamples s = samples_of(random_paint(random), 32, 3, 0.005);
        add_noise(s, random);
        WardEstimate expected = fitter.fit(s);
        expected.slope = {-expected.slope.y, expected.slope.x};
        for (glm::dvec3& l : s.light) l = {-l.y, l.x, l.z};  // by 90 degrees about z
        expect_near(fitter.fit(s), expected, kRounding);
        if (testing::Test::HasFatalFailure()) return;
    }
}

// Gold leaf: hardly a matt part, and a lobe so wide that photometric stereo takes it for one.
TEST(WardFitter, FindsMetalThatHardlyHasAMattPartFromItsHighlight) {
    Random random(29);
    WardFitOptions without;
    without.by_highlight = false;
    WardFitter once(without), twice({});
    int lost = 0, left = 0;
    constexpr int kCount = 200;
    for (int i = 0; i < kCount; ++i) {
        const WardVector gold = {
            random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), std::log(0.3), 0.3, 0.1, 0.08, 0.04};
        PixelSamples s = samples_of(gold, 40, 3, 0.004);
        add_noise(s, random);
        const auto is_lost = [&](const WardEstimate& e) {
            return glm::length(e.slope - glm::dvec2(gold[0], gold[1])) > 0.05;
        };
        const WardEstimate by_stereo = once.fit(s), by_both = twice.fit(s);
        lost += is_lost(by_stereo);
        left += is_lost(by_both);
        EXPECT_LE(by_both.rms_residual, by_stereo.rms_residual * 1.0001);
        const auto start = highlight_start(s, {});
        ASSERT_TRUE(start);
        EXPECT_LT(glm::length(start->slope - glm::dvec2(gold[0], gold[1])), 0.2);
    }
    std::cout << lost << " and " << left << " of " << kCount << " lost\n";
    EXPECT_GE(lost, 10) << "else there is nothing to mend";
    EXPECT_LE(left, lost / 4);
}

TEST(WardFitter, SaysThatFewerPhotographsAreLessCertain) {
    Random random(27);
    WardFitter fitter = exact_fitter();
    const WardVector theta = random_paint(random);
    PixelSamples few = samples_of(theta, 12, 3, 0.005), many = samples_of(theta, 48, 3, 0.005);
    add_noise(few, random);
    add_noise(many, random);
    // Errors fall with the root of the number of photographs: by about 2 here.
    EXPECT_GT(fitter.fit(few).slope_error, 1.4 * fitter.fit(many).slope_error);
}

TEST(WardFitter, StatesLargerErrorsWhereTheModelDoesNotFit) {
    Random random(28);
    WardFitter fitter = exact_fitter();
    PixelSamples s = samples_of(random_paint(random), 40, 3, 0.005);
    PixelSamples wild = s;
    add_noise(s, random);
    for (double& value : wild.value) value *= random.uniform(0.7, 1.3);
    const WardEstimate tame = fitter.fit(s), doubtful = fitter.fit(wild);
    EXPECT_GT(doubtful.rms_residual, 2 * tame.rms_residual);
    EXPECT_GT(doubtful.slope_error, 2 * tame.slope_error);
}

TEST(WardFitter, RefusesOptionsOutsideTheirIntervals) {
    WardFitOptions options;
    options.robust_scale = 0;
    EXPECT_EQ(error_of([&] { WardFitter fitter(options); }),
              "ward_fit.robust_scale = 0 is outside [0.1, 1000] sigma");
}

}  // namespace
}  // namespace tangi
