// per_photo_light.h: the light that each photograph of a relief shows, whatever is listed for it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "capture/stack/survey.h"

namespace tangi {

// A sampled pixel of all photographs.
struct ReliefPixel {
    glm::dvec2 place{0};  // [1] -1 to 1 along the longer side
    int part = 0;         // of the picture; kReliefParts along each side
    glm::dvec3 g{0};      // rho_d times the normal
    bool valid = false;
    std::vector<double> values;  // [1] linear, of each photograph; NaN where clipped or not there
};

constexpr int kReliefParts = 4;

std::vector<ReliefPixel> relief_pixels(const Survey& survey, const Transfer& transfer, std::size_t photos,
                                       int width, int height);

// g of each pixel from the photographs that are used, robustly (photometric stereo, Woodham 1980).
void find_relief(std::vector<ReliefPixel>& pixels, const std::vector<Light>& lights,
                 const std::vector<bool>& used);

struct ShownLight {
    Eigen::Vector2d side{1, 0};  // [unit vector] where in the picture's plane it comes from
    double sigma_rad = 0;        // standard error of its angle, by leaving out a part in turn
    double explained = 0;        // [1] of what is uneven in the photograph, by the relief
    // [rad] How far from above it comes at the picture's middle, with its standard error. It hangs on what is
    // even in the picture, and so on gloss and ambient light, which are much alike for lights as high.
    double zenith_rad = 0, zenith_sigma_rad = 0;
};

// Regression of one photograph on g and what varies slowly over the picture (to the second degree), with
// Tukey's weights. Nothing where too few pixels are lit and not clipped, or the relief tells no side.
std::optional<ShownLight> per_photo_light(std::size_t photo, const std::vector<ReliefPixel>& pixels);

// [rad] Between two directions in the picture's plane.
double angle_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b);

}  // namespace tangi
