#include "surface/base/symmetric_matrix.h"

#include <gmock/gmock.h>

#include <limits>

namespace tangi {
namespace {

using Eigen::MatrixXd;

MatrixXd random_symmetric(int size) {
    std::srand(5);
    const MatrixXd square = MatrixXd::Random(size, size);
    return square + square.transpose();
}

TEST(SymmetricEigen, IsWhatTheMatrixStretches) {
    const MatrixXd a = random_symmetric(12);
    const SymmetricEigen found = symmetric_eigen(a);
    EXPECT_LT((a * found.vectors - found.vectors * found.values.asDiagonal()).norm(), 1e-12);
    EXPECT_LT((found.vectors.transpose() * found.vectors - MatrixXd::Identity(12, 12)).norm(), 1e-12);
    EXPECT_TRUE(std::is_sorted(found.values.begin(), found.values.end()));
    EXPECT_LT((symmetric_eigenvalues(a) - found.values).norm(), 1e-12);
}

TEST(SymmetricSolution, SolvesAndTellsHowSurely) {
    const MatrixXd a = random_symmetric(6), right = MatrixXd::Random(6, 2);
    const SymmetricSolution found = solve_symmetric(a, right);
    EXPECT_LT((a * found.x - right).norm(), 1e-12);
    EXPECT_GT(found.rcond, 1e-4);
    const Eigen::Vector3d ends(2, 1, 1e-7);
    EXPECT_NEAR(solve_symmetric(ends.asDiagonal(), ends).rcond, 0.5e-7, 1e-9);
    EXPECT_LT(solve_symmetric(MatrixXd::Constant(3, 3, 1), ends).rcond, 1e-9);
}

TEST(OrthonormalSpan, ReachesTheColumnsAndNothingElse) {
    std::srand(5);
    MatrixXd columns = MatrixXd::Random(20, 3);
    const MatrixXd whole = orthonormal_span(columns);
    ASSERT_EQ(whole.cols(), 3);
    EXPECT_LT((whole.transpose() * whole - MatrixXd::Identity(3, 3)).norm(), 1e-12);
    EXPECT_LT((whole * (whole.transpose() * columns) - columns).norm(), 1e-12);

    columns.col(2) = columns.col(0) - 2 * columns.col(1);  // as directions in one plane
    const MatrixXd plane = orthonormal_span(columns.cast<float>().cast<double>());
    ASSERT_EQ(plane.cols(), 2);
    EXPECT_LT((plane * (plane.transpose() * columns) - columns).norm(), 1e-6);
}

TEST(OrthonormalSpan, OfNothingIsNothing) {
    EXPECT_EQ(orthonormal_span(MatrixXd::Zero(5, 2)).cols(), 0);
    EXPECT_EQ(orthonormal_span(MatrixXd(5, 0)).cols(), 0);
    EXPECT_EQ(orthonormal_span(MatrixXd::Constant(5, 2, std::numeric_limits<double>::quiet_NaN())).cols(), 0);
}

}  // namespace
}  // namespace tangi
