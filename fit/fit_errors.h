// fit_errors.h: how certain each map of a fitted painting is.
#pragma once

#include "surface/image.h"

namespace tangi {

// Standard errors of each pixel, of the size of the surface; 0 where it was not measured. They say how far
// noise and what the model leaves out, as large as the residuals show it, may have moved a value; not what
// wrong light directions do to all pixels alike.
struct FitErrors {
    Image<float> slope;      // [1] of dz/dx and dz/dy, root of the mean of both variances
    Image<float> diffuse;    // [1] of rho_d, mean of the channels
    Image<float> specular;   // [1] of rho_s
    Image<float> roughness;  // [1] of alpha

    FitErrors() = default;
    FitErrors(int width, int height)
        : slope(width, height), diffuse(width, height), specular(width, height), roughness(width, height) {}
};

}  // namespace tangi
