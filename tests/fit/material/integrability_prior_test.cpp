// integrability_prior_test.cpp: what neighbours and height say about a slope, and how near the joint minimum
// of slopes and height, by Ceres, that comes.
#include "fit/material/integrability_prior.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <vector>

#include "datasets/procedural_painting.h"
#include "fit/height/height.h"
#include "fit/height/slope_edges.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A generated relief whose slopes were fitted with errors: most are known well, every twentieth badly.
struct FittedRelief {
    PaintingTruth truth;
    Surface surface;
    Image<float> sigma;

    explicit FittedRelief(int size, double good = 0.005, double bad = 0.15)
        : truth(procedural_painting({.seed = 3,
                                     .width = size,
                                     .height = size,
                                     .mm_per_pixel = 0.25,
                                     .craquelure = 0,
                                     .losses = false})),
          surface(size, size),
          sigma(size, size) {
        Random random(11);
        surface.mm_per_pixel = 0.25;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double s = random.uniform() < 0.05 ? bad : good;
                const Slope real = slope_of(truth.normal(x, y));
                sigma(x, y) = static_cast<float>(s);
                surface.normal(x, y) = normal_of({real.x + static_cast<float>(s * random.normal()),
                                                  real.y + static_cast<float>(s * random.normal())});
                const double t = s / kHalfConfidence;
                surface.confidence(x, y) = static_cast<float>(1 / (1 + t * t));
            }
        integrate_normals({surface.normal, surface.confidence, 0.25}, surface.height_mm);
    }
};

WardPrior prior_at(const IntegrabilityPriors& priors, int x, int y) {
    WardPrior prior;
    priors.add_to(x, y, prior);
    return prior;
}

// The slope that least squares makes of a pixel's own and of the prior.
glm::dvec2 combined(const FittedRelief& f, const IntegrabilityPriors& priors, int x, int y) {
    const Slope own = slope_of(f.surface.normal(x, y));
    const WardPrior prior = prior_at(priors, x, y);
    const double information = 1 / (double(f.sigma(x, y)) * f.sigma(x, y));
    glm::dvec2 result;
    for (int i = 0; i < 2; ++i) {
        const double known = 1 / (prior.slope_sigma[i] * prior.slope_sigma[i]);
        result[i] = (information * (i ? own.y : own.x) + known * prior.slope[i]) / (information + known);
    }
    return result;
}

struct Errors {
    double good = 0, bad = 0;  // [1] rms of slopes
};
template <class SlopeAt>
Errors errors_of(const FittedRelief& f, const SlopeAt& slope_at) {
    double square[2] = {}, count[2] = {};
    for (int y = 0; y < f.sigma.height(); ++y)
        for (int x = 0; x < f.sigma.width(); ++x) {
            const Slope real = slope_of(f.truth.normal(x, y));
            const glm::dvec2 off = slope_at(x, y) - glm::dvec2(real.x, real.y);
            const int bad = f.sigma(x, y) > 0.05f;
            square[bad] += glm::dot(off, off);
            count[bad] += 2;
        }
    return {std::sqrt(square[0] / count[0]), std::sqrt(square[1] / count[1])};
}

// z_j - z_i = mean of both slopes.
struct SlopeEdgeCost {
    double inverse_tolerance;
    int component;
    double sign;
    template <class T>
    bool operator()(const T* z, const T* other_z, const T* slope, const T* other_slope, T* residual) const {
        residual[0] = (sign * (other_z[0] - z[0]) - (slope[component] + other_slope[component]) / 2.0) *
                      inverse_tolerance;
        return true;
    }
};
struct SlopeCost {
    double x, y, inverse_sigma;
    template <class T>
    bool operator()(const T* slope, T* residual) const {
        residual[0] = (slope[0] - x) * inverse_sigma;
        residual[1] = (slope[1] - y) * inverse_sigma;
        return true;
    }
};

// Slopes of the joint minimum over height and slopes.
std::vector<glm::dvec2> joint_slopes(const FittedRelief& f) {
    const int size = f.sigma.width();
    std::vector<glm::dvec2> slopes;
    std::vector<double> z(f.sigma.size());
    for (const Vec3& n : f.surface.normal.pixels()) slopes.emplace_back(slope_of(n).x, slope_of(n).y);
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * size + x); };
    ceres::Problem problem;
    const auto add_edge = [&](int x, int y, int u, int v, int component, double sign) {
        const auto tolerance2 = [&](int px, int py) {
            const double mixed = kMixed * slope_spread(f.surface.normal, f.surface.confidence, px, py);
            return mixed * mixed / 2 + kSharpest * kSharpest;
        };
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<SlopeEdgeCost, 1, 1, 1, 2, 2>(
                new SlopeEdgeCost{1 / std::sqrt(tolerance2(x, y) + tolerance2(u, v)), component, sign}),
            nullptr, &z[at(x, y)], &z[at(u, v)], &slopes[at(x, y)].x, &slopes[at(u, v)].x);
    };
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const glm::dvec2 own = slopes[at(x, y)];
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SlopeCost, 2, 2>(
                                         new SlopeCost{own.x, own.y, 1 / double(f.sigma(x, y))}),
                                     nullptr, &slopes[at(x, y)].x);
            if (x + 1 < size) add_edge(x, y, x + 1, y, 0, 1);
            if (y + 1 < size) add_edge(x, y, x, y + 1, 1, -1);
        }
    problem.SetParameterBlockConstant(&z[0]);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    EXPECT_EQ(summary.termination_type, ceres::CONVERGENCE);
    return slopes;
}

