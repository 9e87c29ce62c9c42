#include "capture/radiometry/equal_intensity.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "surface/base/error.h"

namespace tangi {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

namespace {

constexpr int kSolverIterations = 200;
constexpr int kStrengthRounds = 3;  // of taking strengths for as equal as they turned out to be
// [1] ln strength by which lights differ at ease: at first, at least and at most.
constexpr double kStrengthSigma = 0.15, kLeastSigma = 0.01, kMostSigma = 0.5;
constexpr double kMost = 0.8, kMostSigmas = 1.2816;  // [1] part of the lights, and what it lies within
constexpr double kFactorSigma = 0.05;   // [1] relative, of factors: shadows, and what is not linear in slopes
constexpr double kMiddlingSigma = 0.2;  // [1] of l.xy / l.z
constexpr double kGlossSigma = 0.2;     // [1] most objects are nearly matt
constexpr double kLnWidth = -1.2, kLnWidthSigma = 0.5;  // [1] oil paint, and its relief
constexpr double kNarrowest = 0.05, kWidest = 0.8;      // [1]

// One photograph: its level, if lights are equally strong, and its factor.
struct PhotoShading {
    double log_level;
    Vector2d r;
    const double* strength_sigma;  // [1] of ln strength
    template <class T>
    bool operator()(const T* g, const T* gloss, const T* t, T* residual) const {
        const T m = sqrt(t[0] * t[0] + t[1] * t[1] + 1e-12);
        const FlatShading<T> flat = flat_shading(m, gloss[1], T(exp(gloss[2])));
        residual[0] = (log_level - gloss[0] - log(flat.level)) / *strength_sigma;
        const T along = flat.response / m;
        const T sigma = kFactorSigma * (0.3 + m);
        residual[1] = (g[0] * r[0] + g[1] * r[1] + g[3] - along * t[0]) / sigma;
        residual[2] = (g[2] * r[1] + g[4] - along * t[1]) / sigma;
        return true;
    }
};

// Each pixel was divided by what it shows under a middling light, which shifts l.xy / l.z by that light's:
// near 0, as lights stand all around. Most objects are as good as matt.
struct LikelyShading {
    template <class T>
    bool operator()(const T* g, const T* gloss, T* residual) const {
        residual[0] = g[3] / kMiddlingSigma;
        residual[1] = g[4] / kMiddlingSigma;
        residual[2] = gloss[1] / kGlossSigma;
        residual[3] = (gloss[2] - kLnWidth) / kLnWidthSigma;
        return true;
    }
};

// All photographs, from one size of l.xy / l.z on.
class StrengthProblem {
public:
    StrengthProblem(const MatrixXd& right, const VectorXd& log_level, bool glossy, double size)
        : log_level_(log_level), t_(static_cast<std::size_t>(right.rows())) {
        const double spread = std::sqrt(right.array().square().sum() / static_cast<double>(right.rows()) / 2);
        g_ = {size / spread, 0, size / spread, 0, 0};
        gloss_ = {log_level.mean(), glossy ? kGlossSigma / 2 : 0, kLnWidth};
        auto* robust = new ceres::CauchyLoss(2);
        for (std::size_t j = 0; j < t_.size(); ++j) {
            const Vector2d r = right.row(static_cast<Index>(j)).transpose();
            t_[j] = {g_[0] * r[0] + 1e-3, g_[2] * r[1]};
            problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<PhotoShading, 3, 5, 3, 2>(
                                          new PhotoShading{log_level[static_cast<Index>(j)], r, &sigma_}),
                                      robust, g_.data(), gloss_.data(), t_[j].data());
        }
        problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<LikelyShading, 4, 5, 3>(new LikelyShading),
                                  nullptr, g_.data(), gloss_.data());
        problem_.SetParameterLowerBound(gloss_.data(), 1, 0);
        problem_.SetParameterLowerBound(gloss_.data(), 2, std::log(kNarrowest));
        problem_.SetParameterUpperBound(gloss_.data(), 2, std::log(kWidest));
        if (!glossy)
            problem_.SetManifold(gloss_.data(), new ceres::SubsetManifold(3, std::vector<int>{1, 2}));
    }

    // [1] - ln likelihood, but for a constant; infinite where there is no solution.
    double solve() {
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_SCHUR;
        options.max_num_iterations = kSolverIterations;
        options.num_threads = 1;  // sums in a fixed order
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        for (int round = 0; round < kStrengthRounds; ++round) {
            if (round > 0) {
                std::vector<double> sizes;
                for (std::size_t j = 0; j < t_.size(); ++j) sizes.push_back(std::abs(log_strength(j)));
                const auto most =
                    sizes.begin() + static_cast<std::ptrdiff_t>(kMost * static_cast<double>(sizes.size()));
                std::nth_element(sizes.begin(), most, sizes.end());
                sigma_ = std::clamp(*most / kMostSigmas, kLeastSigma, kMostSigma);
            }
            ceres::Solve(options, &problem_, &summary);
        }
        if (!summary.IsSolutionUsable() || !(std::abs(g_[0] * g_[2]) > 1e-12))
            return std::numeric_limits<double>::infinity();
        return summary.final_cost + static_cast<double>(t_.size()) * std::log(sigma_);
    }

    EqualStrength found() const {
        EqualStrength result;
        result.g << g_[0], g_[1], 0, g_[2];
        result.gloss = gloss_[1], result.width = std::exp(gloss_[2]);
        result.t.resize(log_level_.size(), 2);
        result.log_strengths.resize(log_level_.size());
        for (std::size_t j = 0; j < t_.size(); ++j) {
            result.t.row(static_cast<Index>(j)) << t_[j][0], t_[j][1];
            result.log_strengths[static_cast<Index>(j)] = log_strength(j);
        }
        return result;
    }

private:
    double log_strength(std::size_t j) const {
        const double m = std::hypot(t_[j][0], t_[j][1]);
        return log_level_[static_cast<Index>(j)] - gloss_[0] -
               std::log(flat_shading(m, gloss_[1], std::exp(gloss_[2])).level);
    }

    const VectorXd& log_level_;
    std::array<double, 5> g_{};      // g, upper triangular, by rows; shift
    std::array<double, 3> gloss_{};  // ln of the common strength, gloss, ln width
    std::vector<std::array<double, 2>> t_;
    double sigma_ = kStrengthSigma;
    ceres::Problem problem_;
};

}  // namespace

EqualStrength by_equal_strength(const MatrixXd& right, const VectorXd& log_level, bool glossy) {
    double least = std::numeric_limits<double>::infinity();
    EqualStrength best;
    for (const double size : {0.3, 1.0, 2.0}) {  // [1] of l.xy / l.z
        StrengthProblem problem(right, log_level, glossy, size);
        const double cost = problem.solve();
        if (!(cost < least)) continue;
        least = cost;
        best = problem.found();
    }
    if (!std::isfinite(least)) fail("no lights of equal strength explain the photographs");
    return best;
}

}  // namespace tangi
