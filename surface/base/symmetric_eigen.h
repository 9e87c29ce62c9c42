// symmetric_eigen.h: eigenvalues and eigenvectors of real symmetric matrices, by Eigen's solver. Its
// templates take seconds to compile in each source that uses them; here they are compiled once.
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

// Orthonormal columns that span what a few columns span: fewer than these where they are dependent, which
// are those whose singular values are below a millionth of the largest (floats are exact to 6e-8).
Eigen::MatrixXd orthonormal_span(const Eigen::MatrixXd& columns);

}  // namespace tangi
