// schur_system.h: what solve_by_schur() (schur_solver.h) solves in each step: cost, gradient and J^T J of a
// ceres::Problem, and the normal equations with the small blocks eliminated.
//
// Free parameters are numbered: the shared ones, block by block, then those of each eliminated block.
#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <unordered_map>
#include <vector>

namespace tangi {

// Which parameters may move, and which residuals they are in.
struct SchurStructure {
    struct Block {
        double* user = nullptr;  // the caller's parameters
        int offset = 0;          // of its parameters in the state
        int size = 0;
        int owner = -1;         // eliminated block, or -1
        int column = 0;         // of its first free parameter: of the owner's, or of the shared ones
        std::vector<int> free;  // those of its parameters that may move
    };
    struct Residual {
        const ceres::CostFunction* cost;
        const ceres::LossFunction* loss;
        int first_block, blocks;  // in `members`
    };

    std::vector<Block> blocks;
    std::vector<int> members;             // blocks of the residuals, one residual after the other
    std::vector<Residual> residuals;      // those of the eliminated blocks first, block by block
    std::vector<int> first_residual;      // of each eliminated block, and the end
    int owners = 0, own = 0, shared = 0;  // eliminated blocks, free parameters of each, shared ones
    int most_rows = 0, most_values = 0;   // of a residual block: residuals, and derivatives
    Eigen::VectorXd lower, upper;         // of all free parameters
    std::vector<int> place;               // in the state, of all free parameters

    SchurStructure(const ceres::Problem& problem, const std::vector<double*>& eliminated);
    int free_parameters() const { return shared + owners * own; }
    const Block& block_of(const Residual& residual, int k) const {
        return blocks[static_cast<std::size_t>(members[static_cast<std::size_t>(residual.first_block + k)])];
    }

private:
    using Index = std::unordered_map<const double*, int>;  // of the blocks
    Index add_blocks(const ceres::Problem& problem, const std::vector<double*>& eliminated);
    void add_residuals(const ceres::Problem& problem, const Index& index);
    void add_bounds(const ceres::Problem& problem);
};

// Cost, gradient and J^T J at a point.
struct SchurSystem {
    double cost = 0;
    Eigen::MatrixXd shared;    // of the shared parameters; lower triangle
    Eigen::VectorXd gradient;  // of all free parameters
    std::vector<double> own;   // of each eliminated block with itself, by columns
    std::vector<double> both;  // of each with the shared ones, by rows

    // `state`: the parameters of all blocks. False where something cannot be evaluated.
    bool evaluate(const SchurStructure& structure, const std::vector<double>& state);
    // Of J^T J, of all free parameters.
    Eigen::VectorXd diagonal(const SchurStructure& structure) const;

private:
    struct Sum {
        bool usable = true;
        double cost = 0;
        Eigen::MatrixXd shared;
        Eigen::VectorXd gradient;
    };
    std::vector<Sum> sums_;
};

// The damped normal equations of the parameters that are open, with the eliminated blocks gone.
struct ReducedSystem {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    Eigen::MatrixXd matrix;  // of the shared parameters; lower triangle
    Eigen::VectorXd side;

    // open: 1 for parameters that may move, else 0; damping: added to the diagonal. Of all free parameters.
    void reduce(const SchurStructure& structure, const SchurSystem& system, const Eigen::VectorXd& damping,
                const Eigen::VectorXd& open);
    // The minimum of the quadratic model, of all free parameters; after reduce() by the same arguments.
    Eigen::VectorXd step(const SchurStructure& structure, const SchurSystem& system,
                         const Eigen::VectorXd& open) const;

private:
    // As reduce() gets them.
    struct DampedParameters {
        const Eigen::VectorXd &damping, &open;
    };
    void eliminate(int owner, const SchurStructure& structure, const SchurSystem& system,
                   const DampedParameters& parameters, Eigen::Ref<Rows> both);

    std::vector<double> factors_;  // L of each eliminated block with itself, by columns
    Eigen::VectorXd own_side_;     // L^-1 of the eliminated blocks' side; before: the shared ones'
    std::vector<Eigen::MatrixXd> matrices_;
    std::vector<Eigen::VectorXd> sides_;
};

}  // namespace tangi
