// relative_shading.h: what lights make of a nearly flat object beside its own brightness, and the two factors
// of it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "surface/base/progress.h"
#include "surface/image/image.h"

namespace tangi {

// value / (albedo * level of the photograph * what varies slowly over it) - 1: one column a photograph, one
// row a pixel; weight 0 where it is not known.
struct RelativeShading {
    int width = 0, height = 0;
    Eigen::MatrixXd value, weight;
    Eigen::VectorXd log_level;  // of the photographs
    Eigen::MatrixXd
        falloff;  // [photos x 2] how ln of the light grows to the right and upwards, a picture width
};

// 1 + value ~ level (1 + left right^T), left and right of two columns, robustly: least squares for one side
// and the other in turn. The mean of `left` is 0, so that `level` is what a flat object would show: the
// middle of what a relief shows lies below it, the more so the lower the light, as shadows and ln are not
// symmetric.
struct ShadingFactors {
    Eigen::MatrixXd left, right;  // [pixels x 2], [photos x 2]
    Eigen::VectorXd level;        // [photos]
    double residual = 0, explained = 0;
};

// Pictures in linear light, of one size; `clipped` is the value from which on they are.
RelativeShading shading_of(const std::vector<Image<float>>& pictures, float clipped);

ShadingFactors factored(const RelativeShading& shading, const Progress& progress = {});

}  // namespace tangi
