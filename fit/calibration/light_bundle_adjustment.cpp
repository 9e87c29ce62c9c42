#include "fit/calibration/light_bundle_adjustment.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <numbers>

#include "fit/calibration/light_bundle_problem.h"
#include "fit/calibration/light_priors.h"
#include "fit/calibration/light_residual.h"
#include "fit/calibration/schur_solver.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

constexpr double kSparse = 500;     // [pixels] of which LightBundleProblem::kDependent was found
constexpr double kRobustScale = 2;  // [sigma] as the pixel fit's, at least
// [sigma] Where the residuals spread by more than sigma: then what is an outlier is not known, and most of
// metal would be one: at 2 sigma coin's minimum is that of a few pixels, and photographs left out are
// predicted 0.8 dB worse (at 4 sigma 0.5, at 5 sigma 0.3).
constexpr double kWideScale = 10;
// Enough for every minimum to be reached (real stacks need 12 to 113 steps): where the search was cut short
// at 40, homographies 1e-5 pixels apart gave lights 10 % and held-out photographs 0.6 dB apart.
constexpr int kIterations = 400;

// Products of beam_terms(), in mean over the pixels: what carries the terms of a beam to its mean square.
using BeamMoments = std::array<double, kJointBeam * kJointBeam>;
BeamMoments beam_moments(const std::vector<LightBundleAdjustment::Pixel>& pixels) {
    BeamMoments moments{};
    for (const LightBundleAdjustment::Pixel& pixel : pixels) {
        const std::array<double, kJointBeam> terms = beam_terms(pixel.position);
        for (std::size_t i = 0; i < moments.size(); ++i)
            moments[i] += terms[i / kJointBeam] * terms[i % kJointBeam] / static_cast<double>(pixels.size());
    }
    return moments;
}

// Whether the start can be evaluated. `robust_scale` [sigma] and `cost` are as in LightBundleAdjustment.
bool minimise(LightBundleProblem& problem, JointStart start, double& robust_scale, double& cost) {
    const auto solved = [&](double tolerance) {
        return solve_by_schur(problem.problem(), problem.eliminated(),
                              {.max_iterations = kIterations, .function_tolerance = tolerance});
    };
    if (start == JointStart::far) {
        problem.set_loss(new ceres::CauchyLoss(LightBundleProblem::kStartScale));
        solved(1e-3);
        robust_scale = problem.spread_of_residuals() > 1 ? kWideScale : kRobustScale;
    }
    // A start near the minimum is that of a trial, which is one of many.
    const double tolerance = start == JointStart::near ? 1e-4 : 1e-5;
    problem.set_loss(new ceres::CauchyLoss(robust_scale));
    SchurSummary summary = solved(tolerance);
    cost = summary.final_cost;
    if (start == JointStart::there) {
        // Also after a wide loss: what the lights' model explains from that minimum on is what tells them.
        // What lies far off is so by the spread that is left there (MM-estimates, Yohai 1987): by sigma
        // alone, most of metal that is no Ward lobe would be.
        const double spread = std::max(1.0, problem.spread_of_residuals());
        problem.set_loss(new ceres::TukeyLoss(LightBundleProblem::kBiweight * spread));
        summary = solved(tolerance);
    }
    return summary.usable;
}

template <class Sigma>
std::vector<double> gain_errors(LightBundleProblem& problem, const SharedCovariance& covariance,
                                const Sigma& sigma) {
    const std::size_t photos = problem.photos();
    std::vector<double> c(photos * photos), row_means(photos);
    double mean = 0;
    const auto n = static_cast<double>(photos);
    for (std::size_t i = 0; i < photos; ++i)
        for (std::size_t j = 0; j < photos; ++j)
            c[i * photos + j] = covariance.at(problem.log_gain(i), 0, problem.log_gain(j), 0);
    for (std::size_t i = 0; i < photos; ++i)
        for (std::size_t j = 0; j < photos; ++j) {
            row_means[i] += c[i * photos + j] / n;
            mean += c[i * photos + j] / (n * n);
        }
    std::vector<double> errors;
    for (std::size_t i = 0; i < photos; ++i)
        errors.push_back(sigma(c[i * photos + i] - 2 * row_means[i] + mean));
    return errors;
}

