#include "surface/image/homography.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "surface/base/error.h"

namespace tangi {

namespace {

Homography homography_of(const cv::Mat& m) {
    Homography h;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) h[column][row] = m.at<double>(row, column);
    return h;
}

}  // namespace

Homography homography_between(const Corners& from, const Corners& to) {
    const std::optional<Homography> h = homography_through(from, to);
    TP_REQUIRE(h, "three of the points lie on a line");
    return *h;
}

std::optional<Homography> homography_through(std::span<const glm::dvec2> from, std::span<const glm::dvec2> to,
                                             double stray) {
    TP_REQUIRE(from.size() == to.size(), "points come in pairs");
    if (from.size() < 4) return std::nullopt;
    std::vector<cv::Point2d> a, b;
    for (const glm::dvec2& p : from) a.emplace_back(p.x, p.y);
    for (const glm::dvec2& p : to) b.emplace_back(p.x, p.y);
    const cv::Mat m = stray > 0 ? cv::findHomography(a, b, cv::RANSAC, stray, cv::noArray(), 500)
                                : cv::findHomography(a, b, 0);
    if (m.empty()) return std::nullopt;
    const Homography h = homography_of(m);
    const double size = glm::determinant(h);
    if (!std::isfinite(size) || std::abs(size) < 1e-12) return std::nullopt;
    return h;
}

}  // namespace tangi
