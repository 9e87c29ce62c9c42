#include "fit/joint_lights.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>

#include "fit/joint_residual.h"

namespace tangi {

namespace {

// What is known before any photograph. Model errors are shared by neighbouring samples, so that the prior on
// a lamp's own gain weighs as if one sample in kDependent were independent. The priors on what the whole
// stack shares (the trend of the gains, the camera) stand as they are: all photographs speak against them.
constexpr double kDependent = 10;     // [1] samples
constexpr double kStartScale = 20;    // [sigma] at first, so that a lamp three times too strong is no outlier
constexpr double kRobustScale = 2;    // [sigma] as the pixel fit's
constexpr double kGainSigma = 0.05;   // [1] ln gain, about its smooth trend
constexpr double kTrendSigma = 0.2;   // [1] ln gain
constexpr double kCameraSigma = 0.5;  // [1/width]
constexpr double kFlatness = 0.03;    // [1] slope; robust, so that relief does not count
constexpr double kLnAlpha = -1.6, kLnAlphaSigma = 0.7, kSpecularSigma = 0.2;  // as WardPrior
constexpr int kIterations = 40;

constexpr int kPixel = kJointPixel, kRig = kJointRig;
constexpr int kTrend = 6;  // 1, x, y, x^2, x y, y^2 of the direction

struct LobePrior {
    template <class T>
    bool operator()(const T* pixel, T* residual) const {
        residual[0] = (pixel[2] - kLnAlpha) / kLnAlphaSigma;
        residual[1] = pixel[3] / kSpecularSigma;
        return true;
    }
};

struct FlatnessPrior {
    template <class T>
    bool operator()(const T* pixel, T* residual) const {
        residual[0] = pixel[0] / kFlatness;
        residual[1] = pixel[1] / kFlatness;
        return true;
    }
};

struct GainPrior {
    glm::dvec3 l;
    double weight;
    template <class T>
    bool operator()(const T* log_gain, const T* trend, T* residual) const {
        residual[0] = (log_gain[0] - trend[0] - trend[1] * l.x - trend[2] * l.y - trend[3] * l.x * l.x -
                       trend[4] * l.x * l.y - trend[5] * l.y * l.y) *
                      weight;
        return true;
    }
};

template <int size>
struct Weighted {  // residuals weight * parameter
    std::array<double, size> weight;
    template <class T>
    bool operator()(const T* parameter, T* residual) const {
        for (int i = 0; i < size; ++i) residual[i] = weight[static_cast<std::size_t>(i)] * parameter[i];
        return true;
    }
};

template <int residuals, int... blocks, class Functor>
ceres::CostFunction* cost(Functor functor) {
    return new ceres::AutoDiffCostFunction<Functor, residuals, blocks...>(new Functor(functor));
}

}  // namespace

bool JointLights::solve(bool free_gains, JointStart start) {
    std::vector<std::array<double, kPixel>> x;
    for (const Pixel& p : pixels) x.push_back({p.slope.x, p.slope.y, p.ln_alpha, p.specular, p.diffuse});
    std::array<double, kRig> r = {rig.lamp_nearness, rig.ambient, rig.camera_nearness, rig.bend};
    std::array<double, kTrend> trend{};
    const double weight = std::sqrt(std::max(1.0, static_cast<double>(pixels.size()) / kDependent));

    ceres::Problem problem;  // owns costs and losses; a loss may be shared
    auto* robust = new ceres::LossFunctionWrapper(new ceres::CauchyLoss(kStartScale), ceres::TAKE_OWNERSHIP);
    for (const Observation& o : observations) {
        const auto pixel = static_cast<std::size_t>(o.pixel), photo = static_cast<std::size_t>(o.photo);
        problem.AddResidualBlock(new JointResidual({directions[photo], nearer[photo], pixels[pixel].position,
                                                    camera_axis, o.value, o.sigma}),
                                 robust, x[pixel].data(), &log_gains[photo], r.data());
    }
    auto* flat = new ceres::CauchyLoss(1);
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (auto& pixel : x) {
        double* block = pixel.data();
        problem.AddResidualBlock(cost<2, kPixel>(LobePrior{}), nullptr, block);
        problem.AddResidualBlock(cost<2, kPixel>(FlatnessPrior{}), flat, block);
        problem.SetParameterLowerBound(block, 2, std::log(0.03));
        problem.SetParameterUpperBound(block, 2, std::log(0.7));
        problem.SetParameterLowerBound(block, 3, 0);
        problem.SetParameterLowerBound(block, 4, 0);
        ordering->AddElementToGroup(block, 0);
    }
    auto* outlying = new ceres::CauchyLoss(2 * weight);
    for (std::size_t i = 0; i < log_gains.size(); ++i) {
        problem.AddResidualBlock(cost<1, 1, kTrend>(GainPrior{directions[i], weight / kGainSigma}), outlying,
                                 &log_gains[i], trend.data());
        if (!free_gains) problem.SetParameterBlockConstant(&log_gains[i]);
        ordering->AddElementToGroup(&log_gains[i], 1);
    }
    // The trend's constant only follows the albedo: strength is relative.
    const double t = 1 / kTrendSigma;
    problem.AddResidualBlock(cost<kTrend, kTrend>(Weighted<kTrend>{{1e4, t, t, t, t, t}}), nullptr,
                             trend.data());
    problem.AddResidualBlock(cost<kRig, kRig>(Weighted<kRig>{{0, 0, 1 / kCameraSigma, 0}}), nullptr,
                             r.data());
    const std::array<std::array<double, 2>, kRig> bounds = {{{0, 1.2}, {0, 0.6}, {0, 1.2}, {-0.5, 0.5}}};
    for (int i = 0; i < kRig; ++i) {
        if (i != 1 && (i == 2 ? camera_known : lamps_known)) continue;  // may lie outside, and stays
        problem.SetParameterLowerBound(r.data(), i, bounds[static_cast<std::size_t>(i)][0]);
        problem.SetParameterUpperBound(r.data(), i, bounds[static_cast<std::size_t>(i)][1]);
    }
    std::vector<int> known;
    if (lamps_known) known = {0, 3};
    if (camera_known) known.push_back(2);
    if (!known.empty()) problem.SetManifold(r.data(), new ceres::SubsetManifold(kRig, known));
    ordering->AddElementToGroup(trend.data(), 1);
    ordering->AddElementToGroup(r.data(), 1);

    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;  // pixels are eliminated first
    options.linear_solver_ordering = ordering;
    options.num_threads = 1;  // sums in a fixed order; callers run several problems at once
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    if (free_gains && start == JointStart::far) {
        options.max_num_iterations = kIterations / 2;
        options.function_tolerance = 1e-3;
        ceres::Solve(options, &problem, &summary);
    }
    robust->Reset(new ceres::CauchyLoss(kRobustScale), ceres::TAKE_OWNERSHIP);
    options.max_num_iterations = start == JointStart::far ? kIterations : kIterations / 4;
    options.function_tolerance = start == JointStart::far ? 1e-5 : 1e-4;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) return false;

    for (std::size_t i = 0; i < x.size(); ++i) {
        pixels[i].slope = {x[i][0], x[i][1]};
        pixels[i].ln_alpha = x[i][2];
        pixels[i].specular = x[i][3];
        pixels[i].diffuse = x[i][4];
    }
    rig = {r[0], r[1], r[2], r[3]};
    return true;
}

}  // namespace tangi
