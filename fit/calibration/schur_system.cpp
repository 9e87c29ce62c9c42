#include "fit/calibration/schur_system.h"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "surface/base/error.h"
#include "surface/base/parallel.h"

namespace tangi {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rows = ReducedSystem::Rows;
using Block = SchurStructure::Block;
using Residual = SchurStructure::Residual;

// Sums are taken over parts of the eliminated blocks, each in its order, and then over the parts: each has a
// matrix of the shared parameters, of which there are thousands where hundreds of lights have beams.
int parts_for(int shared) { return shared <= 400 ? 8 : shared <= 1000 ? 4 : 1; }
constexpr int kAtOnce = 32;  // eliminated blocks whose rows are multiplied at once

std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Part {
    int begin, end;
};
Part part_of(int owners, int part, int parts) {
    const auto edge = [&](int k) { return static_cast<int>(static_cast<long>(owners) * k / parts); };
    return {edge(part), edge(part + 1)};
}

std::vector<int> free_parameters_of(const ceres::Problem& problem, const double* block) {
    std::vector<int> free;
    const int size = problem.ParameterBlockSize(block);
    if (problem.IsParameterBlockConstant(block)) return free;
    if (!problem.HasManifold(block)) {
        for (int i = 0; i < size; ++i) free.push_back(i);
        return free;
    }
    const ceres::Manifold* manifold = problem.GetManifold(block);
    const int tangent = manifold->TangentSize();
    std::vector<double> jacobian(at(size * tangent));
    if (tangent > 0) manifold->PlusJacobian(block, jacobian.data());
    for (int i = 0; i < size; ++i)
        if (std::count(jacobian.begin() + i * tangent, jacobian.begin() + (i + 1) * tangent, 1.0) == 1)
            free.push_back(i);
    TP_REQUIRE(static_cast<int>(free.size()) == tangent, "a manifold that is a subset");
    return free;
}

// Residuals and derivatives of one residual block, as its loss weighs them.
class Evaluation {
public:
    explicit Evaluation(const SchurStructure& structure)
        : s_(structure), residuals_(at(structure.most_rows)), values_(at(structure.most_values)) {}

    // Adds to the cost. False where the residuals cannot be evaluated.
    bool evaluate(const Residual& residual, const std::vector<double>& state, double& cost) {
        parameters_.clear();
        jacobians_.clear();
        double* values = values_.data();
        const int rows = residual.cost->num_residuals();
        for (int k = 0; k < residual.blocks; ++k) {
            const Block& block = s_.block_of(residual, k);
            parameters_.push_back(&state[at(block.offset)]);
            jacobians_.push_back(block.free.empty() ? nullptr : values);
            values += rows * block.size;
        }
        if (!residual.cost->Evaluate(parameters_.data(), residuals_.data(), jacobians_.data())) return false;
        double squares = 0;
        for (int row = 0; row < rows; ++row) squares += residuals_[at(row)] * residuals_[at(row)];
        if (!std::isfinite(squares)) return false;
        double rho[3] = {squares, 1, 0};
        if (residual.loss) residual.loss->Evaluate(squares, rho);
        TP_REQUIRE(rho[2] <= 0, "a concave loss");
        cost += rho[0] / 2;
        weight_ = rho[1];
        return true;
    }

    // Row by row; `own`, `own_gradient` and `both` are those of the block's owner.
    void add_to(const Residual& residual, double* own, double* own_gradient, double* both, MatrixXd& shared,
                VectorXd& shared_gradient) {
        for (int row = 0; row < residual.cost->num_residuals(); ++row) {
            collect(residual, row);
            const double weighted = weight_ * residuals_[at(row)];
            const std::size_t size = own_.size();
            for (std::size_t i = 0; i < size; ++i) {
                const double d = weight_ * own_[i];
                own_gradient[i] += weighted * own_[i];
                for (std::size_t j = 0; j < size; ++j) own[i * size + j] += d * own_[j];
                double* row_of_both = both + i * at(s_.shared);
                for (const auto& [column, derivative] : shared_) row_of_both[column] += d * derivative;
            }
            for (std::size_t i = 0; i < shared_.size(); ++i) {
                const auto [column, derivative] = shared_[i];
                const double d = weight_ * derivative;
                shared_gradient[column] += weighted * derivative;
                for (std::size_t j = 0; j <= i; ++j) {
                    const int other = shared_[j].column;
                    shared(std::max(column, other), std::min(column, other)) += d * shared_[j].derivative;
                }
            }
        }
    }

private:
    void collect(const Residual& residual, int row) {
        own_.clear();
        shared_.clear();
        for (int k = 0; k < residual.blocks; ++k) {
            const Block& block = s_.block_of(residual, k);
            const double* derivatives = jacobians_[at(k)] + row * block.size;
            int column = block.column;
            for (const int i : block.free)
                if (block.owner >= 0)
                    own_.push_back(derivatives[i]);
                else
                    shared_.push_back({column++, derivatives[i]});
        }
    }

    struct Column {
        int column;
        double derivative;
    };

