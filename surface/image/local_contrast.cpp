#include "surface/image/local_contrast.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr double kMeanSigma = 8;    // [pixels] of the local mean
constexpr double kSmoothing = 0.8;  // [pixels] against noise, and for the interpolation's sake

// Catmull-Rom weights of four neighbours at t in [0, 1), and of the derivative.
void cubic(float t, float (&w)[4], float (&d)[4]) {
    const float t2 = t * t, t3 = t2 * t;
    w[0] = (-t3 + 2 * t2 - t) / 2;
    w[1] = (3 * t3 - 5 * t2 + 2) / 2;
    w[2] = (-3 * t3 + 4 * t2 + t) / 2;
    w[3] = (t3 - t2) / 2;
    d[0] = (-3 * t2 + 4 * t - 1) / 2;
    d[1] = (9 * t2 - 10 * t) / 2;
    d[2] = (-9 * t2 + 8 * t + 1) / 2;
    d[3] = (3 * t2 - 2 * t) / 2;
}

}  // namespace

namespace {

cv::Mat blurred(const cv::Mat& picture, double sigma) {
    cv::Mat result;
    cv::GaussianBlur(picture, result, {}, sigma, sigma, cv::BORDER_REFLECT);
    return result;
}

// The mean of what is known around each pixel (normalised convolution: Knutsson & Westin 1993).
cv::Mat mean_of_known(const cv::Mat& filled, const cv::Mat& known, double sigma) {
    return known.empty() ? blurred(filled, sigma) : cv::Mat(blurred(filled, sigma) / blurred(known, sigma));
}

}  // namespace

Image<float> local_contrast(const Image<float>& brightness, double floor) {
    Image<float> result(brightness.width(), brightness.height());
    cv::Mat filled = view_of(brightness), known;
    if (std::ranges::any_of(brightness.pixels(), [](float value) { return std::isnan(value); })) {
        cv::Mat(filled == filled).convertTo(known, CV_32F, 1.0 / 255);  // NaN is not itself
        filled = filled.clone();
        cv::patchNaNs(filled, 0);
    }
    const cv::Mat mean = mean_of_known(filled, known, kMeanSigma),
                  smooth = mean_of_known(filled, known, kSmoothing);
    for (int y = 0; y < result.height(); ++y) {
        const auto *m = mean.ptr<float>(y), *s = smooth.ptr<float>(y);
        for (int x = 0; x < result.width(); ++x)
            result(x, y) = std::isnan(brightness(x, y))
                               ? brightness(x, y)
                               : std::clamp((s[x] - m[x]) / (m[x] + static_cast<float>(floor)), -1.0f, 1.0f);
    }
    return result;
}

bool sample_at(const Image<float>& image, const glm::dvec2& p, float& value, float& dx, float& dy) {
    const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
    if (!(p.x >= 1 && p.y >= 1 && x < image.width() - 2 && y < image.height() - 2)) return false;
    float wx[4], wy[4], gx[4], gy[4];
    cubic(static_cast<float>(p.x - x), wx, gx);
    cubic(static_cast<float>(p.y - y), wy, gy);
    value = dx = dy = 0;
    for (int j = 0; j < 4; ++j) {
        const float* row = &image(x - 1, y - 1 + j);
        const float v = row[0] * wx[0] + row[1] * wx[1] + row[2] * wx[2] + row[3] * wx[3];
        value += wy[j] * v;
        dy += gy[j] * v;
        dx += wy[j] * (row[0] * gx[0] + row[1] * gx[1] + row[2] * gx[2] + row[3] * gx[3]);
    }
    return !std::isnan(value);
}

}  // namespace tangi
