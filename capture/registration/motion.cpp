#include "capture/registration/motion.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace tangi {

namespace {

// Upper 0.001 quantile of chi-squared with 2 and 4 degrees of freedom.
constexpr double kWald2 = 13.82, kWald4 = 18.47;

template <std::size_t N>
double normal_of(const DisplacementCell<N>& cell, int i, int j) {
    const auto row = static_cast<std::size_t>(std::max(i, j)),
               column = static_cast<std::size_t>(std::min(i, j));
    return cell.normal[row * (row + 1) / 2 + column];
}

// The first n parameters and their covariance; returns the cells that said anything, 0 where they are too few
// or leave the parameters open.
template <std::size_t N>
int solve_cells(const std::vector<DisplacementCell<N>>& cells, int n, cv::Mat1d& x, cv::Mat1d& covariance) {
    cv::Mat1d bread = cv::Mat1d::zeros(n, n), right = cv::Mat1d::zeros(n, 1), meat = cv::Mat1d::zeros(n, n);
    int telling = 0;
    for (const auto& cell : cells) {
        if (cell.count == 0) continue;
        ++telling;
        for (int i = 0; i < n; ++i) {
            right(i) += cell.right[static_cast<std::size_t>(i)];
            for (int j = 0; j < n; ++j) bread(i, j) += normal_of(cell, i, j);
        }
    }
    cv::Mat1d inverse;
    if (telling <= n || cv::invert(bread, inverse, cv::DECOMP_SVD) < 1e-9) return 0;
    x = inverse * right;
    for (const auto& cell : cells) {
        if (cell.count == 0) continue;
        cv::Mat1d score(n, 1);
        for (int i = 0; i < n; ++i) {
            score(i) = cell.right[static_cast<std::size_t>(i)];
            for (int j = 0; j < n; ++j) score(i) -= normal_of(cell, i, j) * x(j);
        }
        meat += score * score.t();
    }
    covariance = inverse * meat * inverse * (static_cast<double>(telling) / (telling - n));
    return telling;
}

template <class Vector, class Matrix>
void take(const cv::Mat1d& x, const cv::Mat1d& of, Vector& motion, Matrix& covariance) {
    for (int i = 0; i < x.rows; ++i) {
        motion[static_cast<std::size_t>(i)] = x(i);
        for (int j = 0; j < x.rows; ++j)
            covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = of(i, j);
    }
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

MotionEstimate solve_motion(const std::vector<MotionCell>& cells, MotionModel model) {
    MotionEstimate result;
    if (model == MotionModel::none) return result;
    cv::Mat1d x, covariance;
    result.cells = solve_cells(cells, static_cast<int>(model), x, covariance);
    if (result.cells == 0) return result;
    result.model = model;
    take(x, covariance, result.motion, result.covariance);
    return result;
}

TiedMotion solve_tied(const std::vector<TiedCell>& cells, MotionModel model) {
    TiedMotion result;
    cv::Mat1d x, covariance;
    if (solve_cells(cells, 2 * static_cast<int>(model), x, covariance) > 0)
        take(x, covariance, result.motion, result.covariance);
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
