#include "fit/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "surface/error.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kWindow = 11;     // [pixels] of SSIM
constexpr double kSigma = 1.5;  // [pixels]
constexpr float kC1 = 0.01f * 0.01f, kC2 = 0.03f * 0.03f;

template <class A, class B>
void require_alike(const Image<A>& a, const Image<B>& b, const Mask& mask) {
    TP_REQUIRE(a.region() == b.region(), "both pictures have the same size");
    TP_REQUIRE(mask.empty() || mask.region() == a.region(), "the mask has the size of the pictures");
}

Rgb clamped(const Rgb& c) {
    return {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
}

bool counts(const Mask& mask, int x, int y) { return mask.empty() || mask(x, y) != 0; }

// Mean of value(x, y) over the pixels of `region` that count; nothing where none do. Rows are summed apart,
// then in order, so that threads change nothing.
template <class Value>
std::optional<double> mean_over(const Region& region, const Mask& mask, Value&& value) {
    std::vector<double> sums(static_cast<std::size_t>(std::max(region.y1, 0)));
    std::vector<long> numbers(sums.size());
    parallel_for(region.y0, region.y1, 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            double sum = 0;
            long number = 0;
            for (int x = region.x0; x < region.x1; ++x) {
                if (!counts(mask, x, y)) continue;
                sum += value(x, y);
                ++number;
            }
            sums[static_cast<std::size_t>(y)] = sum;
            numbers[static_cast<std::size_t>(y)] = number;
        }
    });
    double sum = 0;
    long number = 0;
    for (std::size_t y = 0; y < sums.size(); ++y) {
        sum += sums[y];
        number += numbers[y];
    }
    if (number == 0) return std::nullopt;
    return sum / static_cast<double>(number);
}

template <class Value>
double required_mean(const Region& region, const Mask& mask, Value&& value) {
    const auto result = mean_over(region, mask, value);
    TP_REQUIRE(result.has_value(), "the mask leaves pixels to compare");
    return *result;
}

cv::Mat luma_of(const Image<Rgb>& picture) {
    cv::Mat luma(picture.height(), picture.width(), CV_32F);
    for (int y = 0; y < picture.height(); ++y) {
        float* row = luma.ptr<float>(y);
        for (int x = 0; x < picture.width(); ++x) row[x] = luminance(clamped(picture(x, y)));
    }
    return luma;
}

// Sums under the window; nothing lies beyond the border.
cv::Mat windowed(const cv::Mat& values) {
    cv::Mat sums;
    cv::GaussianBlur(values, sums, {kWindow, kWindow}, kSigma, kSigma, cv::BORDER_CONSTANT);
    return sums;
}

}  // namespace

Mask measured(const Image<float>& confidence) {
    Mask mask(confidence.width(), confidence.height());
    for (std::size_t i = 0; i < mask.size(); ++i) mask.pixels()[i] = confidence.pixels()[i] > 0;
    return mask;
}

double psnr_db(const Image<Rgb>& a, const Image<Rgb>& b, const Mask& mask) {
    require_alike(a, b, mask);
    const double error2 = required_mean(a.region(), mask, [&](int x, int y) {
        const glm::dvec3 d(clamped(a(x, y)) - clamped(b(x, y)));
        return glm::dot(d, d) / 3;
    });
    return error2 == 0 ? std::numeric_limits<double>::infinity() : -10 * std::log10(error2);
}

double mean_difference(const Image<Rgb>& a, const Image<Rgb>& b, const Mask& mask) {
    require_alike(a, b, mask);
    return required_mean(a.region(), mask, [&](int x, int y) {
        const glm::dvec3 d(clamped(b(x, y)) - clamped(a(x, y)));
        return (d.x + d.y + d.z) / 3;
    });
}

Image<float> luma_difference(const Image<Rgb>& a, const Image<Rgb>& b) {
    require_alike(a, b, {});
    Image<float> difference(a.width(), a.height());
    for (std::size_t i = 0; i < a.size(); ++i)
        difference.pixels()[i] = luminance(clamped(b.pixels()[i])) - luminance(clamped(a.pixels()[i]));
    return difference;
}

Image<float> ssim_map(const Image<Rgb>& a, const Image<Rgb>& b, const Mask& mask) {
    require_alike(a, b, mask);
    Image<float> map(a.width(), a.height());
    if (map.empty()) return map;
    cv::Mat weight(a.height(), a.width(), CV_32F, cv::Scalar(1));
    for (int y = 0; y < a.height() && !mask.empty(); ++y)
        for (int x = 0; x < a.width(); ++x) weight.at<float>(y, x) = mask(x, y) != 0;

    const cv::Mat luma_a = luma_of(a), luma_b = luma_of(b);
    const cv::Mat weighted_a = luma_a.mul(weight), weighted_b = luma_b.mul(weight);
    const cv::Mat total = windowed(weight), sum_a = windowed(weighted_a), sum_b = windowed(weighted_b);
    const cv::Mat sum_aa = windowed(weighted_a.mul(luma_a)), sum_bb = windowed(weighted_b.mul(luma_b));
    const cv::Mat sum_ab = windowed(weighted_a.mul(luma_b));
    parallel_for(0, a.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < a.width(); ++x) {
                if (!counts(mask, x, y)) continue;
                const float w = total.at<float>(y, x);
                const float mean_a = sum_a.at<float>(y, x) / w, mean_b = sum_b.at<float>(y, x) / w;
                const float variance_a = std::max(sum_aa.at<float>(y, x) / w - mean_a * mean_a, 0.0f);
                const float variance_b = std::max(sum_bb.at<float>(y, x) / w - mean_b * mean_b, 0.0f);
                const float covariance = sum_ab.at<float>(y, x) / w - mean_a * mean_b;
                map(x, y) = (2 * mean_a * mean_b + kC1) * (2 * covariance + kC2) /
                            ((mean_a * mean_a + mean_b * mean_b + kC1) * (variance_a + variance_b + kC2));
            }
    });
    return map;
}

double ssim(const Image<Rgb>& a, const Image<Rgb>& b, const Mask& mask) {
    const Image<float> map = ssim_map(a, b, mask);
    const auto value = [&](int x, int y) { return static_cast<double>(map(x, y)); };
    constexpr int half = kWindow / 2;
    const Region inner{half, half, map.width() - half, map.height() - half};
    const auto inside = inner.empty() ? std::nullopt : mean_over(inner, mask, value);
    return inside ? *inside : required_mean(map.region(), mask, value);
}

Image<float> delta_e_2000_map(const Image<Rgb>& a, const Image<Rgb>& b) {
    require_alike(a, b, {});
    Image<float> map(a.width(), a.height());
    parallel_for(0, a.height(), 4, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < a.width(); ++x)
                map(x, y) = static_cast<float>(
                    delta_e_2000(lab_from_linear(clamped(a(x, y))), lab_from_linear(clamped(b(x, y)))));
    });
    return map;
}

double mean(const Image<float>& values, const Mask& mask) {
    require_alike(values, values, mask);
    return required_mean(values.region(), mask,
                         [&](int x, int y) { return static_cast<double>(values(x, y)); });
}

double percentile(const Image<float>& values, double part, const Mask& mask) {
    require_alike(values, values, mask);
    TP_REQUIRE(part >= 0 && part <= 1, "a part lies in 0..1");
    std::vector<float> sorted;
    sorted.reserve(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        if ((mask.empty() || mask.pixels()[i]) && !std::isnan(values.pixels()[i]))
            sorted.push_back(values.pixels()[i]);
    if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto at = sorted.begin() + std::llround(part * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
}

}  // namespace tangi
