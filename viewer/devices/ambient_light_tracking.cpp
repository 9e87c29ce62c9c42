#include "viewer/devices/ambient_light_tracking.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace tangi {

std::optional<Vec3> brightest_direction(const Image<float>& luminance, double camera_width_deg) {
    constexpr float kStandsOut = 1.3f, kDark = 1e-4f, kOfMaximum = 0.95f;
    if (luminance.width() < 2 || luminance.height() < 2) return {};
    const cv::Mat picture(luminance.height(), luminance.width(), CV_32F,
                          const_cast<float*>(luminance.data()));
    cv::Mat blurred;
    cv::GaussianBlur(picture, blurred, {}, 0.1 * luminance.width(), 0, cv::BORDER_REPLICATE);
    double brightest = 0;
    cv::minMaxLoc(blurred, nullptr, &brightest);
    const double mean = cv::mean(blurred)[0];
    if (!(brightest > kDark) || brightest < kStandsOut * mean) return {};
    glm::dvec2 sum(0);
    double count = 0;
    for (int y = 0; y < blurred.rows; ++y)
        for (int x = 0; x < blurred.cols; ++x)
            if (blurred.at<float>(y, x) >= kOfMaximum * brightest) {
                sum += glm::dvec2(x, y);
                ++count;
            }
    const glm::dvec2 middle = 0.5 * glm::dvec2(blurred.cols - 1, blurred.rows - 1);
    return direction_in_room((sum / count - middle) / static_cast<double>(blurred.cols), camera_width_deg);
}

}  // namespace tangi
