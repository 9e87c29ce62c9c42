// schur_solver_test.cpp: our elimination of pixels against Ceres' on the same problems.
#include "fit/calibration/schur_solver.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kPoints = 60, kFewLights = 9;

// albedo (1 + bend x d) exp(gain + turn y) + slope d of a point at (x, y) under the light from d; `rig`:
// bend, and an offset.
struct Shading {
    double x, y, d, value;
    template <class T>
    bool operator()(const T* point, const T* light, const T* rig, T* residual) const {
        using std::exp;
        residual[0] = (point[0] * (1.0 + rig[0] * x * d) * exp(light[0] + light[1] * y) + point[1] * d +
                       rig[1] - value) /
                      0.01;
        return true;
    }
};
struct Pull {
    double middle, weight;
    template <class T>
    bool operator()(const T* light, T* residual) const {
        residual[0] = weight * (light[0] - middle);
        residual[1] = weight * light[1];
        return true;
    }
};

// Generated points under lights, one sample in twelve far off; parameters lie side by side.
class Bundle {
public:
    explicit Bundle(unsigned seed) {
        Random random(seed);
        values_.resize(2 * kPoints + 2 * kFewLights + 2);
        std::vector<double> truth(values_.size());
        for (int i = 0; i < kPoints; ++i) {
            truth[at(2 * i)] = random.uniform(0.2, 0.9);
            truth[at(2 * i + 1)] = random.uniform(-0.1, 0.1);
        }
        for (int k = 0; k < 2 * kFewLights; ++k) truth[at(2 * kPoints + k)] = random.uniform(-0.4, 0.4);
        truth[at(2 * kPoints + 2 * kFewLights)] = 0.15;
        for (int i = 0; i < kPoints; ++i) {
            const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
            for (int k = 0; k < kFewLights; ++k) {
                Shading shading{x, y, k / 4.0 - 1, 0};
                double residual = 0;
                shading(&truth[at(2 * i)], &truth[at(2 * kPoints + 2 * k)],
                        &truth[at(2 * kPoints + 2 * kFewLights)], &residual);
                shading.value = 0.01 * residual + random.uniform(-0.005, 0.005);
                if (random.uniform(0, 1) < 1.0 / 12) shading.value += random.uniform(0, 0.5);
                problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<Shading, 1, 2, 2, 2>(new Shading(shading)), robust_,
                    point(i), light(k), rig());
            }
            values_[at(2 * i)] = 0.5;
        }
        for (int k = 0; k < kFewLights; ++k)
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Pull, 2, 2>(new Pull{0, 3}), nullptr,
                                     light(k));
    }

    double* point(int i) { return &values_[at(2 * i)]; }
    double* light(int k) { return &values_[at(2 * kPoints + 2 * k)]; }
    double* rig() { return &values_[at(2 * kPoints + 2 * kFewLights)]; }
    std::vector<double*> points() {
        std::vector<double*> all;
        for (int i = 0; i < kPoints; ++i) all.push_back(point(i));
        return all;
    }
    const std::vector<double>& values() const { return values_; }
    double by_ceres() {
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_SCHUR;
        options.function_tolerance = 1e-14;
        options.max_num_iterations = 200;
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        return summary.final_cost;
    }
    SchurSummary by_us() {
        return solve_by_schur(problem, points(), {.max_iterations = 200, .function_tolerance = 1e-14});
    }

    ceres::Problem problem;

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    std::vector<double> values_;
    ceres::LossFunction* robust_ = new ceres::CauchyLoss(2);
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = a.size() == b.size() ? 0 : INFINITY;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

TEST(SchurSolver, FindsTheMinimumThatCeresFinds) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        Bundle ours(seed), theirs(seed);
        const SchurSummary summary = ours.by_us();
        ASSERT_TRUE(summary.usable);
        EXPECT_GT(summary.iterations, 3);
        EXPECT_NEAR(summary.final_cost, theirs.by_ceres(), 1e-6 * summary.final_cost);
        EXPECT_LT(largest_difference(ours.values(), theirs.values()), 1e-4);
    }
}

TEST(SchurSolver, LeavesConstantBlocksAndPartsWhereTheyAre) {
    Bundle ours(4), theirs(4);
    for (Bundle* bundle : {&ours, &theirs}) {
        bundle->light(2)[0] = 0.3;
        bundle->problem.SetParameterBlockConstant(bundle->light(2));
        bundle->problem.SetParameterBlockConstant(bundle->point(5));
        bundle->problem.SetManifold(bundle->rig(), new ceres::SubsetManifold(2, {1}));
    }
    const SchurSummary summary = ours.by_us();
    EXPECT_NEAR(summary.final_cost, theirs.by_ceres(), 1e-6 * summary.final_cost);
    EXPECT_LT(largest_difference(ours.values(), theirs.values()), 1e-4);
    EXPECT_EQ(ours.light(2)[0], 0.3);
    EXPECT_EQ(ours.point(5)[0], 0.5);
    EXPECT_EQ(ours.rig()[1], 0);
}

