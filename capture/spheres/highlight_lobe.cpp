#include "capture/spheres/highlight_lobe.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tangi {

namespace {

constexpr double kRelative = 0.08;  // [1] by which lobes of real lights deviate from the model

// Parameters: centre x, y; log peak; log of both radii's factors and the shear of q; log base.
struct LobeError {
    LobeSample sample;
    double clip, floor;

    template <class T>
    T model(const T* p) const {
        using std::exp;
        const T dx = sample.place_px.x - p[0], dy = sample.place_px.y - p[1];
        // q = |L d|^2 with L lower triangular is positive.
        const T u = exp(p[3]) * dx, v = p[5] * dx + exp(p[4]) * dy;
        const T wide = 1.0 + u * u + v * v;
        return exp(p[6]) + exp(p[2]) / (wide * wide);
    }

    template <class T>
    bool operator()(const T* p, T* error) const {
        const T value = model(p);
        if (sample.value >= clip && value >= T(clip)) {
            error[0] = T(0);  // both are cut off
            return true;
        }
        using std::log;
        error[0] = (std::log(std::min(sample.value, clip) + floor) - log(value + floor)) / kRelative;
        return true;
    }
};

// The fit of a lobe to a spot.
class LobeFit {
public:
    LobeFit(const std::vector<LobeSample>& samples, const glm::dvec2& start_px, double radius_px, double clip,
            double floor)
        : samples_(samples), start_px_(start_px), radius_px_(radius_px), clip_(clip), floor_(floor) {
        for (const LobeSample& sample : samples) {
            darkest_ = std::min(darkest_, sample.value);
            brightest_ = std::max(brightest_, sample.value);
        }
    }
    bool shows_a_spot() const { return brightest_ > 2 * floor_; }
    // False where it leads nowhere.
    bool solve();
    // With errors; nothing where it is no lobe.
    std::optional<HighlightLobe> lobe() const;

private:
    void bound(ceres::Problem& problem);
    bool is_in_spot(const LobeSample& sample) const {
        return sample.value >= clip_ && glm::length(sample.place_px - start_px_) <= radius_px_;
    }
    glm::dvec2 slope_by_centre(const LobeError& error, double at_centre) const;

    const std::vector<LobeSample>& samples_;
    const glm::dvec2 start_px_;
    const double radius_px_, clip_, floor_;
    double darkest_ = 1e9, brightest_ = 0;
    double factor_ = 0;  // ln of 1 / radius, to start from
    double p_[7] = {};   // as LobeError's
};

// What is no lobe must not run to infinity.
void LobeFit::bound(ceres::Problem& problem) {
    problem.SetParameterLowerBound(p_, 2, std::log(0.5 * brightest_));
    problem.SetParameterUpperBound(p_, 2, std::log(100 * brightest_));
    for (int i = 0; i < 2; ++i) {
        const double middle = i == 0 ? start_px_.x : start_px_.y;
        problem.SetParameterLowerBound(p_, i, middle - 1.5 * radius_px_);
        problem.SetParameterUpperBound(p_, i, middle + 1.5 * radius_px_);
        problem.SetParameterLowerBound(p_, 3 + i, factor_ - 3);
        problem.SetParameterUpperBound(p_, 3 + i, factor_ + 3);
    }
    problem.SetParameterLowerBound(p_, 5, -10 * std::exp(factor_));
    problem.SetParameterUpperBound(p_, 5, 10 * std::exp(factor_));
    problem.SetParameterUpperBound(p_, 6, std::log(brightest_));
    problem.SetParameterLowerBound(p_, 6, std::log(1e-3 * floor_));
}

bool LobeFit::solve() {
    // A peak of eight times the clipped value, which is down to that at the spot's border.
    factor_ = std::log(1.4 / std::max(radius_px_, 0.5));
    const double start[7] = {start_px_.x,
                             start_px_.y,
                             std::log(8 * brightest_),
                             factor_,
                             factor_,
                             0,
                             std::log(std::clamp(darkest_, 0.3 * floor_, 0.9 * brightest_))};
    std::copy(start, start + 7, p_);
    // The spot itself first, so that something bright beside it does not lead astray; then its flanks.
    for (const double reach : {1.3 * radius_px_ + 1.2, 1e9}) {
        ceres::Problem problem;
        for (const LobeSample& sample : samples_)
            if (glm::length(sample.place_px - start_px_) <= reach)
                problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<LobeError, 1, 7>(new LobeError{sample, clip_, floor_}),
                    new ceres::CauchyLoss(1.5), p_);
        if (problem.NumResidualBlocks() < 12) continue;
        bound(problem);
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_QR;
        options.max_num_iterations = 60;
        options.logging_type = ceres::SILENT;
        options.num_threads = 1;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        if (!summary.IsSolutionUsable() || !std::isfinite(p_[0]) || !std::isfinite(p_[1])) return false;
    }
    return true;
}

