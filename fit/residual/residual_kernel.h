// residual_kernel.h: with which kernel the residuals of the relighting residual are predicted best from one
// another. For residual_fit.cpp alone: names of its own namespace, and Eigen.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <glm/mat3x3.hpp>
#include <limits>
#include <vector>

#include "fit/residual/residual_fit.h"
#include "surface/image/colour.h"

namespace tangi::residual_kernel {

using Matrix = Eigen::MatrixXd;
using Kernel = RelightingResidual::Kernel;

// Colours between the surface and what the camera saw.
struct Colours {
    glm::mat3 to_photo{1};  // linear Rec. 709 of relight() -> linear values of the photograph
    glm::mat3 from_photo{1};
    Transfer transfer;
    float clipped = std::numeric_limits<float>::infinity();  // linear value of the photograph
};

// What one photograph shows at the samples.
struct Sampled {
    std::vector<Rgb> stored;      // encoded; NaN where the photograph does not reach
    std::vector<Rgb> relit;       // linear, of the photograph
    std::vector<Rgb> irradiance;  // [1]
};

// Everything that the choice of the kernel needs: residuals [photograph][3 sample + component], and the
// samples.
struct Samples {
    Matrix residual;
    std::vector<Sampled> photos;
    std::vector<glm::mat3> to_rgb;  // of each sample: the pixel's colour frame
};

// [dB] PSNR of one photograph's samples with a residual for each of them; the surface alone where it is 0.
double psnr_with(const Samples& samples, const Colours& colours, std::size_t photo,
                 const std::function<Vec3(std::size_t sample)>& residual);

Matrix kernel_matrix(const std::vector<Vec3>& directions, Kernel kernel, double reach);
Matrix inverse_of(const Matrix& kernel, double ridge);  // of the kernel with the ridge on its diagonal

struct Choice {
    Kernel kernel = Kernel::gaussian;
    double reach = 0.3, ridge = 1;
    std::vector<double> photos_db;  // [dB] of each photograph, predicted from the others
    double mean_db = -1e9;
};

// Of all kernels, reaches and ridges the one that predicts each photograph best from the others; of those
// that do so as well, the one of the largest ridge, then of the least reach.
Choice choose_kernel(const Samples& samples, const Colours& colours, const std::vector<Vec3>& directions,
                     const Progress& progress);

// Few functions of the light's direction in place of what the regression of residuals x says: it predicts
// k(l)^T inverse x, which coefficients^T x and functions^T k(l) stand for.
struct FewFunctions {
    Matrix coefficients, functions;  // [photograph][term]
};

// By the principal components of what it predicts at the photographs, as bright as it is there: M = D K
// inverse X, of samples X, is about U U^T M.
FewFunctions few_functions(const Matrix& kernel, const Matrix& inverse, const Eigen::VectorXd& irradiance,
                           const Matrix& samples, int most);

}  // namespace tangi::residual_kernel
