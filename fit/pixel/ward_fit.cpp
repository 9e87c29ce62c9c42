#include "fit/pixel/ward_fit.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "fit/pixel/specular_error.h"

namespace tangi {

namespace {

// The function that ceres::TinySolver minimises, in unbounded parameters u.
class WardFunction {
public:
    using Scalar = double;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kWardParameters };

    WardFunction(const WardResiduals& residuals, const WardBounds& bounds)
        : residuals_(residuals), bounds_(bounds) {}
    int NumResiduals() const { return residuals_.size(); }
    bool operator()(const double* u, double* residuals, double* jacobian) const {
        double derivative[kWardParameters];
        const WardVector theta = natural_of(u, bounds_, derivative);
        residuals_.evaluate(theta.data(), residuals, jacobian);
        if (jacobian) {
            const int rows = residuals_.size();
            for (int column = 0; column < kWardParameters; ++column)
                for (int row = 0; row < rows; ++row) jacobian[column * rows + row] *= derivative[column];
        }
        return true;
    }

private:
    const WardResiduals& residuals_;
    WardBounds bounds_;
};

}  // namespace

using WardSolver = ceres::TinySolver<WardFunction>;
using WardMatrix = Eigen::Matrix<double, kWardParameters, kWardParameters>;
using WardJacobian = Eigen::Matrix<double, Eigen::Dynamic, kWardParameters>;

struct WardFitter::Workspace {
    WardSolver solver;
    PixelSamples samples;  // with the model's error in sigma
    WardJacobian jacobian;
    Eigen::VectorXd residuals;
};

namespace {

// Where a solver ended.
struct SolvedWard {
    WardVector theta;
    double cost;
    bool converged;
};

// What the model leaves out (interreflection, other lobes, shadows) grows with the light that is there. It is
// taken relative to the matt prediction, not to the value alone: a value in shadow would look certain because
// it is small.
void add_model_error(const LambertEstimate& start, double model_error, PixelSamples& s) {
    for (int i = 0; i < s.photos(); ++i) {
        const auto photo = static_cast<std::size_t>(i);
        const double cosine = std::max(glm::dot(start.normal, s.light[photo]), 0.0) + s.ambient[photo];
        for (int c = 0; c < s.channels; ++c) {
            const auto at = static_cast<std::size_t>(i * s.channels + c);
            if (s.sigma[at] == 0) continue;
            const double matt = start.diffuse[c] * cosine * s.irradiance[at];
            const double shadow = (1 - s.visible[photo]) * matt;
            const double sigma = std::hypot(s.sigma[at], model_error * std::max(matt, s.value[at]), shadow);
            s.sigma[at] = std::copysign(sigma, s.sigma[at]);
        }
    }
}

// Start of the lobe: for a few widths, the rho_s that explains what the diffuse estimate leaves over, each
// with its robust cost; the cheapest wins. Least squares alone is bimodal in alpha.
void start_lobe(const PixelSamples& s, const WardResiduals& residuals, const WardBounds& bounds,
                const ReflectanceModel& reflectance_model, const glm::dvec2& stretch, WardVector& theta) {
    constexpr std::array<double, 5> widths = {0.06, 0.12, 0.2, 0.32, 0.5};
    double best_cost = std::numeric_limits<double>::infinity();
    const WardVector diffuse_only = theta;
    for (const double alpha : widths) {
        WardVector candidate = diffuse_only;
        candidate[2] = std::log(alpha);
        double numerator = 0, denominator = 0;
        for (int i = 0; i < s.photos(); ++i) {
            const WardTerms t = ward_terms(candidate.data(), s.light[static_cast<std::size_t>(i)], s.view,
                                           reflectance_model, stretch);
            for (int c = 0; c < s.channels; ++c) {
                const auto at = static_cast<std::size_t>(i * s.channels + c);
                if (s.sigma[at] == 0) continue;
                const double w = 1 / (s.sigma[at] * s.sigma[at]);
                const double left = s.value[at] - s.irradiance[at] *
                                                      candidate[kWardCommon + static_cast<std::size_t>(c)] *
                                                      (t.matt + s.ambient[static_cast<std::size_t>(i)]);
                if (s.sigma[at] < 0 && left <= 0) continue;
                const double lobe = s.irradiance[at] * t.lobe;
                numerator += w * lobe * left;
                denominator += w * lobe * lobe;
            }
        }
        candidate[3] =
            denominator > 0 ? std::clamp(numerator / denominator, 0.002, bounds.specular_max) : 0.002;
        const double cost = residuals.cost(candidate.data());
        if (cost < best_cost) {
            best_cost = cost;
            theta = candidate;
        }
    }
}

// The fit of one pixel, from several starts.
struct PixelProblem {
    const PixelSamples& samples;  // with the model's error in sigma
    const WardPrior& prior;
    const WardResiduals& residuals;
    const WardFitOptions& options;

