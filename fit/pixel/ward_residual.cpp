#include "fit/pixel/ward_residual.h"

#include <algorithm>

namespace tangi {

void WardResiduals::evaluate(const double* theta, const glm::dvec2& stretch, double* residuals,
                             double* jacobian, int columns) const {
    const int channels = samples_.channels, rows = size();
    if (jacobian) std::fill_n(jacobian, rows * columns, 0.0);
    const auto at = [&](int row, int column) -> double& { return jacobian[column * rows + row]; };
    const StretchTerms terms(stretch);
    const StretchTerms* anisotropic =
        columns > kWardParameters || stretch != glm::dvec2(0) ? &terms : nullptr;
    int row = 0;
    for (int i = 0; i < samples_.photos(); ++i) {
        const WardTerms t = ward_terms(theta, samples_.light[static_cast<std::size_t>(i)], samples_.view,
                                       reflectance_model_, anisotropic);
        const double matt = t.matt + samples_.ambient[static_cast<std::size_t>(i)];
        for (int c = 0; c < channels; ++c, ++row) {
            const auto index = static_cast<std::size_t>(row);
            residuals[row] = 0;
            if (samples_.sigma[index] == 0) continue;
            const double sigma = std::abs(samples_.sigma[index]);
            const double scale = samples_.irradiance[index] / sigma;
            const double diffuse = theta[kWardCommon + c], specular = theta[3];
            const double plain = scale * (diffuse * matt + specular * t.lobe) - samples_.value[index] / sigma;
            if (samples_.sigma[index] < 0 && plain >= 0) continue;
            const RobustValue robust = root_cauchy(plain, robust_scale_);
            residuals[row] = robust.value;
            if (!jacobian) continue;
            const double d = scale * robust.derivative;
            at(row, 0) = d * (diffuse * t.dmatt[0] + specular * t.dlobe[0]);
            at(row, 1) = d * (diffuse * t.dmatt[1] + specular * t.dlobe[1]);
            at(row, 2) = d * specular * t.dlobe[2];
            at(row, 3) = d * t.lobe;
            at(row, kWardCommon + c) = d * matt;
            for (int k = kWardParameters; k < columns; ++k)
                at(row, k) = d * specular * t.dstretch[k - kWardParameters];
        }
    }
    residuals[row] = (theta[2] - prior_.ln_alpha) / prior_.ln_alpha_sigma;
    residuals[row + 1] = (theta[3] - prior_.specular) / prior_.specular_sigma;
    for (int i = 0; i < 2; ++i) residuals[row + 2 + i] = (theta[i] - prior_.slope[i]) / prior_.slope_sigma[i];
    if (jacobian) {
        at(row, 2) = 1 / prior_.ln_alpha_sigma;
        at(row + 1, 3) = 1 / prior_.specular_sigma;
        for (int i = 0; i < 2; ++i) at(row + 2 + i, i) = 1 / prior_.slope_sigma[i];
    }
}

double WardResiduals::cost(const double* theta, const glm::dvec2& stretch) const {
    // sum ln(1 + s) = ln prod (1 + s); the product is folded before it can overflow.
    double product = 1, logarithm = 0;
    const double inverse_c2 = 1 / (robust_scale_ * robust_scale_);
    const StretchTerms terms(stretch);
    const StretchTerms* anisotropic = stretch != glm::dvec2(0) ? &terms : nullptr;
    for (int i = 0, row = 0; i < samples_.photos(); ++i) {
        const WardTerms t = ward_terms(theta, samples_.light[static_cast<std::size_t>(i)], samples_.view,
                                       reflectance_model_, anisotropic);
        const double matt = t.matt + samples_.ambient[static_cast<std::size_t>(i)];
        for (int c = 0; c < samples_.channels; ++c, ++row) {
            const auto at = static_cast<std::size_t>(row);
            if (samples_.sigma[at] == 0) continue;
            const double model =
                samples_.irradiance[at] * (theta[kWardCommon + c] * matt + theta[3] * t.lobe);
            const double r = (model - samples_.value[at]) / std::abs(samples_.sigma[at]);
            if (samples_.sigma[at] < 0 && r >= 0) continue;
            product *= 1 + r * r * inverse_c2;
            if (product > 1e100) {
                logarithm += std::log(product);
                product = 1;
            }
        }
    }
    const double alpha = (theta[2] - prior_.ln_alpha) / prior_.ln_alpha_sigma;
    const double specular = (theta[3] - prior_.specular) / prior_.specular_sigma;
    const double x = (theta[0] - prior_.slope.x) / prior_.slope_sigma.x;
    const double y = (theta[1] - prior_.slope.y) / prior_.slope_sigma.y;
    return robust_scale_ * robust_scale_ * (logarithm + std::log(product)) + alpha * alpha +
           specular * specular + x * x + y * y;
}

WardVector natural_of(const double* u, const WardBounds& bounds, double* derivative) {
    WardVector theta{};
    for (int i = 0; i < kWardParameters; ++i) {
        const auto [low, high] = ward_interval(bounds, i);
        const double half = (high - low) / 2;
        theta[static_cast<std::size_t>(i)] = low + half * (1 + std::sin(u[i]));
        if (derivative) derivative[i] = half * std::cos(u[i]);
    }
    return theta;
}

WardVector unbounded_of(const WardVector& theta, const WardBounds& bounds) {
    WardVector u{};
    for (int i = 0; i < kWardParameters; ++i) {
        const auto [low, high] = ward_interval(bounds, i);
        // Away from the ends, where the derivative vanishes and the solver would be stuck.
        const double t =
            std::clamp(2 * (theta[static_cast<std::size_t>(i)] - low) / (high - low) - 1, -0.9995, 0.9995);
        u[static_cast<std::size_t>(i)] = std::asin(t);
    }
    return u;
}

}  // namespace tangi