// Where Ceres' search along a line stalls, it may stay above; never the other way round.
TEST(SchurSolver, StaysWithinBounds) {
    Bundle ours(5), theirs(5);
    for (Bundle* bundle : {&ours, &theirs}) {
        bundle->problem.SetParameterUpperBound(bundle->rig(), 0, 0.05);
        for (int i = 0; i < kPoints; ++i) bundle->problem.SetParameterLowerBound(bundle->point(i), 1, -0.02);
    }
    const SchurSummary summary = ours.by_us();
    EXPECT_LT(summary.final_cost, theirs.by_ceres() * (1 + 1e-6));
    EXPECT_EQ(ours.rig()[0], 0.05);
    int at_bound = 0;
    for (int i = 0; i < kPoints; ++i) {
        EXPECT_GE(ours.point(i)[1], -0.02);
        at_bound += ours.point(i)[1] == -0.02;
    }
    EXPECT_GT(at_bound, 0);
    EXPECT_LT(at_bound, kPoints / 2);
}

TEST(SchurSolver, GivesTheSameBitsOnAnyNumberOfThreads) {
    Bundle one(6), many(6);
    set_thread_count(1);
    one.by_us();
    set_thread_count(0);
    many.by_us();
    EXPECT_EQ(one.values(), many.values());
}

TEST(SchurSolver, CovarianceIsThatOfCeres) {
    Bundle bundle(7);
    bundle.by_us();
    const auto ours = SharedCovariance::of(bundle.problem, bundle.points());
    ASSERT_TRUE(ours);
    ceres::Covariance theirs{ceres::Covariance::Options()};
    const double *a = bundle.light(1), *b = bundle.light(4);
    ASSERT_TRUE(theirs.Compute({{a, a}, {a, b}, {bundle.rig(), bundle.rig()}}, &bundle.problem));
    const auto compare = [&](const double* block, const double* other) {
        double expected[4];
        ASSERT_TRUE(theirs.GetCovarianceBlock(block, other, expected));
        for (int k = 0; k < 4; ++k)
            EXPECT_NEAR(ours->at(block, k / 2, other, k % 2), expected[k], 1e-6 * std::abs(expected[0]));
    };
    compare(a, a);
    compare(a, b);
    compare(bundle.rig(), bundle.rig());
}

// All gains up and all albedos down is the same.
TEST(SchurSolver, SaysWhereNothingHoldsADirection) {
    ceres::Problem loose;
    std::vector<double> values = {0.5, 0.6, 0.1};
    struct Product {
        double value;
        bool operator()(const ceres::Jet<double, 2>* a, const ceres::Jet<double, 2>* b,
                        ceres::Jet<double, 2>* residual) const {
            residual[0] = a[0] * b[0] - value;
            return true;
        }
        bool operator()(const double* a, const double* b, double* residual) const {
            residual[0] = a[0] * b[0] - value;
            return true;
        }
    };
    for (int i = 0; i < 2; ++i)
        loose.AddResidualBlock(new ceres::AutoDiffCostFunction<Product, 1, 1, 1>(new Product{0.2}), nullptr,
                               &values[static_cast<std::size_t>(i)], &values[2]);
    EXPECT_FALSE(SharedCovariance::of(loose, {&values[0], &values[1]}));
}

TEST(SchurSolver, RefusesWhatItCannotEliminate) {
    Bundle bundle(9);
    std::vector<double*> blocks = bundle.points();
    blocks.push_back(bundle.light(0));  // meets points
    EXPECT_THROW(solve_by_schur(bundle.problem, blocks, {}), ContractError);
}

struct Distance {
    double from;
    template <class T>
    bool operator()(const T* x, T* residual) const {
        residual[0] = x[0] - from;
        return from < 100;
    }
};

TEST(SchurSolver, DoesWithoutBlocksToEliminateAndWhereNothingMoves) {
    double x = 9;
    ceres::Problem problem;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Distance, 1, 1>(new Distance{2}), nullptr, &x);
    EXPECT_THROW(solve_by_schur(problem, {&x}, {}), ContractError);  // nothing would be shared
    EXPECT_TRUE(solve_by_schur(problem, {}, {}).usable);
    EXPECT_NEAR(x, 2, 1e-6);
    problem.SetParameterBlockConstant(&x);
    x = 5;
    EXPECT_TRUE(solve_by_schur(problem, {&x}, {}).usable);
    EXPECT_EQ(x, 5);
}

TEST(SchurSolver, MovesAStartBeyondABoundToItAndSaysWhatItCannotEvaluate) {
    double x = 9;
    ceres::Problem problem;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Distance, 1, 1>(new Distance{8}), nullptr, &x);
    problem.SetParameterUpperBound(&x, 0, 3);
    const SchurSummary summary = solve_by_schur(problem, {}, {});
    EXPECT_TRUE(summary.usable);
    EXPECT_EQ(x, 3);
    EXPECT_EQ(summary.iterations, 0);
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Distance, 1, 1>(new Distance{200}), nullptr, &x);
    EXPECT_FALSE(solve_by_schur(problem, {}, {}).usable);
}

TEST(SchurSolver, RefusesALossThatIsNotConcave) {
    double x = 9;
    ceres::Problem problem;
    class Square final : public ceres::LossFunction {
        void Evaluate(double s, double rho[3]) const override { rho[0] = s * s, rho[1] = 2 * s, rho[2] = 2; }
    };
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Distance, 1, 1>(new Distance{2}), new Square,
                             &x);
    EXPECT_THROW(solve_by_schur(problem, {}, {}), ContractError);
}

}  // namespace
}  // namespace tangi