    // Samples that are no bounds and the two priors of the lobe, less what is fitted; 1 at least.
    double free_samples() const {
        const auto known =
            std::count_if(samples.sigma.begin(), samples.sigma.end(), [](double sigma) { return sigma > 0; });
        return static_cast<double>(std::max<std::ptrdiff_t>(known + 2 - residuals.parameters(), 1));
    }
};

SolvedWard solve_from(const WardStart& from, const PixelProblem& problem, WardSolver& solver) {
    const auto& [samples, prior, residuals, options] = problem;
    WardVector theta = {from.slope.x,    from.slope.y,    prior.ln_alpha, 0.0,
                        from.diffuse[0], from.diffuse[1], from.diffuse[2]};
    start_lobe(samples, residuals, options.bounds, options.reflectance_model, prior.stretch, theta);
    const WardVector u0 = unbounded_of(theta, options.bounds);
    Eigen::Matrix<double, kWardParameters, 1> u(u0.data());
    solver.options.max_num_iterations = options.max_iterations;
    solver.options.parameter_tolerance = 1e-5;
    solver.options.function_tolerance = 1e-3;
    solver.options.gradient_tolerance = 1e-8;
    solver.options.initial_trust_region_radius = 1e3;
    const WardFunction function(residuals, options.bounds);
    const bool converged = solver.Solve(function, &u).status != WardSolver::HIT_MAX_ITERATIONS;
    theta = natural_of(u.data(), options.bounds, nullptr);
    return {theta, residuals.cost(theta.data()), converged};
}

// Without errors.
WardEstimate estimate_at(const SolvedWard& solved, const PixelProblem& problem) {
    const WardVector& theta = solved.theta;
    WardEstimate estimate;
    estimate.slope = {theta[0], theta[1]};
    estimate.stretch = problem.prior.stretch;
    estimate.roughness = std::exp(theta[2]);
    estimate.specular = theta[3];
    for (int c = 0; c < 3; ++c)
        estimate.diffuse[c] =
            theta[static_cast<std::size_t>(kWardCommon + (c < problem.samples.channels ? c : 0))];
    estimate.converged = solved.converged;
    return estimate;
}

// Errors of an estimate that has its cost, from the residuals' derivatives.
void add_errors(const WardJacobian& jacobian, const SolvedWard& solved, const PixelProblem& problem,
                WardEstimate& estimate) {
    const double chi2 = estimate.cost / problem.free_samples();
    WardMatrix information = jacobian.transpose() * jacobian;
    // A parameter that no sample depends on (n.l <= 0 under every light, a channel that grey photographs do
    // not have) has no error; the floor keeps it finite.
    information.diagonal().array() += 1e-9;
    const WardMatrix covariance = information.ldlt().solve(WardMatrix::Identity()) * std::max(chi2, 1.0);
    const auto error_of = [&](int i) { return std::sqrt(std::max(covariance(i, i), 0.0)); };
    estimate.slope_error = std::sqrt(std::max(covariance(0, 0) + covariance(1, 1), 0.0) / 2);
    const int channels = problem.samples.channels;
    double diffuse_variance = 0;
    for (int c = 0; c < channels; ++c)
        diffuse_variance += std::max(covariance(kWardCommon + c, kWardCommon + c), 0.0) / channels;
    estimate.diffuse_error = std::sqrt(diffuse_variance);
    estimate.roughness_error = error_of(2) * estimate.roughness;
    estimate.specular_error =
        specular_error(solved.theta[3], solved.theta[2],
                       {.ln_alpha = covariance(2, 2), .specular = covariance(3, 3), .both = covariance(2, 3)},
                       problem.options.bounds);
    estimate.rms_residual = std::sqrt(chi2);
    estimate.valid = std::isfinite(estimate.slope.x) && std::isfinite(estimate.slope.y) &&
                     std::isfinite(estimate.slope_error);
}

// The value at a part of the way through sorted ones.
double quantile(std::vector<double>& values, double part) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

WardStart start_of(const LambertEstimate& matt) {
    return {.slope = {-matt.normal.x / matt.normal.z, -matt.normal.y / matt.normal.z},
            .diffuse = matt.diffuse};
}

std::optional<WardStart> highlight_start(const PixelSamples& s, const WardBounds& bounds) {
    constexpr double kLit = 0.2,
                     kDarker = 0.3;  // [1] least n.l, and the part of photographs, of the matt part
    std::vector<double> brightness, all;
    for (int i = 0; i < s.photos(); ++i) {
        double sum = 0;
        for (int c = 0; c < s.channels; ++c) {
            const auto at = static_cast<std::size_t>(i * s.channels + c);
            if (s.sigma[at] != 0) sum += s.value[at] / s.irradiance[at];
        }
        brightness.push_back(sum);
    }
    if (brightness.empty()) return {};
    all = brightness;
    const double usual = quantile(all, 0.5);
    glm::dvec3 facing(0);
    for (int i = 0; i < s.photos(); ++i) {
        const auto photo = static_cast<std::size_t>(i);
        const double over = std::max(brightness[photo] - usual, 0.0);
        facing += over * over * glm::normalize(s.light[photo] + s.view);
    }
    if (!(facing.z > 0)) return {};
    const glm::dvec3 normal = glm::normalize(facing);
    WardStart start{.slope = {-normal.x / normal.z, -normal.y / normal.z}, .diffuse = glm::dvec3(0)};
    if (std::max(std::abs(start.slope.x), std::abs(start.slope.y)) >= bounds.slope) return {};
    for (int c = 0; c < s.channels; ++c) {
        all.clear();
        for (int i = 0; i < s.photos(); ++i) {
            const auto photo = static_cast<std::size_t>(i), at = static_cast<std::size_t>(i * s.channels + c);
            const double n_l = glm::dot(normal, s.light[photo]);
            if (s.sigma[at] != 0 && n_l > kLit)
                all.push_back(s.value[at] / (s.irradiance[at] * (n_l + s.ambient[photo])));
        }
        if (all.empty()) return {};
        start.diffuse[c] = std::clamp(quantile(all, kDarker), 0.0, bounds.diffuse_max);
    }
    for (int c = s.channels; c < 3; ++c) start.diffuse[c] = start.diffuse[0];
    return start;
}

WardFitter::WardFitter(const WardFitOptions& options)
    : options_(options), workspace_(std::make_unique<Workspace>()) {
    validate(options);
}

WardFitter::~WardFitter() = default;

WardEstimate WardFitter::fit(const PixelSamples& given) { return fit(given, options_.prior); }

WardEstimate WardFitter::fit(const PixelSamples& given, const WardPrior& prior, const WardStart* known) {
    const LambertEstimate start = photometric_stereo(given, kWardStereo);
    if (!start.valid) return {};
    Workspace& w = *workspace_;
    w.samples = given;
    add_model_error(start, options_.model_error, w.samples);
    const WardResiduals residuals(w.samples, prior, options_.robust_scale, options_.reflectance_model);
    const PixelProblem problem{w.samples, prior, residuals, options_};
    SolvedWard solved = solve_from(known ? *known : start_of(start), problem, w.solver);
    if (options_.by_highlight && !known && solved.cost > kPoorFit * kPoorFit * problem.free_samples())
        if (const auto highlight = highlight_start(given, options_.bounds)) {
            const SolvedWard other = solve_from(*highlight, problem, w.solver);
            if (other.cost < kClearlyCheaper * solved.cost) solved = other;
        }
    w.jacobian.resize(residuals.size(), kWardParameters);
    w.residuals.resize(residuals.size());
    residuals.evaluate(solved.theta.data(), w.residuals.data(), w.jacobian.data());
    WardEstimate estimate = estimate_at(solved, problem);
    estimate.cost = w.residuals.squaredNorm();
    add_errors(w.jacobian, solved, problem, estimate);
    return estimate;
}

}  // namespace tangi
