// fit_ward_agreement_test.cpp: WardFitter against Ceres' full solver: other parameters, other bounds, other
// loss code, automatic derivatives of another implementation of the lobe, the same minimum.
#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <limits>

#include "datasets/generator.h"
#include "fit/ward_fit.h"
#include "surface/ward.h"
#include "test_support.h"

namespace tangi {
namespace {

// One sample: (model - value) / sigma with surface/ward.h's lobe, in natural parameters.
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

double robust_cost(const PixelSamples& samples, const WardFitOptions& options, const WardVector& theta) {
    const WardResiduals residuals(samples, options.prior, options.robust_scale);
    std::vector<double> r(static_cast<std::size_t>(residuals.size()));
    residuals.evaluate(theta.data(), r.data(), nullptr);
    double sum = 0;
    for (const double value : r) sum += value * value;
    return sum;
}

// Where WardFitter starts: photometric stereo, and the best of five widths with the rho_s that suits each.
WardVector start_of(const PixelSamples& s, const WardFitOptions& options) {
    const LambertEstimate matt = photometric_stereo(s);
    WardVector best{};
    double best_cost = std::numeric_limits<double>::infinity();
    for (const double alpha : {0.06, 0.12, 0.2, 0.32, 0.5}) {
        WardVector theta = {-matt.normal.x / matt.normal.z,
                            -matt.normal.y / matt.normal.z,
                            std::log(alpha),
                            0,
                            matt.diffuse[0],
                            matt.diffuse[1],
                            matt.diffuse[2]};
        double numerator = 0, denominator = 0;
        for (std::size_t i = 0; i < s.value.size(); ++i) {
            if (!(s.sigma[i] > 0)) continue;
            const auto channels = static_cast<std::size_t>(s.channels);
            const WardTerms t = ward_terms(theta.data(), s.light[i / channels], s.view);
            const double lobe = s.irradiance[i] * t.lobe / s.sigma[i];
            const double left = s.value[i] - s.irradiance[i] * theta[kWardCommon + i % channels] * t.n_l;
            numerator += lobe * left / s.sigma[i];
            denominator += lobe * lobe;
        }
        theta[3] =
            denominator > 0 ? std::clamp(numerator / denominator, 0.002, options.bounds.specular_max) : 0.002;
        const double cost = robust_cost(s, options, theta);
        if (cost < best_cost) {
            best_cost = cost;
            best = theta;
        }
    }
    return best;
}

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

// Pixels of a generated stack: GGX, cast shadows, sensor noise. sigma has the model's error in it already, so
// that WardFitter is run without its own and both solvers see the same.
std::vector<PixelSamples> generated_pixels(int count, int channels) {
    const PaintingTruth truth = procedural_painting({.width = 64, .height = 48});
    GeneratorOptions options;
    options.lights = 40;
    const Photography photography = photography_of(truth, options);
    Random random(77);
    std::vector<glm::ivec2> places;
    for (int i = 0; i < count; ++i) places.emplace_back(random.below(64), random.below(48));
    std::vector<PixelSamples> pixels(places.size());
    for (PixelSamples& s : pixels) s.resize(options.lights, channels);
    for (int i = 0; i < options.lights; ++i) {
        const Light& light = photography.photos[static_cast<std::size_t>(i)].light;
        const Image<Rgb> photo = apply_sensor(render_photo(truth, light, options), options, i);
        for (std::size_t k = 0; k < places.size(); ++k) {
            PixelSamples& s = pixels[k];
            s.light[static_cast<std::size_t>(i)] = light.direction;
            for (int c = 0; c < channels; ++c) {
                const auto at = static_cast<std::size_t>(i * channels + c);
                s.value[at] = photo(places[k].x, places[k].y)[c];
                s.irradiance[at] = options.white_level;
                s.sigma[at] = s.value[at] > 0.99 ? 0 : std::hypot(0.006, 0.05 * s.value[at]);
            }
        }
    }
    return pixels;
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
