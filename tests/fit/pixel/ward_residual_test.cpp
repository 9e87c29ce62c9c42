// ward_residual_test.cpp: the residuals of one pixel and their derivatives.
#include "fit/pixel/ward_residual.h"

#include <ceres/cost_function.h>
#include <ceres/gradient_checker.h>
#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "surface/reflectance/ward.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr double kRobustScale = 3;

glm::dvec3 normal_at(const WardVector& theta) { return glm::normalize(glm::dvec3(-theta[0], -theta[1], 1)); }

WardVector random_parameters(Random& random, double alpha_min = 0.03, double alpha_max = 0.7) {
    WardVector theta = {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5),
                        random.uniform(std::log(alpha_min), std::log(alpha_max)), random.uniform(0.01, 0.8)};
    for (int c = 0; c < 3; ++c) theta[static_cast<std::size_t>(kWardCommon + c)] = random.uniform(0.05, 1.2);
    return theta;
}

// Lights anywhere above the picture, values that have nothing to do with the model: residuals of all sizes.
PixelSamples random_samples(Random& random, int photos, int channels) {
    PixelSamples s;
    s.resize(photos, channels);
    for (glm::dvec3& light : s.light) light = glm::normalize(glm::dvec3(random.direction(0.02)));
    for (double& ambient : s.ambient) ambient = random.uniform(0, 0.3);
    s.view = glm::normalize(glm::dvec3(random.direction(0.9)));
    for (std::size_t i = 0; i < s.value.size(); ++i) {
        s.irradiance[i] = random.uniform(0.4, 1.5);
        s.value[i] = random.uniform(0, 1);
        s.sigma[i] = random.uniform(0.01, 0.1);
    }
    return s;
}

struct Evaluation {
    std::vector<double> residuals, jacobian;  // jacobian column-major
};

Evaluation evaluated(const WardResiduals& residuals, const WardVector& theta) {
    const auto rows = static_cast<std::size_t>(residuals.size());
    Evaluation e{std::vector<double>(rows), std::vector<double>(rows * kWardParameters)};
    residuals.evaluate(theta.data(), e.residuals.data(), e.jacobian.data());
    return e;
}

// Largest difference between the analytic derivatives and central differences, relative to the largest
// derivative of the row and column or 1. With h = 1e-6 central differences are off by h^2 / 6 of the third
// derivative, which is at most about (4 / alpha)^3 = 2e6 times the value, so 4e-7, and by rounding, 1e-16 / h
// = 1e-10 of the value.
constexpr double kDifferenceError = 1e-5;  // 20 times that; a wrong term is off by O(1)
double worst_difference(const WardResiduals& residuals, const WardVector& theta) {
    constexpr double h = 1e-6;
    const Evaluation here = evaluated(residuals, theta);
    const auto rows = static_cast<std::size_t>(residuals.size());
    double worst = 0;
    for (std::size_t column = 0; column < kWardParameters; ++column) {
        WardVector up = theta, down = theta;
        up[column] += h;
        down[column] -= h;
        const Evaluation above = evaluated(residuals, up), below = evaluated(residuals, down);
        for (std::size_t row = 0; row < rows; ++row) {
            const double numeric = (above.residuals[row] - below.residuals[row]) / (2 * h);
            const double analytic = here.jacobian[column * rows + row];
            const double scale = std::max({1.0, std::abs(analytic), std::abs(here.residuals[row])});
            worst = std::max(worst, std::abs(numeric - analytic) / scale);
        }
    }
    return worst;
}

TEST(WardResiduals, DerivativesAreThoseOfCentralDifferences) {
    Random random(1);
    for (int trial = 0; trial < 100; ++trial) {
        const PixelSamples samples = random_samples(random, 12, 3);
        const WardResiduals residuals(samples, {}, kRobustScale);
        EXPECT_LT(worst_difference(residuals, random_parameters(random)), kDifferenceError) << trial;
    }
}

TEST(WardResiduals, DerivativesHoldForTheNarrowestLobesAtTheirPeak) {
    Random random(2);
    for (int trial = 0; trial < 100; ++trial) {
        const WardVector theta = random_parameters(random, 0.03, 0.05);
        const glm::dvec3 n = normal_at(theta);
        PixelSamples samples = random_samples(random, 12, 3);
        for (glm::dvec3& light :
             samples.light) {  // near the mirror direction, as far off as the lobe is wide
            light = 2 * n.z * n - glm::dvec3(0, 0, 1);
            light =
                glm::normalize(light + 0.1 * glm::dvec3(random.normal(), random.normal(), random.normal()));
        }
        const WardResiduals residuals(samples, {}, kRobustScale);
        EXPECT_LT(worst_difference(residuals, theta), kDifferenceError) << trial;
    }
}

