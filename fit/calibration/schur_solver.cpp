#include "fit/calibration/schur_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/calibration/schur_system.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// As ceres::Solver::Options has them.
constexpr double kFirstRadius = 1e4, kLargestRadius = 1e16, kSmallestRadius = 1e-32;
constexpr double kLeastDiagonal = 1e-6, kLargestDiagonal = 1e32;
constexpr double kLeastDecrease = 1e-3;
constexpr double kGradientTolerance = 1e-10, kParameterTolerance = 1e-8;
// [1] Least part of a shared parameter's J^T J that is left without the others and no rounding.
constexpr double kLeastPivot = 1e-12;

std::vector<double> state_of(const SchurStructure& s) {
    std::vector<double> state;
    for (const SchurStructure::Block& block : s.blocks)
        state.insert(state.end(), block.user, block.user + block.size);
    return state;
}

// 1 for parameters that may move; 0 for those at a bound that the gradient pushes them over.
VectorXd open_parameters(const SchurStructure& s, const VectorXd& x, const VectorXd& gradient) {
    VectorXd open(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i)
        open[i] = !((x[i] <= s.lower[i] && gradient[i] > 0) || (x[i] >= s.upper[i] && gradient[i] < 0));
    return open;
}

}  // namespace

SchurSummary solve_by_schur(ceres::Problem& problem, const std::vector<double*>& eliminated,
                            const SchurOptions& options) {
    const SchurStructure s(problem, eliminated);
    TP_REQUIRE(s.shared > 0 || s.owners == 0, "shared parameters that may move");
    std::vector<double> state = state_of(s);
    const auto place = [&](const VectorXd& values) {
        for (std::size_t i = 0; i < s.place.size(); ++i)
            state[static_cast<std::size_t>(s.place[i])] = values[static_cast<Eigen::Index>(i)];
    };
    SchurSystem here, there;
    ReducedSystem reduced;
    SchurSummary summary;
    VectorXd x(s.free_parameters());
    for (std::size_t i = 0; i < s.place.size(); ++i)
        x[static_cast<Eigen::Index>(i)] = state[static_cast<std::size_t>(s.place[i])];
    x = x.cwiseMax(s.lower).cwiseMin(s.upper);
    place(x);
    if (!here.evaluate(s, state)) return summary;
    summary.usable = true;
    // Damping is relative to the diagonal, but no less than to a part of what that was at the start.
    const VectorXd least = kLeastDiagonal * (1 + here.diagonal(s).cwiseSqrt().array()).square().matrix();
    double radius = kFirstRadius, shrink = 2;
    for (bool done = x.size() == 0; !done && radius >= kSmallestRadius;) {
        if (summary.iterations == options.max_iterations) break;
        const VectorXd open = open_parameters(s, x, here.gradient);
        const VectorXd gradient = here.gradient.cwiseProduct(open);
        if (gradient.lpNorm<Eigen::Infinity>() <= kGradientTolerance) break;
        ++summary.iterations;
        const VectorXd damping = here.diagonal(s).cwiseMax(least).cwiseMin(kLargestDiagonal) / radius;
        reduced.reduce(s, here, damping, open);
        const VectorXd step = reduced.step(s, here, open);
        const VectorXd next = (x + step).cwiseMax(s.lower).cwiseMin(s.upper);
        const double expected = (damping.cwiseProduct(step) - gradient).dot(step) / 2;
        double fallen = -std::numeric_limits<double>::infinity();
        if (step.allFinite() && expected > 0) {
            place(next);
            if (there.evaluate(s, state)) fallen = here.cost - there.cost;
            done = std::abs(fallen) <= options.function_tolerance * here.cost ||
                   step.norm() <= kParameterTolerance * (x.norm() + kParameterTolerance);
        }
        if (fallen > (done ? 0 : kLeastDecrease * expected)) {
            const double quality = 2 * fallen / expected - 1;
            radius = std::min(radius / std::max(1.0 / 3, 1 - quality * quality * quality), kLargestRadius);
            shrink = 2;
            x = next;
            std::swap(here, there);
        } else {
            radius /= shrink;
            shrink *= 2;
        }
    }
    summary.final_cost = here.cost;
    place(x);
    for (const SchurStructure::Block& block : s.blocks)
        for (const int i : block.free) block.user[i] = state[static_cast<std::size_t>(block.offset + i)];
    return summary;
}

std::optional<SharedCovariance> SharedCovariance::of(const ceres::Problem& problem,
                                                     const std::vector<double*>& eliminated) {
    const SchurStructure s(problem, eliminated);
    SchurSystem system;
    if (!system.evaluate(s, state_of(s))) return {};
    ReducedSystem reduced;
    reduced.reduce(s, system, VectorXd::Zero(s.free_parameters()), VectorXd::Ones(s.free_parameters()));
    const VectorXd scale = system.shared.diagonal().cwiseSqrt().cwiseInverse();
    if (!scale.allFinite() || !reduced.matrix.allFinite()) return {};
    const MatrixXd scaled = scale.asDiagonal() * reduced.matrix * scale.asDiagonal();
    const Eigen::LLT<MatrixXd> factors = scaled.selfadjointView<Eigen::Lower>().llt();
    if (factors.info() != Eigen::Success) return {};
    const MatrixXd lower = factors.matrixL();
    if (s.shared > 0 && !(lower.diagonal().array().square().minCoeff() > kLeastPivot)) return {};
    SharedCovariance result;
    result.covariance_ =
        scale.asDiagonal() * factors.solve(MatrixXd::Identity(s.shared, s.shared)) * scale.asDiagonal();
    for (const SchurStructure::Block& block : s.blocks) {
        std::vector<int> columns(static_cast<std::size_t>(block.size), -1);
        int column = block.column;
        for (const int i : block.free)
            if (block.owner < 0) columns[static_cast<std::size_t>(i)] = column++;
        result.columns_[block.user] = std::move(columns);
    }
    return result;
}

double SharedCovariance::at(const double* block, int i, const double* other, int j) const {
    const int row = columns_.at(block)[static_cast<std::size_t>(i)];
    const int column = columns_.at(other)[static_cast<std::size_t>(j)];
    return row < 0 || column < 0 ? 0 : covariance_(row, column);
}

}  // namespace tangi
