// symmetric_matrix.h: eigenvalues of real symmetric matrices, and what solves them, by Eigen. Its templates
// take seconds to compile in each source that uses them; here they are compiled once. Not for each pixel: it
// allocates.
#pragma once

#include <Eigen/Core>

namespace tangi {

struct SymmetricEigen {
    Eigen::VectorXd values;   // ascending
    Eigen::MatrixXd vectors;  // [][value] of length 1, each in the column of its value
};

// Of the lower triangle. NaN where the matrix has any.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);  // ascending

// x of matrix x = right, by the decomposition L D L^T with pivots of the lower triangle.
struct SymmetricSolution {
    Eigen::MatrixXd x;  // a column for each of the right side
    double rcond = 0;   // reciprocal condition number, estimated; 0 where the matrix is singular
};
SymmetricSolution solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

// Orthonormal columns that span what a few columns span: fewer than these where they are dependent, which
// are those whose singular values are below a millionth of the largest (floats are exact to 6e-8).
Eigen::MatrixXd orthonormal_span(const Eigen::MatrixXd& columns);

}  // namespace tangi
