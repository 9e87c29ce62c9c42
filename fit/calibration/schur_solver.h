// schur_solver.h: Levenberg-Marquardt for a ceres::Problem in which many small blocks (pixels) meet each
// other only through a few shared ones (lights): the small ones are eliminated first (Schur complement:
// Triggs et al. 2000, "Bundle adjustment: a modern synthesis", sec. 6.1).
//
// Scaling, damping and stops are those of ceres::Solve() with DENSE_SCHUR, and so are the minima; it is
// several times faster where blocks have few parameters, as sums go into dense rows of each small block
// instead of a matrix of blocks, and up to eight threads work on one problem.
// What differs: a parameter at a bound that the gradient pushes it over is left out of the step, where Ceres
// searches along the line.
#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

namespace tangi {

struct SchurOptions {
    int max_iterations = 50;           // steps, rejected ones included
    double function_tolerance = 1e-6;  // [1] fall of the cost, relative to it, that ends the search
};

struct SchurSummary {
    bool usable = false;    // the start could be evaluated
    double final_cost = 0;  // half the sum of squares, as the losses count them
    int iterations = 0;
};

// Moves the parameters of `problem` to a minimum. Some shared parameter may move, or none at all. No two of
// `eliminated` may be in one residual block; all that are not constant have as many free parameters.
// Manifolds must be subsets, losses concave (Cauchy, Tukey …): else ContractError. A start beyond a bound is
// moved to it. The result is the same bits for any number of threads, as long as the addresses of the blocks
// are in the same order.
SchurSummary solve_by_schur(ceres::Problem& problem, const std::vector<double*>& eliminated,
                            const SchurOptions& options);

// Covariance of the shared parameters where they are now, the eliminated ones being free, from J^T J as the
// losses weigh it, like ceres::Covariance. Bounds do not count.
class SharedCovariance {
public:
    // Nothing where the residuals leave a direction open.
    static std::optional<SharedCovariance> of(const ceres::Problem& problem,
                                              const std::vector<double*>& eliminated);
    // Of parameter i of one block and j of another; 0 of what stays.
    double at(const double* block, int i, const double* other, int j) const;

private:
    std::map<const double*, std::vector<int>> columns_;  // of each parameter of a block; -1: stays
    Eigen::MatrixXd covariance_;
};

}  // namespace tangi
