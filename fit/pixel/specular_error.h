// specular_error.h: the standard error of rho_s where alpha is not well known.
#pragma once

#include <algorithm>
#include <cmath>

#include "fit/pixel/ward_residual.h"

namespace tangi {

// Variances and the covariance of ln alpha and rho_s at the solution.
struct LobeCovariance {
    double ln_alpha = 0, specular = 0, both = 0;
};

// [1] Root of the mean square of how far rho_s may be from what was fitted.
//
// What photographs tell of a wide or faint lobe is its peak, rho_s / alpha^2, and the Gaussian around the
// solution knows nothing of what follows for rho_s where alpha is twice what it is. So the peak is taken to
// be linear in ln alpha, as the covariance says, and normal beside that, and the mean goes over ln alpha
// (Gauss-Hermite quadrature with three nodes, within the bounds of alpha). Where alpha is known, this is the
// root of the variance.
inline double specular_error(double specular, double ln_alpha, const LobeCovariance& covariance,
                             const WardBounds& bounds) {
    if (!(covariance.ln_alpha > 0)) return std::sqrt(std::max(covariance.specular, 0.0));
    const double slope = covariance.both / covariance.ln_alpha;  // of rho_s by ln alpha
    const double given_alpha = std::max(covariance.specular - slope * covariance.both, 0.0);
    double square = 2.0 / 3 * given_alpha;
    for (const double side : {-1, 1}) {
        const double other = std::clamp(ln_alpha + side * std::sqrt(3 * covariance.ln_alpha),
                                        std::log(bounds.alpha_min), std::log(bounds.alpha_max));
        const double x = other - ln_alpha, wider = std::exp(2 * x);
        const double off = std::max(specular + (slope - 2 * specular) * x, 0.0) * wider - specular;
        square += (off * off + given_alpha * wider * wider) / 6;
    }
    return std::sqrt(std::max(square, covariance.specular));
}

}  // namespace tangi
