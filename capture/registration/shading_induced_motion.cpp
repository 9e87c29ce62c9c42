#include "capture/registration/shading_induced_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/core.hpp>

#include "capture/registration/alignment.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

constexpr int kMostTerms = 8;
constexpr double kExceeds = 4;        // [1] ratio of variances a degree of freedom
constexpr double kShadingCauchy = 2;  // [scales]
constexpr double kLeastScale_px = 0.01;

cv::Mat1d terms_of(const glm::dvec3& l) {
    const double z = std::max(l.z, 0.2);
    return (cv::Mat1d(kMostTerms, 1) << 1, l.x, l.y, l.x / z, l.y / z, l.x * l.x, l.x * l.y, l.y * l.y);
}

// Shifts as a smooth function of the light: of n terms, robustly.
cv::Mat1d shading_terms(const std::vector<glm::dvec2>& shifts, const std::vector<glm::dvec3>& lights,
                        const std::vector<bool>& counted, int n) {
    cv::Mat1d c = cv::Mat1d::zeros(n, 2);
    double scale = 0;
    for (int round = 0; round < 10; ++round) {
        cv::Mat1d a = cv::Mat1d::eye(n, n) * 1e-6, b = cv::Mat1d::zeros(n, 2);
        std::vector<double> deviations;
        for (std::size_t i = 0; i < shifts.size(); ++i) {
            if (!counted[i]) continue;
            const cv::Mat1d f = terms_of(lights[i]).rowRange(0, n);
            const cv::Mat1d d = (cv::Mat1d(1, 2) << shifts[i].x, shifts[i].y);
            const double r = cv::norm(d - f.t() * c);
            const double t = round == 0 ? 0 : r / (kShadingCauchy * scale);
            const double w = 1 / (1 + t * t);
            a += w * f * f.t();
            b += w * f * d;
        }
        cv::solve(a, b, c, cv::DECOMP_SVD);
        for (std::size_t i = 0; i < shifts.size(); ++i) {
            if (!counted[i]) continue;
            const cv::Mat1d p = terms_of(lights[i]).rowRange(0, n).t() * c;
            deviations.push_back(std::hypot(shifts[i].x - p(0), shifts[i].y - p(1)));
        }
        scale = std::max(median(std::move(deviations)), kLeastScale_px);
    }
    return c;
}

// What goes with the light in each photograph, less what all have in common.
std::vector<glm::dvec2> shading_of_photos(const cv::Mat1d& terms, const std::vector<glm::dvec3>& lights,
                                          const std::vector<bool>& counted) {
    std::vector<glm::dvec2> shading;
    double x = 0, y = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        cv::Mat1d f = terms_of(lights[i]).rowRange(0, terms.rows).clone();
        f(0) = 0;
        const cv::Mat1d p = f.t() * terms;
        shading.emplace_back(p(0), p(1));
        if (counted[i]) x += p(0), y += p(1);
    }
    const auto count = std::count(counted.begin(), counted.end(), true);
    const glm::dvec2 mean = glm::dvec2(x, y) / static_cast<double>(std::max<std::ptrdiff_t>(count, 1));
    for (glm::dvec2& of_photo : shading) of_photo -= mean;
    return shading;
}

// Sum of squares of those that are counted, from their median.
double squares_from_middle(const std::vector<glm::dvec2>& shifts, const std::vector<bool>& counted) {
    std::vector<double> xs, ys;
    for (std::size_t i = 0; i < shifts.size(); ++i)
        if (counted[i]) xs.push_back(shifts[i].x), ys.push_back(shifts[i].y);
    const glm::dvec2 middle(median(std::move(xs)), median(std::move(ys)));
    double squares = 0;
    for (std::size_t i = 0; i < shifts.size(); ++i) {
        if (!counted[i]) continue;
        const glm::dvec2 beyond = shifts[i] - middle;
        squares += glm::dot(beyond, beyond);
    }
    return squares;
}

}  // namespace

SharedShading shared_shading(const std::vector<glm::dvec2>& shifts, const std::vector<glm::dvec3>& lights,
                             const std::vector<bool>& counted) {
    SharedShading result;
    const auto count = std::count(counted.begin(), counted.end(), true);
    const int n = count >= 24 ? 8 : count >= 14 ? 5 : count >= Alignment::kEnoughForRelief ? 3 : 1;
    result.of_photo = shading_of_photos(shading_terms(shifts, lights, counted, n), lights, counted);
    double smooth = 0;
    for (std::size_t i = 0; i < shifts.size(); ++i) {
        result.rest.push_back(shifts[i] - result.of_photo[i]);
        if (counted[i]) smooth += glm::dot(result.of_photo[i], result.of_photo[i]);
    }
    const double rest = squares_from_middle(result.rest, counted);
    const double free = std::max<double>(1, static_cast<double>(count - n));
    result.taken_up = std::sqrt(static_cast<double>(std::max<std::ptrdiff_t>(count, 1)) / free);
    result.rms_px = std::sqrt(smooth / std::max<double>(1, static_cast<double>(count)));
    result.exceeds_motion = n > 1 && smooth / (n - 1) > kExceeds * rest / free;
    return result;
}

}  // namespace tangi