TEST(IntegrabilityPriors, BringSlopesNearTheJointMinimumThatCeresFinds) {
    constexpr int kReliefSize = 48;
    const FittedRelief f(kReliefSize);
    IntegrabilityPriors priors(f.surface, {});
    priors.advance(0, kReliefSize);
    const std::vector<glm::dvec2> joint = joint_slopes(f);
    const Errors fitted = errors_of(f, [&](int x, int y) {
        const Slope s = slope_of(f.surface.normal(x, y));
        return glm::dvec2(s.x, s.y);
    });
    const Errors once = errors_of(f, [&](int x, int y) { return combined(f, priors, x, y); });
    const Errors minimum =
        errors_of(f, [&](int x, int y) { return joint[static_cast<std::size_t>(y * kReliefSize + x)]; });
    std::cout << fmt::format(
        "[  FIGURE  ] slopes off by, of the badly known and the others: fitted {:.4f} {:.4f}, with the "
        "height's say {:.4f} {:.4f}, joint minimum by Ceres {:.4f} {:.4f}\n",
        fitted.bad, fitted.good, once.bad, once.good, minimum.bad, minimum.good);
    EXPECT_LT(once.bad, fitted.bad - 0.5 * (fitted.bad - minimum.bad));
    EXPECT_LT(once.good, 1.02 * fitted.good);
}

TEST(IntegrabilityPriors, AreThoseOfThePlaneWithItsTilt) {
    Surface s(9, 7);
    s.mm_per_pixel = 0.5;
    const Slope slope{0.3f, -0.2f};
    for (Vec3& n : s.normal.pixels()) n = normal_of(slope);
    for (float& c : s.confidence.pixels()) c = 0.99f;
    // The height is what is left after the plane was taken off: nothing.
    IntegrabilityPriors priors(s, {.a = 0.3 * 0.5, .b = -0.2 * 0.5, .c = 0});
    priors.advance(0, 7);
    for (const auto& [x, y] : {std::pair{4, 3}, {0, 0}, {8, 6}}) {
        const WardPrior prior = prior_at(priors, x, y);
        EXPECT_NEAR(prior.slope.x, 0.3, 1e-5);
        EXPECT_NEAR(prior.slope.y, -0.2, 1e-5);
    }
    // At the border one edge speaks, not two.
    EXPECT_NEAR(prior_at(priors, 0, 3).slope_sigma.x / prior_at(priors, 4, 3).slope_sigma.x, std::sqrt(2.0),
                1e-4);
}

TEST(IntegrabilityPriors, SayNothingOfWhatWasNotMeasured) {
    Surface s(5, 5);
    IntegrabilityPriors priors(s, {});
    priors.advance(0, 5);
    EXPECT_EQ(prior_at(priors, 2, 2).slope_sigma.x, std::numeric_limits<double>::infinity());
    s.confidence(2, 2) = 0.9f;  // alone
    IntegrabilityPriors again(s, {});
    again.advance(0, 5);
    EXPECT_EQ(prior_at(again, 2, 2).slope_sigma.y, std::numeric_limits<double>::infinity());
}

TEST(IntegrabilityPriors, RowsMayBeOverwrittenOnceTheyWereUsed) {
    const FittedRelief f(40);
    IntegrabilityPriors whole(f.surface, {});
    whole.advance(0, 40);
    Surface overwritten = f.surface;
    IntegrabilityPriors priors(overwritten, {});
    for (int y0 = 0; y0 < 40; y0 += 7) {
        const int y1 = std::min(y0 + 7, 40);
        priors.advance(y0, y1);
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < 40; ++x) {
                const WardPrior expected = prior_at(whole, x, y), p = prior_at(priors, x, y);
                ASSERT_EQ(p.slope, expected.slope) << x << ' ' << y;
                ASSERT_EQ(p.slope_sigma, expected.slope_sigma) << x << ' ' << y;
                overwritten.normal(x, y) = Vec3(0, 0, 1);
                overwritten.confidence(x, y) = 0;
            }
    }
}

// kMixed: how far the height between two pixels of generated paintings is from the mean of their slopes.
TEST(SlopeEdges, DifferencesOfTheTruthAreOffByThePartOfTheSpreadThatIsAssumed) {
    for (const double mm : {0.15, 0.4}) {
        const PaintingTruth truth = procedural_painting(
            {.seed = 9, .width = 160, .height = 160, .mm_per_pixel = mm, .supersampling = 4});
        const Image<float> known(160, 160, 1.0f);
        double square = 0, spread2 = 0;
        for (int y = 1; y < 158; ++y)
            for (int x = 1; x < 158; ++x) {
                const double off =
                    (truth.height_mm(x + 1, y) - truth.height_mm(x, y)) / mm -
                    0.5 * (slope_of(truth.normal(x, y)).x + slope_of(truth.normal(x + 1, y)).x);
                const double spread = slope_spread(truth.normal, known, x, y);
                square += off * off;
                spread2 += spread * spread;
            }
        const double part = std::sqrt(square / spread2);
        std::cout << fmt::format(
            "[  FIGURE  ] differences in height, {} mm a pixel: off by {:.3f} of the spread\n", mm, part);
        EXPECT_GT(part, kMixed / 3);
        EXPECT_LT(part, kMixed * 1.5);
    }
}

}  // namespace
}  // namespace tangi
