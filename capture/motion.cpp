#include "capture/motion.h"

#include <cmath>
#include <opencv2/core.hpp>

namespace tangi {

namespace {

// Upper 0.001 quantile of chi-squared with 2 and 4 degrees of freedom.
constexpr double kWald2 = 13.82, kWald4 = 18.47;

cv::Matx<double, kMotion, kMotion> normal_of(const MotionCell& cell) {
    cv::Matx<double, kMotion, kMotion> m;
    std::size_t at = 0;
    for (int i = 0; i < kMotion; ++i)
        for (int j = 0; j <= i; ++j) m(i, j) = m(j, i) = cell.normal[at++];
    return m;
}

}  // namespace

const char* name_of(MotionModel model) {
    switch (model) {
        case MotionModel::none:
            return "none";
        case MotionModel::translation:
            return "translation";
        case MotionModel::similarity:
            return "similarity";
        case MotionModel::homography:
            return "homography";
    }
    return "";
}

MotionFrame::MotionFrame(double width, double height)
    : centre((width - 1) / 2, (height - 1) / 2), radius(std::hypot(width, height) / 2) {}

Homography homography_of(const MotionVector& m, const MotionFrame& frame) {
    const double s = 1 / frame.radius;
    // In normalised coordinates, by columns.
    const Homography n(1 + s * (m[2] + m[4]), s * (m[3] + m[5]), -s * m[6],  //
                       s * (m[5] - m[3]), 1 + s * (m[2] - m[4]), -s * m[7],  //
                       s * m[0], s * m[1], 1);
    const double r = frame.radius;
    const Homography out(r, 0, 0, 0, r, 0, frame.centre.x, frame.centre.y, 1);
    const Homography in(s, 0, 0, 0, s, 0, -s * frame.centre.x, -s * frame.centre.y, 1);
    return normalised(out * n * in);
}

MotionVector motion_of(const Homography& h, const MotionFrame& frame) {
    const double r = frame.radius, s = 1 / r;
    const Homography out(r, 0, 0, 0, r, 0, frame.centre.x, frame.centre.y, 1);
    const Homography in(s, 0, 0, 0, s, 0, -s * frame.centre.x, -s * frame.centre.y, 1);
    const Homography n = normalised(in * h * out);
    return {r * n[2][0],
            r * n[2][1],
            r * ((n[0][0] + n[1][1]) / 2 - 1),
            r * (n[0][1] - n[1][0]) / 2,
            r * (n[0][0] - n[1][1]) / 2,
            r * (n[0][1] + n[1][0]) / 2,
            -r * n[0][2],
            -r * n[1][2]};
}

namespace {

// Mean over a disc of radius a of g_i . g_j: 1 for the shifts, a^2/2 for the linear terms, a^4/6 for the
// vanishing directions, which share a^2/4 with the shifts.
double mean_product(int i, int j) {
    constexpr double a2 = 0.5;
    if (i == j) return i < 2 ? 1 : i < 6 ? a2 / 2 : a2 * a2 / 6;
    if (std::abs(i - j) == 6) return a2 / 4;  // shift x with n x, shift y with n y
    return 0;
}

}  // namespace

double rms_displacement(const MotionVector& motion) {
    double sum = 0;
    for (int i = 0; i < kMotion; ++i)
        for (int j = 0; j < kMotion; ++j)
            sum += mean_product(i, j) * motion[static_cast<std::size_t>(i)] *
                   motion[static_cast<std::size_t>(j)];
    return std::sqrt(std::max(sum, 0.0));
}

double rms_displacement(const MotionMatrix& covariance) {
    double sum = 0;
    for (int i = 0; i < kMotion; ++i)
        for (int j = 0; j < kMotion; ++j)
            sum += mean_product(i, j) * covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    return std::sqrt(std::max(sum, 0.0));
}

void MotionCell::add(const MotionVector& row, double residual, double weight) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < kMotion; ++i) {
        for (std::size_t j = 0; j <= i; ++j) normal[at++] += weight * row[i] * row[j];
        right[i] -= weight * row[i] * residual;
    }
    count += 1;
}

MotionEstimate solve_motion(const std::vector<MotionCell>& cells, MotionModel model) {
    MotionEstimate result;
    result.model = model;
    const int n = static_cast<int>(model);
    if (n == 0) return result;
    cv::Mat1d bread = cv::Mat1d::zeros(n, n), right = cv::Mat1d::zeros(n, 1), meat = cv::Mat1d::zeros(n, n);
    for (const MotionCell& cell : cells) {
        if (cell.count == 0) continue;
        ++result.cells;
        const auto normal = normal_of(cell);
        for (int i = 0; i < n; ++i) {
            right(i) += cell.right[static_cast<std::size_t>(i)];
            for (int j = 0; j < n; ++j) bread(i, j) += normal(i, j);
        }
    }
    const auto give_up = [&] {
        result.model = MotionModel::none;
        return result;
    };
    if (result.cells <= n) return give_up();
    cv::Mat1d inverse;
    if (cv::invert(bread, inverse, cv::DECOMP_SVD) < 1e-9) return give_up();
    const cv::Mat1d x = inverse * right;
    for (const MotionCell& cell : cells) {
        if (cell.count == 0) continue;
        const auto normal = normal_of(cell);
        cv::Mat1d score(n, 1);
        for (int i = 0; i < n; ++i) {
            score(i) = cell.right[static_cast<std::size_t>(i)];
            for (int j = 0; j < n; ++j) score(i) -= normal(i, j) * x(j);
        }
        meat += score * score.t();
    }
    const cv::Mat1d covariance =
        inverse * meat * inverse * (static_cast<double>(result.cells) / (result.cells - n));
    for (int i = 0; i < n; ++i) {
        result.motion[static_cast<std::size_t>(i)] = x(i);
        for (int j = 0; j < n; ++j)
            result.covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = covariance(i, j);
    }
    return result;
}

MotionModel supported_model(const std::vector<MotionCell>& cells, const MotionVector& motion_so_far,
                            MotionModel largest, double least_px) {
    const auto holds = [&](MotionModel model, int first, double threshold) {
        const MotionEstimate e = solve_motion(cells, model);
        if (e.model == MotionModel::none) return false;
        const int n = static_cast<int>(model) - first;
        cv::Mat1d covariance(n, n), x(n, 1);
        MotionVector beyond{};
        for (int i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(first + i);
            x(i) = beyond[k] = e.motion[k] + motion_so_far[k];
            for (int j = 0; j < n; ++j)
                covariance(i, j) = e.covariance[k][static_cast<std::size_t>(first + j)];
        }
        cv::Mat1d solved;
        return rms_displacement(beyond) > least_px && cv::solve(covariance, x, solved, cv::DECOMP_CHOLESKY) &&
               x.dot(solved) > threshold;
    };
    if (largest >= MotionModel::homography && holds(MotionModel::homography, 4, kWald4))
        return MotionModel::homography;
    if (largest >= MotionModel::similarity && holds(MotionModel::similarity, 2, kWald2))
        return MotionModel::similarity;
    return std::min(largest, MotionModel::translation);
}

}  // namespace tangi
