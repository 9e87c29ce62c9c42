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

}  // namespace

std::optional<HighlightLobe> fit_lobe(const std::vector<LobeSample>& samples, const glm::dvec2& start_px,
                                      double radius_px, double clip, double floor) {
    if (samples.size() < 20 || !(radius_px > 0) || !(floor > 0)) return std::nullopt;
    double darkest = 1e9, brightest = 0;
    for (const LobeSample& sample : samples) {
        darkest = std::min(darkest, sample.value);
        brightest = std::max(brightest, sample.value);
    }
    if (!(brightest > 2 * floor)) return std::nullopt;
    // A peak of eight times the clipped value, which is down to that at the spot's border.
    const double factor = std::log(1.4 / std::max(radius_px, 0.5));
    double p[7] = {start_px.x,
                   start_px.y,
                   std::log(8 * brightest),
                   factor,
                   factor,
                   0,
                   std::log(std::clamp(darkest, 0.3 * floor, 0.9 * brightest))};
    // The spot itself first, so that something bright beside it does not lead astray; then its flanks.
    for (const double reach : {1.3 * radius_px + 1.2, 1e9}) {
        ceres::Problem problem;
        for (const LobeSample& sample : samples)
            if (glm::length(sample.place_px - start_px) <= reach)
                problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<LobeError, 1, 7>(new LobeError{sample, clip, floor}),
                    new ceres::CauchyLoss(1.5), p);
        if (problem.NumResidualBlocks() < 12) continue;
        problem.SetParameterLowerBound(p, 2, std::log(0.5 * brightest));
        problem.SetParameterUpperBound(p, 2, std::log(100 * brightest));
        // Everything bounded: what is no lobe must not run to infinity.
        for (int i = 0; i < 2; ++i) {
            const double middle = i == 0 ? start_px.x : start_px.y;
            problem.SetParameterLowerBound(p, i, middle - 1.5 * radius_px);
            problem.SetParameterUpperBound(p, i, middle + 1.5 * radius_px);
            problem.SetParameterLowerBound(p, 3 + i, factor - 3);
            problem.SetParameterUpperBound(p, 3 + i, factor + 3);
        }
        problem.SetParameterLowerBound(p, 5, -10 * std::exp(factor));
        problem.SetParameterUpperBound(p, 5, 10 * std::exp(factor));
        problem.SetParameterUpperBound(p, 6, std::log(brightest));
        problem.SetParameterLowerBound(p, 6, std::log(1e-3 * floor));
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_QR;
        options.max_num_iterations = 60;
        options.logging_type = ceres::SILENT;
        options.num_threads = 1;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        if (!summary.IsSolutionUsable() || !std::isfinite(p[0]) || !std::isfinite(p[1])) return std::nullopt;
    }
    const glm::dvec2 centre(p[0], p[1]);
    if (glm::length(centre - start_px) > radius_px) return std::nullopt;
    HighlightLobe lobe{.centre_px = centre, .peak = std::exp(p[2])};
    std::vector<double> deviations;
    double curvature[3] = {};    // of the squared errors by the centre
    int cut = 0, explained = 0;  // clipped samples
    for (const LobeSample& sample : samples) {
        const LobeError error{sample, clip, floor};
        double e = 0, by_x = 0, by_y = 0;
        error(p, &e);
        constexpr double step = 0.01;
        double q[7];
        std::copy(p, p + 7, q);
        q[0] += step;
        error(q, &by_x);
        q[0] -= step;
        q[1] += step;
        error(q, &by_y);
        by_x = (by_x - e) / step;
        by_y = (by_y - e) / step;
        const double weight = 1 / (1 + e * e / 4);
        curvature[0] += weight * by_x * by_x;
        curvature[1] += weight * by_x * by_y;
        curvature[2] += weight * by_y * by_y;
        const bool in_spot = sample.value >= clip && glm::length(sample.place_px - start_px) <= radius_px;
        cut += in_spot;
        explained += in_spot && std::abs(e) < 4;
        // What is of the lobe, not of what lies around it.
        if (sample.value < clip && std::max(sample.value, error.model(p)) > 2 * std::exp(p[6]))
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
    lobe.radius_px = 1 / std::sqrt(std::exp(p[3] + p[4]));
    return lobe;
}

}  // namespace tangi
