// ward_agreement_test.cpp: WardFitter against Ceres' full solver: other parameters, other bounds, other
// loss code, automatic derivatives of another implementation of the lobe, the same minimum.
#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>

#include "fit/pixel/ward_fit.h"
#include "surface/reflectance/ward.h"
#include "tests/support/fit/ward_samples.h"

namespace tangi {
namespace {

// One sample: (model - value) / sigma with surface/reflectance/ward.h's lobe, in natural parameters.
struct SampleCost {
    glm::dvec3 light;
    double irradiance, value, sigma;

    template <class T>
    bool operator()(const T* common, const T* diffuse, T* residual) const {
        using std::exp;
        using std::sqrt;
        const T inverse = T(1) / sqrt(T(1) + common[0] * common[0] + common[1] * common[1]);
        const T n_l = (light.z - common[0] * light.x - common[1] * light.y) * inverse;
        const WardAngles<T> angles{n_l, inverse, n_l + inverse, T(2 + 2 * light.z)};
        const T alpha = exp(common[2]);
        T model(0);
        if (n_l > T(0))
            model =
                irradiance * n_l *
                (diffuse[0] + T(std::numbers::pi) * common[3] * ward_lobe(WardModel::bounded, angles, alpha));
        residual[0] = (model - value) / sigma;
        return true;
    }
};

struct PriorCost {
    WardPrior prior;
    template <class T>
    bool operator()(const T* common, T* residuals) const {
        residuals[0] = (common[2] - prior.ln_alpha) / prior.ln_alpha_sigma;
        residuals[1] = (common[3] - prior.specular) / prior.specular_sigma;
        return true;
    }
};

WardVector by_ceres(const PixelSamples& s, const WardFitOptions& options) {
    WardVector theta = start_of(s, options);
    for (int i = 0; i < kWardParameters; ++i) {
        const auto [low, high] = ward_interval(options.bounds, i);
        theta[static_cast<std::size_t>(i)] = std::clamp(theta[static_cast<std::size_t>(i)], low, high);
    }
    double* common = theta.data();
    ceres::Problem problem;
    for (std::size_t i = 0; i < s.value.size(); ++i) {
        const auto channels = static_cast<std::size_t>(s.channels);
        if (!(s.sigma[i] > 0)) continue;
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<SampleCost, 1, kWardCommon, 1>(
                new SampleCost{s.light[i / channels], s.irradiance[i], s.value[i], s.sigma[i]}),
            new ceres::CauchyLoss(options.robust_scale), common, common + kWardCommon + i % channels);
    }
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PriorCost, 2, kWardCommon>(new PriorCost{options.prior}), nullptr,
        common);
    for (int i = 0; i < kWardCommon + s.channels; ++i) {
        const auto [low, high] = ward_interval(options.bounds, i);
        double* block = i < kWardCommon ? common : common + i;
        const int within = i < kWardCommon ? i : 0;
        problem.SetParameterLowerBound(block, within, low);
        problem.SetParameterUpperBound(block, within, high);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.max_num_iterations = 200;
    solver.function_tolerance = 1e-9;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    return theta;
}

WardVector by_fitter(WardFitter& fitter, const PixelSamples& s) {
    const WardEstimate e = fitter.fit(s);
    EXPECT_TRUE(e.valid);
    return {e.slope.x,    e.slope.y,    std::log(e.roughness), e.specular,
            e.diffuse[0], e.diffuse[1], e.diffuse[2]};
}

void expect_agreement(int count, int channels) {
    WardFitOptions options;
    options.model_error = 0;
    WardFitter fitter(options);
    int equal = 0, worse = 0, better = 0;
    for (const PixelSamples& s : generated_pixels(count, channels)) {
        const double ours = robust_cost(s, options, by_fitter(fitter, s));
        const double theirs = robust_cost(s, options, by_ceres(s, options));
        equal += std::abs(ours - theirs) <= 1e-3 * theirs;
        worse += ours > 1.01 * theirs;
        better += ours < 0.99 * theirs;
    }
    std::cout << fmt::format(
        "{} channels, {} pixels: cost equal within 0.1 % for {:.1f} %, worse by more than 1 % "
        "than ceres::Problem for {:.1f} %, better for {:.1f} %\n",
        channels, count, 100.0 * equal / count, 100.0 * worse / count, 100.0 * better / count);
    // Two solvers may end in different local minima, but not often.
    EXPECT_GE(equal, 0.9 * count);
    EXPECT_LE(worse, 0.05 * count);
}

TEST(WardFitterAgreement, FindsTheMinimumThatCeresProblemFinds) { expect_agreement(200, 3); }

TEST(WardFitterAgreement, FindsItForGreyPhotographs) { expect_agreement(100, 1); }

}  // namespace
}  // namespace tangi
