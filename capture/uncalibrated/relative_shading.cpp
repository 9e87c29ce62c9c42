#include "capture/uncalibrated/relative_shading.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "surface/base/median.h"
#include "surface/base/symmetric_matrix.h"

namespace tangi {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr int kShadingIterations = 12;
constexpr double kRobust = 2;              // [robust sigma] of Cauchy's weights
constexpr double kTame = 3;                // [robust sigma] of the values that the factors start from
constexpr double kLeastPhotoLevel = 0.05;  // [1]
constexpr double kDarkest = 0.02;          // [1] of a pixel's median: a cast shadow

double scale_of(const VectorXd& residual, const VectorXd& weight) {
    std::vector<double> sizes;
    for (Index i = 0; i < residual.size(); ++i)
        if (weight[i] > 0) sizes.push_back(std::abs(residual[i]));
    return std::max(1.4826 * median(std::move(sizes)), 1e-4);
}

// The smooth part of one photograph: a polynomial of the second degree over the picture, robustly. Sums by
// pixels of matrices of fixed size: products of matrices of any size take a minute to compile.
void flatten(RelativeShading& s, Index photo) {
    using Terms = Eigen::Matrix<double, 6, 1>;
    using Normal = Eigen::Matrix<double, 6, 6>;
    const Index pixels = s.value.rows();
    const auto terms = [&](Index pixel) -> Terms {
        const Index row = pixel / s.width, column = pixel - row * s.width;
        const double x = static_cast<double>(column) / s.width - 0.5;
        const double y = static_cast<double>(row) / s.height - 0.5;
        return {1, x, y, x * x, x * y, y * y};
    };
    const VectorXd known = s.weight.col(photo);
    VectorXd weight = known, residual(pixels);
    Terms field = Terms::Zero();
    for (int iteration = 0; iteration < 6; ++iteration) {
        Normal normal = Normal::Identity() * 1e-9;
        Terms right = Terms::Zero();
        for (Index i = 0; i < pixels; ++i) {
            if (!(weight[i] > 0)) continue;
            const Terms t = terms(i), weighted = weight[i] * t;
            for (Index k = 0; k < 6; ++k) normal.col(k) += weighted[k] * t;
            right += s.value(i, photo) * weighted;
        }
        field = solve_symmetric(normal, right).x;
        for (Index i = 0; i < pixels; ++i) residual[i] = s.value(i, photo) - terms(i).dot(field);
        const double scale = kRobust * scale_of(residual, known);
        for (Index i = 0; i < pixels; ++i) {
            const double off = residual[i] / scale;
            weight[i] = known[i] / (1 + off * off);
        }
    }
    // The level is the mean over the picture of what the polynomial says.
    double level = 0;
    for (Index i = 0; i < pixels; ++i) level += terms(i).dot(field);
    s.log_level[photo] = level / static_cast<double>(pixels);
    s.value.col(photo) = residual;
    const double longer = std::max(s.width, s.height);
    s.falloff.row(photo) << field[1] * longer / s.width, -field[2] * longer / s.height;
}

// Each pixel's two numbers, of photographs whose levels are known.
void solve_pixels(const MatrixXd& value, const MatrixXd& weight, ShadingFactors& f) {
    for (Index i = 0; i < value.rows(); ++i) {
        Matrix2d normal = Matrix2d::Identity() * 1e-6;
        Vector2d right = Vector2d::Zero();
        for (Index j = 0; j < value.cols(); ++j) {
            const double w = weight(i, j);
            if (!(w > 0)) continue;
            const Vector2d row = f.level[j] * f.right.row(j).transpose();
            normal += w * row * row.transpose();
            right += w * (1 + value(i, j) - f.level[j]) * row;
        }
        f.left.row(i) = normal.ldlt().solve(right).transpose();
    }
}

// Each photograph's level and two numbers.
void solve_photos(const MatrixXd& value, const MatrixXd& weight, ShadingFactors& f) {
    for (Index j = 0; j < value.cols(); ++j) {
        Matrix3d normal = Matrix3d::Identity() * 1e-6;
        Vector3d right = Vector3d::Zero();
        for (Index i = 0; i < value.rows(); ++i) {
            const double w = weight(i, j);
            if (!(w > 0)) continue;
            const Vector3d row(1, f.left(i, 0), f.left(i, 1));
            normal += w * row * row.transpose();
            right += w * (1 + value(i, j)) * row;
        }
        const Vector3d found = solve_symmetric(normal, right).x;
        f.level[j] = std::max(found[0], kLeastPhotoLevel);
        f.right.row(j) = found.tail<2>().transpose() / f.level[j];
    }
}

// The object is flat as a whole: what all pixels share is none of its relief. Single pixels go astray.
void centre_pixels(const MatrixXd& weight, MatrixXd& left) {
    for (Index c = 0; c < left.cols(); ++c) {
        VectorXd known = (weight.rowwise().sum().array() > 0).cast<double>();
        const double most = kTame * scale_of(left.col(c), known);
        const VectorXd tame = left.col(c).cwiseMax(-most).cwiseMin(most);
        left.col(c).array() -= tame.dot(known) / std::max(known.sum(), 1.0);
    }
}

}  // namespace