// Of an error, which is `at_centre` there, by differences.
glm::dvec2 LobeFit::slope_by_centre(const LobeError& error, double at_centre) const {
    constexpr double step = 0.01;
    glm::dvec2 by(0);
    double q[7];
    std::copy(p_, p_ + 7, q);
    q[0] += step;
    error(q, &by.x);
    q[0] -= step;
    q[1] += step;
    error(q, &by.y);
    return {(by.x - at_centre) / step, (by.y - at_centre) / step};
}

std::optional<HighlightLobe> LobeFit::lobe() const {
    const glm::dvec2 centre(p_[0], p_[1]);
    if (glm::length(centre - start_px_) > radius_px_) return std::nullopt;
    HighlightLobe lobe{.centre_px = centre, .peak = std::exp(p_[2])};
    std::vector<double> deviations;
    double curvature[3] = {};    // of the squared errors by the centre
    int cut = 0, explained = 0;  // clipped samples
    for (const LobeSample& sample : samples_) {
        const LobeError error{sample, clip_, floor_};
        double e = 0;
        error(p_, &e);
        const glm::dvec2 by = slope_by_centre(error, e);
        const double weight = 1 / (1 + e * e / 4);
        curvature[0] += weight * by.x * by.x;
        curvature[1] += weight * by.x * by.y;
        curvature[2] += weight * by.y * by.y;
        cut += is_in_spot(sample);
        explained += is_in_spot(sample) && std::abs(e) < 4;
        // What is of the lobe, not of what lies around it.
        if (sample.value < clip_ && std::max(sample.value, error.model(p_)) > 2 * std::exp(p_[6]))
            deviations.push_back(std::abs(e));
    }
    if (deviations.size() < 8 || 5 * explained < 4 * cut) return std::nullopt;
    const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
    std::nth_element(deviations.begin(), middle, deviations.end());
    const double sigma = *middle / 0.6745;
    lobe.residual = kRelative * sigma;
    const double determinant = curvature[0] * curvature[2] - curvature[1] * curvature[1];
    if (!(determinant > 0)) return std::nullopt;
    // Deviations of neighbouring pixels hang together: four or so make one.
    lobe.sigma_px = 2 * std::max(sigma, 0.1) * std::sqrt(std::max(curvature[0], curvature[2]) / determinant);
    lobe.radius_px = 1 / std::sqrt(std::exp(p_[3] + p_[4]));
    return lobe;
}

}  // namespace

std::optional<HighlightLobe> fit_lobe(const std::vector<LobeSample>& samples, const glm::dvec2& start_px,
                                      double radius_px, double clip, double floor) {
    if (samples.size() < 20 || !(radius_px > 0) || !(floor > 0)) return std::nullopt;
    LobeFit fit(samples, start_px, radius_px, clip, floor);
    if (!fit.shows_a_spot() || !fit.solve()) return std::nullopt;
    return fit.lobe();
}

}  // namespace tangi
