#include "surface/maps/gaussian_process.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

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
// [1] Values that tell reach and noise: more know them no better than is worth their cubes.
constexpr std::size_t kTelling = 100;

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
    double reach = 0, noise = 0;  // [1] as above
    double log_likelihood = 0;    // restricted, but for a constant of all
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

    void judge(const MatrixXd& covariances, Hypothesis& h) const {
        VectorXd times = VectorXd::Ones(values_.size());
        for (int round = 0; round < kMostRounds; ++round) {
            const VectorXd next = improved(covariances, times, h);
            const double change = (next.array() / times.array() - 1).abs().maxCoeff();
            times = next;
            if (change < kSettled) break;
        }
    }

private:
    // What is likely with these `times`; returns better ones.
    VectorXd improved(MatrixXd covariances, const VectorXd& times, Hypothesis& h) const {
        const double noise = h.noise;
        covariances.diagonal() += noise * times;
        const Eigen::Index n = values_.size();
        const Eigen::LLT<MatrixXd> factor(covariances);
        const MatrixXd inverse_root = factor.matrixL().solve(MatrixXd::Identity(n, n));
        const VectorXd of_ones = factor.solve(VectorXd::Ones(n));
        const double ones = of_ones.sum();
        h.mean = of_ones.dot(values_) / ones;
        const VectorXd beyond = (values_.array() - h.mean).matrix();
        h.weights = factor.solve(beyond);
        const double free = static_cast<double>(n - 1);
        const double variance = beyond.dot(h.weights) / free + kLeastSigma * kLeastSigma;
        const double log_determinant = 2 * factor.matrixLLT().diagonal().array().log().sum();
        const double of_times = kFreedom * (times.array().log() + 1 / times.array()).sum();
        h.log_likelihood = -(free * std::log(variance) + log_determinant + std::log(ones) + of_times) / 2;
        // What the function leaves of each value, and how far it is itself unsure there: in usual variances.
        const VectorXd own = noise * times;
        const VectorXd left = (own.array() * h.weights.array()).square() / variance + own.array() -
                              own.array().square() * inverse_root.colwise().squaredNorm().transpose().array();
        return (kFreedom + left.array() / noise) / (kFreedom + 1);
    }

    VectorXd values_;
};

std::vector<double> probabilities_of(const std::vector<Hypothesis>& hypotheses) {
    const double most = std::ranges::max_element(hypotheses, {}, &Hypothesis::log_likelihood)->log_likelihood;
    std::vector<double> probabilities;
    for (const Hypothesis& h : hypotheses) probabilities.push_back(std::exp(h.log_likelihood - most));
    const double sum = std::accumulate(probabilities.begin(), probabilities.end(), 0.0);
    for (double& p : probabilities) p /= sum;
    return probabilities;
}

std::vector<Hypothesis> all_hypotheses() {
    std::vector<Hypothesis> hypotheses;
    for (const double reach : kReaches)
        for (const double noise : kNoises)
            hypotheses.push_back(
                {.reach = reach, .noise = noise, .log_likelihood = 0, .mean = 0, .weights = {}});
    return hypotheses;
}

// Under each of the hypotheses, those of one reach side by side.
void judge(std::span<const glm::dvec3> directions, std::span<const double> values,
           std::vector<Hypothesis>& hypotheses) {
    const Values known(values);
    MatrixXd alike;
    double reach = 0;
    for (Hypothesis& h : hypotheses) {
        if (h.reach != reach) alike = covariances(directions, h.reach);
        reach = h.reach;
        known.judge(alike, h);
    }
}

// Those that are left once a part of the values has been heard.
std::vector<Hypothesis> likely_hypotheses(std::span<const glm::dvec3> directions,
                                          std::span<const double> values) {
    std::vector<Hypothesis> hypotheses = all_hypotheses();
    if (values.size() <= kTelling) return hypotheses;
    std::vector<glm::dvec3> some_directions;
    std::vector<double> some_values;
    for (std::size_t i = 0; i < kTelling; ++i) {
        some_directions.push_back(directions[i * values.size() / kTelling]);
        some_values.push_back(values[i * values.size() / kTelling]);
    }
    judge(some_directions, some_values, hypotheses);
    const std::vector<double> probabilities = probabilities_of(hypotheses);
    std::vector<Hypothesis> likely;
    for (std::size_t i = 0; i < hypotheses.size(); ++i)
        if (probabilities[i] > kNegligible) likely.push_back(hypotheses[i]);
    return likely;
}

}  // namespace

GaussianProcess fit_gaussian_process(std::span<const glm::dvec3> directions, std::span<const double> values) {
    TP_REQUIRE(directions.size() == values.size(), "a direction for each value");
    if (values.size() < 2) return {.mean = values.empty() ? 0 : values.front(), .parts = {}};
    std::vector<Hypothesis> hypotheses = likely_hypotheses(directions, values);
    judge(directions, values, hypotheses);
    const std::vector<double> probabilities = probabilities_of(hypotheses);
    GaussianProcess process;
    for (std::size_t i = 0; i < hypotheses.size();) {
        const double reach = hypotheses[i].reach;
        VectorXd weights = VectorXd::Zero(static_cast<Eigen::Index>(values.size()));
        double probability = 0;
        for (; i < hypotheses.size() && hypotheses[i].reach == reach; ++i) {
            probability += probabilities[i];
            weights += probabilities[i] * hypotheses[i].weights;
            process.mean += probabilities[i] * hypotheses[i].mean;
        }
        if (probability > kNegligible) process.parts.push_back({reach, {weights.begin(), weights.end()}});
    }
    return process;
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
