#include "capture/geometry/scale_agreement.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "capture/geometry/plane_pose.h"
#include "surface/base/error.h"
#include "surface/image/homography.h"

namespace tangi {

using glm::dvec2;

namespace {

constexpr double kDisagree = 3;                  // [sigma] from which on two scales are said to disagree
constexpr double kDisagreeLeast = 0.01;          // [1] and by which part at least
constexpr double kAspectLeast = 0.02;            // [1] of width by height
constexpr double kShortest = 0.5, kLongest = 4;  // [diagonals] focal lengths
constexpr int kFocalSteps = 40;

double relative_error(const Scale& scale) { return scale.sigma / scale.mm_per_pixel; }

// By which part b says more than a.
double excess(const Scale& a, const Scale& b, const RelativeScale& relative) {
    return b.mm_per_pixel / a.mm_per_pixel * relative(a.place_px) / relative(b.place_px) - 1;
}

bool agree(const Scale& a, const Scale& b, const RelativeScale& relative) {
    const double sigma = std::hypot(relative_error(a), relative_error(b));
    return std::abs(excess(a, b, relative)) <= std::max(kDisagreeLeast, kDisagree * sigma);
}

// ln of how much too wide the rectangle looks to a camera of this focal length, as its pose in space tells.
double stretch_of(const Homography& plane_to_picture, double focal_px, const dvec2& principal_px) {
    return std::log(pose_of(plane_to_picture, focal_px, principal_px).stretch);
}

}  // namespace

void rank_scales(std::vector<Scale>& scales, const RelativeScale& relative) {
    std::stable_sort(scales.begin(), scales.end(),
                     [](const Scale& a, const Scale& b) { return relative_error(a) < relative_error(b); });
    std::size_t best = 0;
    std::ptrdiff_t most = -1;
    for (std::size_t i = 0; i < scales.size(); ++i) {
        const auto votes = std::count_if(scales.begin(), scales.end(), [&](const Scale& other) {
            return agree(scales[i], other, relative);
        });
        if (votes > most) most = votes, best = i;
    }
    if (!scales.empty())
        std::rotate(scales.begin(), scales.begin() + static_cast<std::ptrdiff_t>(best),
                    scales.begin() + static_cast<std::ptrdiff_t>(best) + 1);
}

std::vector<std::string> contradictions(const std::vector<Scale>& scales, const RelativeScale& relative) {
    std::vector<std::string> all;
    for (std::size_t i = 1; i < scales.size(); ++i) {
        const Scale &a = scales.front(), &b = scales[i];
        if (agree(a, b, relative)) continue;
        const double off = excess(a, b, relative);
        all.push_back(fmt::format(
            "the scale by {} is {:.5g} ± {:.2g} mm per pixel, that by {} {:.5g} ± {:.2g}, {:.1f} % {}; the "
            "former is used. Check the lengths, and that both lie in the painting's plane",
            a.method, a.mm_per_pixel, a.sigma, b.method, b.mm_per_pixel, b.sigma, 100 * std::abs(off),
            off > 0 ? "more" : "less"));
    }
    return all;
}

std::optional<std::string> contradiction_of_corners(const Corners& corners_px, const dvec2& size_mm,
                                                    const std::optional<double>& focal_px,
                                                    const dvec2& principal_px, double diagonal_px) {
    const dvec2 half = size_mm / 2.0;
    const Corners plane = {dvec2(-half.x, half.y), half, dvec2(half.x, -half.y), -half};
    const Homography h = homography_between(plane, corners_px);
    const Corners& c = corners_px;
    const dvec2 right = c[1] - c[0], below = c[3] - c[0];
    if (!(right.x * below.y - right.y * below.x > 0))
        return "the corners run anticlockwise, as if the painting were seen from behind; give them from the "
               "top "
               "left clockwise";
    const double across = (glm::length(c[1] - c[0]) + glm::length(c[2] - c[3])) / 2;
    const double down = (glm::length(c[3] - c[0]) + glm::length(c[2] - c[1])) / 2;
    double off = 0;
    if (focal_px) {
        off = stretch_of(h, *focal_px, principal_px);
    } else {
        off = std::log(across / down * size_mm.y / size_mm.x);
        double sign = 0;
        for (int i = 0; i <= kFocalSteps; ++i) {
            const double focal =
                diagonal_px * kShortest * std::pow(kLongest / kShortest, i / double(kFocalSteps));
            const double stretch = stretch_of(h, focal, principal_px);
            if (sign * stretch < 0) return {};  // one between fits exactly
            sign = stretch;
            if (std::abs(stretch) < std::abs(off)) off = stretch;
        }
    }
    const double sigma = kPointSigma_px * std::hypot(1 / across, 1 / down);
    if (std::abs(off) <= std::max(kAspectLeast, kDisagree * sigma)) return {};
    return fmt::format(
        "the corners are {:.0f} x {:.0f} pixels apart, which is {:.1f} % too {} for {:g} x {:g} mm, whatever "
        "the camera's place{}; {:g} x {:.4g} mm or {:.4g} x {:g} mm would fit. Check the size{} and the "
        "corners",
        across, down, 100 * std::expm1(std::abs(off)), off > 0 ? "wide" : "high", size_mm.x, size_mm.y,
        focal_px ? fmt::format(" at a focal length of {:.0f} pixels", *focal_px) : "", size_mm.x,
        size_mm.y * std::exp(-off), size_mm.x * std::exp(off), size_mm.y,
        focal_px ? ", the focal length" : "");
}

}  // namespace tangi