TEST(WardResiduals, DerivativesHoldWhereTheLightGrazesTheSurface) {
    Random random(3);
    for (int trial = 0; trial < 100; ++trial) {
        const WardVector theta = random_parameters(random);
        const glm::dvec3 n = normal_at(theta);
        PixelSamples samples = random_samples(random, 12, 3);
        std::fill(samples.ambient.begin(), samples.ambient.end(), 0.0);
        for (std::size_t i = 0; i < samples.light.size(); ++i) {
            // n.l = 1e-4 or -1e-4: 100 steps of the differences from the kink at 0.
            const glm::dvec3 across = glm::normalize(glm::cross(n, glm::dvec3(random.direction(0.02))));
            samples.light[i] = glm::normalize(across + (i % 2 ? 1e-4 : -1e-4) * n);
        }
        const WardResiduals residuals(samples, {}, kRobustScale);
        EXPECT_LT(worst_difference(residuals, theta), kDifferenceError) << trial;
        const Evaluation e = evaluated(residuals, theta);
        const auto rows = static_cast<std::size_t>(residuals.size());
        for (std::size_t column = 0; column < kWardParameters; ++column) {
            EXPECT_EQ(e.jacobian[column * rows], 0) << "a light below the surface";
        }
    }
}

TEST(WardResiduals, GreySamplesHaveOneDiffuseParameterAndLeaveTheOtherColumnsZero) {
    Random random(4);
    for (int trial = 0; trial < 50; ++trial) {
        const PixelSamples samples = random_samples(random, 12, 1);
        const WardResiduals residuals(samples, {}, kRobustScale);
        EXPECT_EQ(residuals.size(), 12 + 4);
        EXPECT_EQ(residuals.parameters(), kWardCommon + 1);
        const WardVector theta = random_parameters(random);
        EXPECT_LT(worst_difference(residuals, theta), kDifferenceError) << trial;
        const Evaluation e = evaluated(residuals, theta);
        for (std::size_t i = e.residuals.size() * (kWardCommon + 1); i < e.jacobian.size(); ++i)
            ASSERT_EQ(e.jacobian[i], 0);
    }
}

// The residuals as Ceres sees them: row-major derivatives.
class WardCost : public ceres::CostFunction {
public:
    explicit WardCost(const WardResiduals& residuals) : residuals_(residuals) {
        set_num_residuals(residuals.size());
        mutable_parameter_block_sizes()->push_back(kWardParameters);
    }
    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const auto rows = static_cast<std::size_t>(residuals_.size());
        std::vector<double> columns(rows * kWardParameters);
        residuals_.evaluate(parameters[0], residuals, columns.data());
        if (jacobians && jacobians[0])
            for (std::size_t row = 0; row < rows; ++row)
                for (std::size_t column = 0; column < kWardParameters; ++column)
                    jacobians[0][row * kWardParameters + column] = columns[column * rows + row];
        return true;
    }

private:
    const WardResiduals& residuals_;
};

TEST(WardResiduals, DerivativesAreThoseOfCeresGradientChecker) {
    Random random(5);
    ceres::NumericDiffOptions options;
    options.ridders_relative_initial_step_size = 1e-3;
    for (int trial = 0; trial < 40; ++trial) {
        const WardVector theta = random_parameters(random, 0.15);
        PixelSamples samples = random_samples(random, 12, trial % 4 ? 3 : 1);
        const glm::dvec3 n = normal_at(theta);
        // Ridders' first steps of 0.15 % of the slope must not cross the kink at n.l = 0.
        for (glm::dvec3& light : samples.light)
            while (std::abs(glm::dot(n, light)) < 0.02)
                light = glm::normalize(glm::dvec3(random.direction(0.02)));
        // Nearly least squares, and lobes that are not the narrowest: else residuals bend within Ridders'
        // first step of 1e-3 of a slope. The central differences above are finer, and see the loss.
        const WardResiduals residuals(samples, {}, 1000);
        const WardCost cost(residuals);
        const std::vector<const ceres::Manifold*>* no_manifolds = nullptr;
        const ceres::GradientChecker checker(&cost, no_manifolds, options);
        const double* blocks[] = {theta.data()};
        ceres::GradientChecker::ProbeResults results;
        ASSERT_TRUE(checker.Probe(blocks, 1e300, &results)) << results.error_log;
        // Its verdict is relative, and derivatives of 1e-30, far from the lobe, are lost in the rounding of
        // residuals of 10: 1e-15 / step, 1e-10 at Ridders' smallest steps. So its matrices are compared, with
        // 100 times that.
        const ceres::Matrix &analytic = results.jacobians[0], &numeric = results.numeric_jacobians[0];
        for (Eigen::Index row = 0; row < analytic.rows(); ++row)
            for (Eigen::Index column = 0; column < analytic.cols(); ++column)
                EXPECT_NEAR(analytic(row, column), numeric(row, column),
                            1e-8 * std::max(1.0, std::abs(analytic(row, column))))
                    << "trial " << trial << ", row " << row << ", column " << column;
    }
}