    const SchurStructure& s_;
    std::vector<const double*> parameters_;
    std::vector<double*> jacobians_;
    std::vector<double> residuals_, values_;
    // Derivatives of one row by the owner's free parameters, and by the shared ones that it depends on.
    std::vector<double> own_;
    std::vector<Column> shared_;
    double weight_ = 1;
};

}  // namespace

SchurStructure::SchurStructure(const ceres::Problem& problem, const std::vector<double*>& eliminated) {
    add_residuals(problem, add_blocks(problem, eliminated));
    add_bounds(problem);
}

SchurStructure::Index SchurStructure::add_blocks(const ceres::Problem& problem,
                                                 const std::vector<double*>& eliminated) {
    const std::unordered_set<const double*> is_eliminated(eliminated.begin(), eliminated.end());
    std::vector<double*> all;
    problem.GetParameterBlocks(&all);
    std::sort(all.begin(), all.end(), std::less());  // so that sums do not depend on Ceres' order
    Index index;
    int offset = 0;
    for (double* user : all) {
        Block block{user, offset, problem.ParameterBlockSize(user), -1, 0, free_parameters_of(problem, user)};
        offset += block.size;
        const int count = static_cast<int>(block.free.size());
        if (count > 0 && is_eliminated.count(user)) {
            TP_REQUIRE(own == 0 || own == count, "eliminated blocks of one size");
            own = count;
            block.owner = owners++;
        } else {
            block.column = shared;
            shared += count;
        }
        index[user] = static_cast<int>(blocks.size());
        blocks.push_back(std::move(block));
    }
    return index;
}

void SchurStructure::add_residuals(const ceres::Problem& problem, const Index& index) {
    std::vector<ceres::ResidualBlockId> ids;
    problem.GetResidualBlocks(&ids);
    std::vector<std::vector<Residual>> of_owner(at(owners) + 1);  // the last: of none
    std::vector<double*> parameters;
    for (const ceres::ResidualBlockId id : ids) {
        problem.GetParameterBlocksForResidualBlock(id, &parameters);
        const Residual residual{problem.GetCostFunctionForResidualBlock(id),
                                problem.GetLossFunctionForResidualBlock(id), static_cast<int>(members.size()),
                                static_cast<int>(parameters.size())};
        int owner = owners, values = 0;
        for (const double* parameter : parameters) {
            const int member = index.at(parameter);
            const Block& block = blocks[at(member)];
            TP_REQUIRE(block.owner < 0 || owner == owners, "one eliminated block in a residual block");
            if (block.owner >= 0) owner = block.owner;
            values += block.size;
            members.push_back(member);
        }
        most_rows = std::max(most_rows, residual.cost->num_residuals());
        most_values = std::max(most_values, residual.cost->num_residuals() * values);
        of_owner[at(owner)].push_back(residual);
    }
    for (const std::vector<Residual>& some : of_owner) {
        first_residual.push_back(static_cast<int>(residuals.size()));
        residuals.insert(residuals.end(), some.begin(), some.end());
    }
    first_residual.push_back(static_cast<int>(residuals.size()));
}

void SchurStructure::add_bounds(const ceres::Problem& problem) {
    lower.resize(free_parameters());
    upper.resize(free_parameters());
    place.resize(at(free_parameters()));
    for (const Block& block : blocks) {
        int k = block.owner < 0 ? block.column : shared + block.owner * own;
        for (const int i : block.free) {
            lower[k] = problem.GetParameterLowerBound(block.user, i);
            upper[k] = problem.GetParameterUpperBound(block.user, i);
            place[at(k++)] = block.offset + i;
        }
    }
}

bool SchurSystem::evaluate(const SchurStructure& s, const std::vector<double>& state) {
    const std::size_t size = at(s.own), columns = at(s.shared);
    gradient.setZero(s.free_parameters());
    own.assign(at(s.owners) * size * size, 0);
    both.assign(at(s.owners) * size * columns, 0);
    const int parts = parts_for(s.shared);
    sums_.resize(at(parts + 1));  // the last: of residuals that no eliminated block is in
    parallel_for(0, parts + 1, 1, [&](int first, int last) {
        Evaluation evaluation(s);
        for (int k = first; k < last; ++k) {
            Sum& sum = sums_[at(k)];
            sum.usable = true;
            sum.cost = 0;
            sum.shared.setZero(s.shared, s.shared);
            sum.gradient.setZero(s.shared);
            const Part part = k < parts ? part_of(s.owners, k, parts) : Part{s.owners, s.owners + 1};
            for (int owner = part.begin; owner < part.end; ++owner) {
                const std::size_t mine = owner < s.owners ? at(owner) : 0;
                for (int i = s.first_residual[at(owner)]; i < s.first_residual[at(owner) + 1]; ++i) {
                    const Residual& residual = s.residuals[at(i)];
                    sum.usable = sum.usable && evaluation.evaluate(residual, state, sum.cost);
                    if (!sum.usable) break;
                    evaluation.add_to(residual, own.data() + mine * size * size,
                                      gradient.data() + columns + mine * size,
                                      both.data() + mine * size * columns, sum.shared, sum.gradient);
                }
            }
        }
    });
    cost = 0;
    shared.setZero(s.shared, s.shared);
    for (const Sum& sum : sums_) {
        if (!sum.usable) return false;
        cost += sum.cost;
        if (s.shared == 0) continue;
        shared += sum.shared;
        gradient.head(s.shared) += sum.gradient;
    }
    return std::isfinite(cost) && gradient.allFinite();
}

