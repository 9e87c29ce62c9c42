#include "surface/base/symmetric_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace tangi {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricSolution solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
    const Eigen::LDLT<Eigen::MatrixXd> factors(matrix);
    // Eigen's estimate passes over pivots of zero.
    const bool singular = factors.info() != Eigen::Success || (factors.vectorD().array() == 0).any();
    return {factors.solve(right), singular ? 0 : factors.rcond()};
}

Eigen::MatrixXd orthonormal_span(const Eigen::MatrixXd& columns) {
    constexpr double kDependent = 1e-6;
    if (columns.cols() == 0) return columns;
    const SymmetricEigen squares = symmetric_eigen(columns.transpose() * columns);
    const double largest = squares.values[columns.cols() - 1];
    Eigen::Index first = 0;
    while (first < columns.cols() && !(squares.values[first] > kDependent * kDependent * largest)) ++first;
    const Eigen::Index rank = columns.cols() - first;
    return columns * squares.vectors.rightCols(rank) *
           squares.values.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace tangi
