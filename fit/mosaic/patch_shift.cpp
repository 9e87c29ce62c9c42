#include "fit/mosaic/patch_shift.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include "surface/image/local_contrast.h"

namespace tangi {

namespace {

using glm::dmat2;
using glm::dvec2;

constexpr int kIterations = 12;
constexpr double kStill = 1e-3;     // [pixels]
constexpr double kLeastPart = 0.5;  // of the patch that must be known in both
// [1] Neighbouring pixels of local contrast share noise: it is smoothed with a standard deviation of 0.8
// pixels, so that independent ones are 4 pi 0.8^2 apart.
constexpr double kPixelsAlike = 8;
constexpr double kSharpest = 0.01;  // [pixels] no patch is better known
constexpr double kDullest = 0.5;    // [pixels] what is less well known is not found

// Sums over the patch of one kind of picture.
struct PatchSums {
    dmat2 normal{0};
    dvec2 right{0};
    double squares = 0, count = 0, pixels = 0;
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;

    void add(double own, double other, const dvec2& gradient) {
        const double off = other - own;
        normal += glm::outerProduct(gradient, gradient);
        right += gradient * off;
        squares += off * off, ++count;
        a += own, b += other, aa += own * own, bb += other * other, ab += own * other;
    }
    double variance() const { return std::max(squares / std::max(count, 1.0), 1e-8); }
};

PatchSums sums_at(const Image<float>& own, const Image<float>& other, const dvec2& centre, double half,
                  const Homography& to_other, const dvec2& shift) {
    PatchSums sums;
    const dvec2 low = glm::max(glm::ceil(centre - half), dvec2(0));
    const dvec2 high = glm::min(glm::floor(centre + half), dvec2(own.width() - 1, own.height() - 1));
    for (int y = static_cast<int>(low.y); y <= static_cast<int>(high.y); ++y)
        for (int x = static_cast<int>(low.x); x <= static_cast<int>(high.x); ++x) {
            ++sums.pixels;
            float value, dx, dy;
            const float here = own(x, y);
            if (std::isnan(here) || !sample_at(other, mapped(to_other, dvec2(x, y)) + shift, value, dx, dy))
                continue;
            sums.add(here, value, {dx, dy});
        }
    return sums;
}

double correlation_of(const std::array<PatchSums, 2>& kinds) {
    double shared = 0, own = 0, other = 0;
    for (const PatchSums& s : kinds) {
        if (!(s.count > 0)) continue;
        const double weight = 1 / s.variance();
        shared += weight * (s.ab - s.a * s.b / s.count);
        own += weight * (s.aa - s.a * s.a / s.count);
        other += weight * (s.bb - s.b * s.b / s.count);
    }
    return own > 0 && other > 0 ? shared / std::sqrt(own * other) : 0;
}

}  // namespace

PatchShift patch_shift(const LookPictures& own, const LookPictures& other, const dvec2& centre, double half,
                       const Homography& to_other, double reach) {
    PatchShift result;
    std::array<PatchSums, 2> sums;
    dmat2 covariance(0);
    double step = reach;
    for (int i = 0; i < kIterations && step > kStill; ++i) {
        dmat2 normal(0);
        dvec2 right(0);
        for (std::size_t kind = 0; kind < 2; ++kind) {
            PatchSums& s = sums[kind];
            s = sums_at(own[kind], other[kind], centre, half, to_other, result.shift);
            if (s.count < kLeastPart * s.pixels) return result;
            const double weight = 1 / (kPixelsAlike * s.variance());
            normal += weight * s.normal, right += weight * s.right;
        }
        if (!(glm::determinant(normal) > 0)) return result;
        covariance = glm::inverse(normal);
        const dvec2 move = -(covariance * right);
        result.shift += move;
        step = glm::length(move);
        if (!(glm::length(result.shift) < reach)) return result;
    }
    result.correlation = correlation_of(sums);
    result.sigma = std::hypot(std::sqrt(std::max(covariance[0][0], covariance[1][1])), kSharpest);
    result.found = step < 0.1 && result.sigma < kDullest;
    return result;
}

}  // namespace tangi
