#include "surface/maps/gaussian_process.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/base/error.h"

namespace tangi {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// What is averaged over. From lights side by side to far beyond the hemisphere, where there is but a trend;
// and from a function that is known as it stands to noise alone.
constexpr std::array kReaches = {0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4};  // [1]
constexpr std::array kNoises = {1e-4, 1e-3, 1e-2, 1e-1,
                                1.0,  1e1,  1e2,  1e3};  // [1] variances, of the function's
constexpr double kFreedom = 4;                           // degrees, of Student's distribution
constexpr int kMostRounds = 12;       // of the noise of single values, which by then hardly change
constexpr double kSettled = 0.02;     // [1] change of that noise, relative
constexpr double kLeastSigma = 1e-4;  // [unit of the values] of noise: equal values have a likelihood, too
constexpr double kNegligible = 1e-3;  // [1] probability of what is left out

double covariance(double distance, double reach) {
    const double s = std::sqrt(5.0) * distance / reach;
    return (1 + s + s * s / 3) * std::exp(-s);
}

MatrixXd covariances(std::span<const glm::dvec3> directions, double reach) {
    const auto n = static_cast<Eigen::Index>(directions.size());
    MatrixXd k(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j <= i; ++j)
            k(i, j) = k(j, i) = covariance(glm::distance(directions[static_cast<std::size_t>(i)],
                                                         directions[static_cast<std::size_t>(j)]),
                                           reach);
    return k;
}

// The values under one reach and one noise.
struct Hypothesis {
    double log_likelihood = 0;  // restricted, but for a constant of all
    double mean = 0;
    VectorXd weights;
};

// Student's noise is Gaussian noise whose variance is, of each value, unknown: `times` the usual one. Finds
// both by a lower bound of the likelihood (variational Bayes: Tipping and Lawrence 2005, "Variational
// inference for Student-t models").
class Values {
public:
    explicit Values(std::span<const double> values)
        : values_(Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()))) {}

    // `noise`: the usual variance of a value, beside the function's.
    Hypothesis judged(const MatrixXd& covariances, double noise) const {
        VectorXd times = VectorXd::Ones(values_.size());
        Hypothesis h;
        for (int round = 0; round < kMostRounds; ++round) {
            const VectorXd next = improved(covariances, noise, times, h);
            const double change = (next.array() / times.array() - 1).abs().maxCoeff();
            times = next;
            if (change < kSettled) break;
        }
        return h;
    }

private:
    // What is likely with these `times`; returns better ones.
    VectorXd improved(MatrixXd covariances, double noise, const VectorXd& times, Hypothesis& h) const {
        covariances.diagonal() += noise * times;
        const Eigen::Index n = values_.size();
        const Eigen::LLT<MatrixXd> factor(covariances);
        const MatrixXd inverse = factor.solve(MatrixXd::Identity(n, n));
        const VectorXd of_ones = inverse.rowwise().sum();
        const double ones = of_ones.sum();
        h.mean = of_ones.dot(values_) / ones;
        const VectorXd beyond = (values_.array() - h.mean).matrix();
        h.weights = inverse * beyond;
        const double free = static_cast<double>(n - 1);
        const double variance = beyond.dot(h.weights) / free + kLeastSigma * kLeastSigma;
        const double log_determinant = 2 * factor.matrixLLT().diagonal().array().log().sum();
        const double of_times = kFreedom * (times.array().log() + 1 / times.array()).sum();
        h.log_likelihood = -(free * std::log(variance) + log_determinant + std::log(ones) + of_times) / 2;
        // What the function leaves of each value, and how far it is itself unsure there: in usual variances.
        const VectorXd own = noise * times;
        const VectorXd left = (own.array() * h.weights.array()).square() / variance + own.array() -
                              own.array().square() * inverse.diagonal().array();
        return (kFreedom + left.array() / noise) / (kFreedom + 1);
    }

    VectorXd values_;
};

// The average over all hypotheses, noises first.
GaussianProcess average(const std::vector<Hypothesis>& hypotheses) {
    const auto most = std::ranges::max_element(hypotheses, {}, &Hypothesis::log_likelihood);
    double sum = 0;
    for (const Hypothesis& h : hypotheses) sum += std::exp(h.log_likelihood - most->log_likelihood);
    GaussianProcess process;
    for (std::size_t r = 0; r < kReaches.size(); ++r) {
        VectorXd weights = VectorXd::Zero(most->weights.size());
        double probability = 0;
        for (std::size_t k = 0; k < kNoises.size(); ++k) {
            const Hypothesis& h = hypotheses[r * kNoises.size() + k];
            const double p = std::exp(h.log_likelihood - most->log_likelihood) / sum;
            probability += p;
            weights += p * h.weights;
            process.mean += p * h.mean;
        }
        if (probability > kNegligible)
            process.parts.push_back({kReaches[r], {weights.begin(), weights.end()}});
    }
    return process;
}

}  // namespace

GaussianProcess fit_gaussian_process(std::span<const glm::dvec3> directions, std::span<const double> values) {
    TP_REQUIRE(directions.size() == values.size(), "a direction for each value");
    if (values.size() < 2) return {.mean = values.empty() ? 0 : values.front(), .parts = {}};
    const Values known(values);
    std::vector<Hypothesis> hypotheses;
    for (const double reach : kReaches) {
        const MatrixXd alike = covariances(directions, reach);
        for (const double noise : kNoises) hypotheses.push_back(known.judged(alike, noise));
    }
    return average(hypotheses);
}

double predicted(const GaussianProcess& process, std::span<const glm::dvec3> directions,
                 const glm::dvec3& direction) {
    double value = process.mean;
    for (const GaussianProcess::Part& part : process.parts)
        for (std::size_t k = 0; k < std::min(part.weights.size(), directions.size()); ++k)
            value += part.weights[k] * covariance(glm::distance(direction, directions[k]), part.reach);
    return value;
}

}  // namespace tangi