VectorXd SchurSystem::diagonal(const SchurStructure& s) const {
    VectorXd result(s.free_parameters());
    if (s.shared > 0) result.head(s.shared) = shared.diagonal();
    for (int k = 0; k < s.owners * s.own; ++k) result[s.shared + k] = own[at(k * s.own + k % s.own)];
    return result;
}

// With L L^T = the eliminated block with itself: L, and L^-1 of what it has with the shared parameters
// (`both`) and of its side.
void ReducedSystem::eliminate(int owner, const SchurStructure& s, const SchurSystem& system,
                              const DampedParameters& p, Eigen::Ref<Rows> both) {
    const int n = s.shared, size = s.own;
    const auto mine = p.open.segment(n + owner * size, size);
    Eigen::Map<MatrixXd> lower(factors_.data() + at(owner * size * size), size, size);
    MatrixXd square = mine.asDiagonal() *
                      Eigen::Map<const MatrixXd>(system.own.data() + at(owner * size * size), size, size) *
                      mine.asDiagonal();
    square.diagonal() += p.damping.segment(n + owner * size, size);
    square.diagonal().array() += 1 - mine.array();
    const Eigen::LLT<MatrixXd> factor(square);
    lower = factor.matrixL();
    // Of what has no factors, Eigen leaves numbers that mean nothing.
    if (factor.info() != Eigen::Success) lower.setConstant(std::numeric_limits<double>::quiet_NaN());
    both = mine.asDiagonal() *
           Eigen::Map<const Rows>(system.both.data() + at(owner * size) * at(n), size, n) *
           p.open.head(n).asDiagonal();
    lower.triangularView<Eigen::Lower>().solveInPlace(both);
    auto side_of_own = own_side_.segment(n + owner * size, size);
    lower.triangularView<Eigen::Lower>().solveInPlace(side_of_own);
}

void ReducedSystem::reduce(const SchurStructure& s, const SchurSystem& system, const VectorXd& damping,
                           const VectorXd& open) {
    const int n = s.shared, size = s.own;
    factors_.resize(system.own.size());
    own_side_ = -system.gradient.cwiseProduct(open);
    const int parts = parts_for(n);
    matrices_.resize(at(parts));
    sides_.resize(at(parts));
    parallel_for(0, parts, 1, [&](int first, int last) {
        Rows rows(kAtOnce * size, n);
        for (int k = first; k < last; ++k) {
            matrices_[at(k)].setZero(n, n);
            sides_[at(k)].setZero(n);
            const Part part = part_of(s.owners, k, parts);
            for (int begin = part.begin; begin < part.end; begin += kAtOnce) {
                const int end = std::min(begin + kAtOnce, part.end);
                for (int owner = begin; owner < end; ++owner) {
                    auto both = rows.middleRows((owner - begin) * size, size);
                    eliminate(owner, s, system, {damping, open}, both);
                    sides_[at(k)].noalias() += both.transpose() * own_side_.segment(n + owner * size, size);
                }
                const auto used = rows.topRows((end - begin) * size);
                matrices_[at(k)].selfadjointView<Eigen::Lower>().rankUpdate(used.transpose(), -1.0);
            }
        }
    });
    matrix = open.head(n).asDiagonal() * system.shared * open.head(n).asDiagonal();
    matrix.diagonal() += damping.head(n);
    matrix.diagonal().array() += 1 - open.head(n).array();
    side = own_side_.head(n);
    for (int k = 0; k < parts; ++k) {
        matrix += matrices_[at(k)];
        side -= sides_[at(k)];
    }
}

VectorXd ReducedSystem::step(const SchurStructure& s, const SchurSystem& system, const VectorXd& open) const {
    const int n = s.shared, size = s.own;
    VectorXd step = own_side_;
    if (n > 0) {
        const Eigen::LLT<MatrixXd> factor(matrix.selfadjointView<Eigen::Lower>());
        step.head(n) = factor.solve(side);
        if (factor.info() != Eigen::Success) step.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    const VectorXd shared_step = step.head(n).cwiseProduct(open.head(n));
    parallel_for(0, s.owners, kAtOnce, [&](int begin, int end) {
        VectorXd along(size);
        for (int owner = begin; owner < end; ++owner) {
            const Eigen::Map<const MatrixXd> lower(factors_.data() + at(owner * size * size), size, size);
            const Eigen::Map<const Rows> both(system.both.data() + at(owner * size) * at(n), size, n);
            along.noalias() = both * shared_step;
            along = along.cwiseProduct(open.segment(n + owner * size, size));
            lower.triangularView<Eigen::Lower>().solveInPlace(along);
            auto own_step = step.segment(n + owner * size, size);
            own_step -= along;
            lower.transpose().triangularView<Eigen::Upper>().solveInPlace(own_step);
        }
    });
    return step.cwiseProduct(open);
}

}  // namespace tangi