TEST(WardResiduals, AreThePlainOnesThroughTheRobustLossAndThePriors) {
    Random random(6);
    const WardPrior prior{.ln_alpha = -1.2,
                          .ln_alpha_sigma = 0.5,
                          .specular = 0.1,
                          .specular_sigma = 0.25,
                          .slope = {0.1, -0.2},
                          .slope_sigma = {0.3, 0.4}};
    const PixelSamples samples = random_samples(random, 10, 3);
    const WardResiduals residuals(samples, prior, kRobustScale);
    const WardVector theta = random_parameters(random);
    const std::size_t count = samples.value.size();
    const Evaluation e = evaluated(residuals, theta);
    const glm::dvec3 n = normal_at(theta);
    for (std::size_t row = 0; row < count; ++row) {
        const WardTerms t = ward_terms(theta.data(), samples.light[row / 3], samples.view);
        const double model =
            samples.irradiance[row] *
            (theta[kWardCommon + row % 3] *
                 (std::max(glm::dot(n, samples.light[row / 3]), 0.0) + samples.ambient[row / 3]) +
             theta[3] * t.lobe);
        const double plain = (model - samples.value[row]) / samples.sigma[row];
        EXPECT_NEAR(e.residuals[row], root_cauchy(plain, kRobustScale).value, 1e-10);
    }
    EXPECT_NEAR(e.residuals[count], (theta[2] + 1.2) / 0.5, 1e-12);
    EXPECT_NEAR(e.residuals[count + 1], (theta[3] - 0.1) / 0.25, 1e-12);
    EXPECT_NEAR(e.residuals[count + 2], (theta[0] - 0.1) / 0.3, 1e-12);
    EXPECT_NEAR(e.residuals[count + 3], (theta[1] + 0.2) / 0.4, 1e-12);
    EXPECT_LT(worst_difference(residuals, theta), kDifferenceError);
}

TEST(WardResiduals, CostIsTheSumOfTheirSquares) {
    Random random(8);
    for (int trial = 0; trial < 50; ++trial) {
        // Many photographs: the product that the cost is computed from has to be folded.
        const PixelSamples samples = random_samples(random, trial % 2 ? 8 : 400, 3);
        const WardResiduals residuals(samples, {.slope = {0.2, 0.1}, .slope_sigma = {0.1, 0.3}},
                                      kRobustScale);
        const WardVector theta = random_parameters(random);
        double sum = 0;
        for (const double r : evaluated(residuals, theta).residuals) sum += r * r;
        EXPECT_NEAR(residuals.cost(theta.data()), sum, 1e-10 * sum);
    }
}

TEST(WardResiduals, DerivativesHoldForEveryLaw) {
    Random random(11);
    for (int trial = 0; trial < 100; ++trial) {
        const PixelSamples samples = random_samples(random, 12, 3);
        const ReflectanceModel reflectance_model{.diffuse_roughness = random.uniform(0, 1),
                                                 .second_lobe_weight = random.uniform(0, 1)};
        const WardResiduals residuals(samples, {}, kRobustScale, reflectance_model);
        // A light as far from the normal as the camera, to 1e-6, would be at a kink; none of these is.
        EXPECT_LT(worst_difference(residuals, random_parameters(random)), kDifferenceError) << trial;
    }
}