// Of a problem at its minimum.
LightBundleAdjustment::Errors errors_of(LightBundleProblem& problem, const BeamMoments& moments) {
    const JointFreedom& freedom = problem.freedom();
    // Only ratios of gains are known, and where all are far from the trend nothing else holds the whole.
    if (freedom.gains) problem.problem().SetParameterBlockConstant(problem.log_gain(0));
    const bool directed = freedom.directions != DirectionFreedom::listed;
    const bool rig_moves = freedom.rig || problem.measured();
    LightBundleAdjustment::Errors errors;
    if (!directed && !freedom.beams && !freedom.gains && !rig_moves) return errors;
    const auto covariance = SharedCovariance::of(problem.problem(), problem.eliminated());
    if (!covariance) return errors;
    // The denser the samples are, the more of them share an error.
    const double dependent = LightBundleProblem::kDependent *
                             std::sqrt(std::max(1.0, static_cast<double>(problem.pixels()) / kSparse));
    const auto sigma = [dependent](double variance) {
        return std::sqrt(std::max(dependent * variance, 0.0));
    };
    for (std::size_t i = 0; i < problem.photos(); ++i) {
        const double *turn = problem.turn(i), *beam = problem.beam(i);
        if (directed)
            errors.direction_deg.push_back(
                sigma((covariance->at(turn, 0, turn, 0) + covariance->at(turn, 1, turn, 1)) / 2) * 180 /
                std::numbers::pi);
        double squares = 0;
        for (int k = 0; k < kJointBeam * kJointBeam; ++k)
            squares += covariance->at(beam, k / kJointBeam, beam, k % kJointBeam) *
                       moments[static_cast<std::size_t>(k)];
        if (freedom.beams) errors.beams.push_back(sigma(squares));
    }
    if (freedom.gains) errors.log_gains = gain_errors(problem, *covariance, sigma);
    if (rig_moves) {
        const auto of = [&](int i) { return sigma(covariance->at(problem.rig(), i, problem.rig(), i)); };
        errors.rig = {of(0), of(1), of(2), of(3), of(4), of(5)};
    }
    return errors;
}

}  // namespace

bool LightBundleAdjustment::solve(const JointFreedom& freedom, JointStart start) {
    LightBundleProblem problem(*this, freedom);
    double scale = robust_scale, minimum = 0;
    if (!minimise(problem, start, scale, minimum)) return false;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const double* x = problem.pixel(i);
        pixels[i].slope = {x[0], x[1]};
        pixels[i].ln_alpha = x[2];
        pixels[i].specular = x[3];
        pixels[i].diffuse = x[4];
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
        log_gains[i] = *problem.log_gain(i);
        turns[i] = {problem.turn(i)[0], problem.turn(i)[1]};
        std::copy_n(problem.beam(i), kJointBeam, beams[i].begin());
    }
    std::vector<double> off_trend;
    for (std::size_t i = 0; i < directions.size(); ++i) {
        double off = 0;
        GainPrior{directions[i], 1}(&log_gains[i], problem.trend(), &off);
        off_trend.push_back(std::abs(off));
    }
    gain_scatter = 1.4826 * median(std::move(off_trend));
    robust_scale = scale;
    const double* r = problem.rig();
    rig = {r[0], r[1], r[2], r[3], r[4], r[5]};
    cost = minimum;
    return true;
}

double LightBundleAdjustment::unevenness(std::size_t light) const {
    const BeamMoments moments = beam_moments(pixels);
    double squares = 0;
    for (std::size_t i = 0; i < moments.size(); ++i)
        squares += moments[i] * beams[light][i / kJointBeam] * beams[light][i % kJointBeam];
    return std::sqrt(std::max(squares, 0.0));
}

LightBundleAdjustment::Errors LightBundleAdjustment::errors(const JointFreedom& freedom) const {
    LightBundleProblem problem(*this, freedom);
    problem.set_loss(new ceres::CauchyLoss(robust_scale));
    return errors_of(problem, beam_moments(pixels));
}

}  // namespace tangi
