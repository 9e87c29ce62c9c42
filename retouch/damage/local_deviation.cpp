#include "retouch/damage/local_deviation.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "surface/base/error.h"

namespace tangi {

namespace {

// Values in 8 bits, and back.
struct Bytes {
    cv::Mat bytes;
    float low = 0, step = 1;
};

Bytes bytes_of(const cv::Mat& values) {
    Bytes b;
    b.low = quantile(values, 0.001);
    b.step = std::max((quantile(values, 0.999) - b.low) / 254, 1e-12f);
    values.convertTo(b.bytes, CV_8U, 1.0 / static_cast<double>(b.step), -static_cast<double>(b.low / b.step));
    return b;
}

cv::Mat median_of(const Bytes& b, int radius) {
    cv::Mat median, result;
    cv::medianBlur(b.bytes, median, 2 * std::clamp(radius, 1, 127) + 1);
    median.convertTo(result, CV_32F, static_cast<double>(b.step), static_cast<double>(b.low));
    return result;
}

}  // namespace

float quantile(const cv::Mat& values, double part) {
    TP_REQUIRE(values.type() == CV_32F && !values.empty(), "quantiles are of floats");
    std::vector<float> all;
    const std::size_t stride = std::max<std::size_t>(values.total() / 200000, 1);
    for (std::size_t i = 0; i < values.total(); i += stride) {
        const int y = static_cast<int>(i / static_cast<std::size_t>(values.cols));
        all.push_back(values.at<float>(y, static_cast<int>(i % static_cast<std::size_t>(values.cols))));
    }
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), at, all.end());
    return *at;
}

LocalStatistics local_statistics(const cv::Mat& values, int radius) {
    LocalStatistics s;
    s.median = median_of(bytes_of(values), radius);
    s.spread = local_spread(cv::abs(values - s.median), radius);
    return s;
}

cv::Mat local_spread(const cv::Mat& deviations, int radius) {
    return 1.4826 * median_of(bytes_of(deviations), radius);
}

cv::Mat disc(int radius) {
    return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
}

}  // namespace tangi