RelativeShading shading_of(const std::vector<Image<float>>& pictures, float clipped) {
    RelativeShading s{.width = pictures.front().width(),
                      .height = pictures.front().height(),
                      .value = {},
                      .weight = {},
                      .log_level = VectorXd::Zero(static_cast<Index>(pictures.size())),
                      .falloff = MatrixXd::Zero(static_cast<Index>(pictures.size()), 2)};
    const auto pixels = static_cast<Index>(pictures.front().size()),
               photos = static_cast<Index>(pictures.size());
    s.value = MatrixXd::Zero(pixels, photos);
    s.weight = MatrixXd::Zero(pixels, photos);
    std::vector<float> levels;
    for (const Image<float>& picture : pictures)
        levels.push_back(
            std::max(median(std::vector<float>(picture.pixels().begin(), picture.pixels().end())), 1e-6f));
    std::vector<float> values;
    for (Index i = 0; i < pixels; ++i) {
        values.clear();
        for (std::size_t j = 0; j < pictures.size(); ++j) {
            const float value = pictures[j].pixels()[static_cast<std::size_t>(i)];
            if (value > 0 && value < clipped) values.push_back(value / levels[j]);
        }
        if (values.size() < pictures.size() / 2) continue;
        const float albedo = median(values);
        if (!(albedo > 0)) continue;
        for (Index j = 0; j < photos; ++j) {
            const float value = pictures[static_cast<std::size_t>(j)].pixels()[static_cast<std::size_t>(i)];
            const double ratio = static_cast<double>(value) / albedo;
            if (!(value > 0 && value < clipped) || ratio < kDarkest * levels[static_cast<std::size_t>(j)])
                continue;
            s.value(i, j) = std::log(ratio);
            s.weight(i, j) = 1;
        }
    }
    for (Index j = 0; j < photos; ++j) flatten(s, j);
    s.value = (s.weight.array() > 0).select(s.value.array().exp() - 1, 0.0).matrix();  // relative to flat
    return s;
}

MatrixXd residual_of(const RelativeShading& s, const ShadingFactors& f) {
    MatrixXd residual(s.value.rows(), s.value.cols());
    for (Index j = 0; j < residual.cols(); ++j)
        for (Index i = 0; i < residual.rows(); ++i) {
            const double shading = f.left(i, 0) * f.right(j, 0) + f.left(i, 1) * f.right(j, 1);
            residual(i, j) = s.value(i, j) + 1 - f.level[j] * (1 + shading);
        }
    return residual;
}

ShadingFactors factored(const RelativeShading& s, const Progress& progress) {
    ShadingFactors f;
    // Highlights and shadows are an order stronger than relief: untamed, they would be the factors.
    MatrixXd tame = s.value;
    for (Index j = 0; j < tame.cols(); ++j) {
        const double most = kTame * scale_of(s.value.col(j), s.weight.col(j));
        tame.col(j) = tame.col(j).cwiseMax(-most).cwiseMin(most);
    }
    MatrixXd products(tame.cols(), tame.cols());
    for (Index j = 0; j < tame.cols(); ++j)
        for (Index k = 0; k <= j; ++k) products(j, k) = products(k, j) = tame.col(j).dot(tame.col(k));
    f.right = symmetric_eigen(products).vectors.rightCols(2) * std::sqrt(static_cast<double>(s.value.cols()));
    f.left = MatrixXd::Zero(s.value.rows(), 2);
    f.level = VectorXd::Ones(s.value.cols());
    MatrixXd weight = s.weight, residual;
    VectorXd scales(s.value.cols());
    for (int iteration = 0; iteration < kShadingIterations; ++iteration) {
        report(progress, "lights", iteration / static_cast<double>(kShadingIterations));
        solve_pixels(s.value, weight, f);
        centre_pixels(s.weight, f.left);
        solve_photos(s.value, weight, f);
        residual = residual_of(s, f);
        for (Index j = 0; j < s.value.cols(); ++j) {
            // Each photograph has its own noise: shadows and highlights are more under low lights.
            const double scale = scales[j] = scale_of(residual.col(j), s.weight.col(j));
            weight.col(j) =
                (s.weight.col(j).array() / (1 + (residual.col(j) / (kRobust * scale)).array().square())) *
                (0.0025 / (0.0025 + scale * scale));
        }
    }
    f.residual = median(std::vector<double>(scales.data(), scales.data() + scales.size())) / 1.4826;
    const double all = (weight.array() * s.value.array().square()).sum();
    f.explained = all > 0 ? 1 - (weight.array() * residual.array().square()).sum() / all : 0;
    return f;
}

}  // namespace tangi