TEST(WardResiduals, ClippedValuesAreLowerBounds) {
    Random random(12);
    int below = 0, above = 0;
    for (int trial = 0; trial < 50; ++trial) {
        PixelSamples samples = random_samples(random, 8, 3);
        PixelSamples clipped = samples;
        for (double& sigma : clipped.sigma) sigma = -sigma;
        const WardVector theta = random_parameters(random);
        const WardResiduals plain(samples, {}, kRobustScale), bounds(clipped, {}, kRobustScale);
        const Evaluation a = evaluated(plain, theta), b = evaluated(bounds, theta);
        double sum = 0;
        for (std::size_t i = 0; i < a.residuals.size(); ++i) {
            sum += b.residuals[i] * b.residuals[i];
            if (i >= samples.value.size()) continue;  // the priors
            (a.residuals[i] < 0 ? below : above) += 1;
            EXPECT_EQ(b.residuals[i], std::min(a.residuals[i], 0.0));
        }
        EXPECT_NEAR(bounds.cost(theta.data()), sum, 1e-10 * sum);
        EXPECT_LT(worst_difference(bounds, theta), kDifferenceError) << trial;
    }
    EXPECT_GT(below, 100);
    EXPECT_GT(above, 100);
}

TEST(WardResiduals, SamplesOfSigmaZeroSayNothing) {
    Random random(7);
    PixelSamples samples = random_samples(random, 6, 3);
    for (std::size_t i = 3; i < 6; ++i) samples.sigma[i] = 0;  // the second photograph
    const WardResiduals residuals(samples, {}, kRobustScale);
    const Evaluation e = evaluated(residuals, random_parameters(random));
    for (std::size_t row = 3; row < 6; ++row) {
        EXPECT_EQ(e.residuals[row], 0);
        for (std::size_t column = 0; column < kWardParameters; ++column)
            EXPECT_EQ(e.jacobian[column * e.residuals.size() + row], 0);
    }
    EXPECT_NE(e.residuals[2], 0);
    EXPECT_NE(e.residuals[6], 0);
}

TEST(WardTerms, AgreeWithTheBoundedLobeOfTheSurfaceModule) {
    Random random(8);
    int below = 0, bright = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        const WardVector theta = random_parameters(random);
        const glm::dvec3 n = normal_at(theta), v = glm::normalize(glm::dvec3(random.direction(0.95)));
        glm::dvec3 l = glm::normalize(glm::dvec3(random.direction(0.02)));
        if (trial % 2) l = glm::normalize(2 * glm::dot(n, v) * n - v + 0.1 * l);  // near the peak
        const glm::dvec3 h = l + v;
        const WardAngles<double> angles{glm::dot(n, l), glm::dot(n, v), glm::dot(h, n), glm::dot(h, h)};
        const double expected = std::numbers::pi * std::max(angles.n_l, 0.0) *
                                ward_lobe(WardModel::bounded, angles, std::exp(theta[2]));
        const WardTerms t = ward_terms(theta.data(), l, v);
        EXPECT_NEAR(t.matt, std::max(angles.n_l, 0.0), 1e-12);
        // tan^2 is the difference of two numbers near 1, so it is off by some 1e-16, its quotient by alpha^2
        // by 1e-12.
        EXPECT_NEAR(t.lobe, expected, 1e-10 * (1 + expected));
        below += angles.n_l <= 0;
        bright += expected > 1;
    }
    EXPECT_GT(below, 100);  // both sides of the terminator and the peak have been seen
    EXPECT_GT(bright, 100);
}

// What the fit predicts is what the renderer shows.
TEST(WardTerms, AgreeWithTheRendererForEveryLaw) {
    Random random(13);
    for (int trial = 0; trial < 500; ++trial) {
        const WardVector theta = random_parameters(random, 0.08);
        Surface s(1, 1);
        s.reflectance_model = {.diffuse_roughness = random.uniform(0, 1),
                               .second_lobe_weight = random.uniform(0, 1)};
        s.normal(0, 0) = Vec3(normal_at(theta));
        s.diffuse(0, 0) = Rgb(theta[4], theta[5], theta[6]);
        s.specular(0, 0) = static_cast<float>(theta[3]);
        s.roughness(0, 0) = static_cast<float>(std::exp(theta[2]));
        const Vec3 l = random.direction(0.02), v = random.direction(0.9);
        const WardTerms t = ward_terms(theta.data(), glm::normalize(glm::dvec3(l)),
                                       glm::normalize(glm::dvec3(v)), s.reflectance_model);
        const Rgb shown = reflected(s, 0, 0, l, v, WardModel::bounded);
        if (glm::dot(s.normal(0, 0), v) < 1e-3f) continue;  // not seen
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(shown[c], theta[4 + static_cast<std::size_t>(c)] * t.matt + theta[3] * t.lobe,
                        2e-4 * (1 + shown[c]));
    }
}

}  // namespace
}  // namespace tangi
