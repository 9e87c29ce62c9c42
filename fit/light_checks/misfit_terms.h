// misfit_terms.h: the linear algebra of photo_misfit.h: causes by least squares on blocks, and the veil.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fit/light_checks/photo_misfit.h"

namespace tangi {

constexpr int kMisfitBox = 9;  // [pixels] side of the coarse blur

constexpr double kMisfitOutlier = 6;  // [standard deviations] robust

// Gain, room, constant, two of a direction, two of uneven light, what interpolation takes of the shortest
// waves, and a blur: fine and coarse.
constexpr int kMisfitTerms = 10;
using MisfitTerms = Eigen::Matrix<double, kMisfitTerms, 1>;
using MisfitSquare = Eigen::Matrix<double, kMisfitTerms, kMisfitTerms>;

// What a block of one photograph says: normal equations in units of the expected deviation, and what there is
// to explain.
struct MisfitNormal {
    MisfitSquare matrix = MisfitSquare::Zero();
    MisfitTerms right = MisfitTerms::Zero();
    double squares = 0;  // [sigma^2] sum over pixels
    long count = 0;      // pixels
};

// The causes in one photograph.
struct PhotoTerms {
    double rms = 0;       // [sigma]
    bool solved = false;  // the rest is known
    MisfitTerms terms = MisfitTerms::Zero();
    MisfitTerms errors = MisfitTerms::Zero();         // standard errors
    MisfitTerms sensitivities = MisfitTerms::Zero();  // [sigma] rms of what a term of 1 explains alone
    Eigen::Matrix2d blurs = Eigen::Matrix2d::Zero();  // [sigma^2] of both blurs together, likewise
};

// By blocks of each photograph: [photo][block].
std::vector<PhotoTerms> solve_photos(const std::vector<std::vector<MisfitNormal>>& photos);

// Room light and blur are taken against the middling photograph's: what all have alike is none of one
// photograph, but what the model lacks (soft shadows in place of sharp ones, a mosaic's interpolation).
// Without strengths.
std::vector<PhotoMisfit> relative_misfits(const std::vector<PhotoTerms>& photos);

// Of a place that no light reaches, in one channel; linear.
struct UnlitPlace {
    float white_rho = 0, value = 0;
    int x = 0, row = 0;  // of the stripe
    int block = 0;
};

// [1] linear, beside what is in proportion to rho_d; `middling` brightness for the effect.
MisfitTerm veil_of(const std::vector<UnlitPlace>& places, double middling);

}  // namespace tangi
