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

// Levenberg-Marquardt: where it is, and how far the next step may lead.
class SchurSearch {
public:
    SchurSearch(const SchurStructure& structure, const SchurOptions& options)
        : s_(structure), options_(options), state_(state_of(structure)), x_(structure.free_parameters()) {
        for (std::size_t i = 0; i < s_.place.size(); ++i)
            x_[static_cast<Eigen::Index>(i)] = state_[static_cast<std::size_t>(s_.place[i])];
        x_ = x_.cwiseMax(s_.lower).cwiseMin(s_.upper);
        place(x_);
    }
    SchurSummary run();
    // Gives the caller's parameters where it is.
    void give_back();

private:
    struct Step {
        VectorXd next;
        double expected = 0;  // fall of the cost
        double length = 0;
        bool finite = false;
    };
    Step next_step();
    void place(const VectorXd& values) {
        for (std::size_t i = 0; i < s_.place.size(); ++i)
            state_[static_cast<std::size_t>(s_.place[i])] = values[static_cast<Eigen::Index>(i)];
    }
    bool take(const Step& step);

    const SchurStructure& s_;
    const SchurOptions& options_;
    std::vector<double> state_;  // of all blocks
    VectorXd x_;                 // free parameters, where it is
    SchurSystem here_, there_;
    ReducedSystem reduced_;
    VectorXd open_, gradient_;  // of the parameters that may move
    VectorXd least_;            // damping is relative to the diagonal, but no less than to this
    double radius_ = kFirstRadius, shrink_ = 2;
};

SchurSearch::Step SchurSearch::next_step() {
    const VectorXd damping = here_.diagonal(s_).cwiseMax(least_).cwiseMin(kLargestDiagonal) / radius_;
    reduced_.reduce(s_, here_, damping, open_);
    const VectorXd step = reduced_.step(s_, here_, open_);
    return {(x_ + step).cwiseMax(s_.lower).cwiseMin(s_.upper),
            (damping.cwiseProduct(step) - gradient_).dot(step) / 2, step.norm(), step.allFinite()};
}

// Goes there, or takes smaller steps from here on; whether that ends the search.
bool SchurSearch::take(const Step& step) {
    double fallen = -std::numeric_limits<double>::infinity();
    bool done = false;
    if (step.finite && step.expected > 0) {
        place(step.next);
        if (there_.evaluate(s_, state_)) fallen = here_.cost - there_.cost;
        done = std::abs(fallen) <= options_.function_tolerance * here_.cost ||
               step.length <= kParameterTolerance * (x_.norm() + kParameterTolerance);
    }
    if (fallen > (done ? 0 : kLeastDecrease * step.expected)) {
        const double quality = 2 * fallen / step.expected - 1;
        radius_ = std::min(radius_ / std::max(1.0 / 3, 1 - quality * quality * quality), kLargestRadius);
        shrink_ = 2;
        x_ = step.next;
        std::swap(here_, there_);
    } else {
        radius_ /= shrink_;
        shrink_ *= 2;
    }
    return done;
}

SchurSummary SchurSearch::run() {
    SchurSummary summary;
    if (!here_.evaluate(s_, state_)) return summary;
    summary.usable = true;
    // A part of what the diagonal was at the start.
    least_ = kLeastDiagonal * (1 + here_.diagonal(s_).cwiseSqrt().array()).square().matrix();
    for (bool done = x_.size() == 0; !done && radius_ >= kSmallestRadius;) {
        if (summary.iterations == options_.max_iterations) break;
        open_ = open_parameters(s_, x_, here_.gradient);
        gradient_ = here_.gradient.cwiseProduct(open_);
        if (gradient_.lpNorm<Eigen::Infinity>() <= kGradientTolerance) break;
        ++summary.iterations;
        done = take(next_step());
    }
    summary.final_cost = here_.cost;
    return summary;
}

void SchurSearch::give_back() {
    place(x_);
    for (const SchurStructure::Block& block : s_.blocks)
        for (const int i : block.free) block.user[i] = state_[static_cast<std::size_t>(block.offset + i)];
}

}  // namespace

SchurSummary solve_by_schur(ceres::Problem& problem, const std::vector<double*>& eliminated,
                            const SchurOptions& options) {
    const SchurStructure structure(problem, eliminated);
    TP_REQUIRE(structure.shared > 0 || structure.owners == 0, "shared parameters that may move");
    SchurSearch search(structure, options);
    const SchurSummary summary = search.run();
    if (summary.usable) search.give_back();
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
