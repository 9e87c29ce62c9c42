#include "surface/image/metrics.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/image/colour_rows.h"

namespace tangi {

namespace {

constexpr int kWindow = 11;     // [pixels] of SSIM
constexpr double kSigma = 1.5;  // [pixels]
constexpr int kStripRows = 64;
constexpr std::size_t kBins = 1u << 16;  // of half a rank
constexpr float kC1 = 0.01f * 0.01f, kC2 = 0.03f * 0.03f;

template <class A, class B>
void require_alike(const Image<A>& a, const Image<B>& b, const PixelMask& mask) {
    TP_REQUIRE(a.region() == b.region(), "both pictures have the same size");
    TP_REQUIRE(mask.empty() || mask.region() == a.region(), "the mask has the size of the pictures");
}

Rgb clamped(const Rgb& c) {
    return {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
}

bool counts(const PixelMask& mask, int x, int y) { return mask.empty() || mask(x, y) != 0; }

// Mean of value(x, y) over the pixels of `region` that count; nothing where none do. Rows are summed apart,
// then in order, so that threads change nothing.
template <class Value>
std::optional<double> mean_over(const Region& region, const PixelMask& mask, Value&& value) {
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
double required_mean(const Region& region, const PixelMask& mask, Value&& value) {
    const auto result = mean_over(region, mask, value);
    TP_REQUIRE(result.has_value(), "the mask leaves pixels to compare");
    return *result;
}

// Sums under the window; nothing lies beyond the border.
cv::Mat windowed(const cv::Mat& values) {
    cv::Mat sums;
    cv::GaussianBlur(values, sums, {kWindow, kWindow}, kSigma, kSigma, cv::BORDER_CONSTANT);
    return sums;
}

// Lumas of both pictures and what the mask makes of each pixel, of some rows.
struct LumaRows {
    cv::Mat a, b, weight;
};
LumaRows luma_rows(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask, int y0, int y1) {
    const int width = a.width();
    LumaRows rows{cv::Mat(y1 - y0, width, CV_32F), cv::Mat(y1 - y0, width, CV_32F),
                  cv::Mat(y1 - y0, width, CV_32F)};
    for (int y = y0; y < y1; ++y) {
        float *luma_a = rows.a.ptr<float>(y - y0), *luma_b = rows.b.ptr<float>(y - y0);
        float* weight = rows.weight.ptr<float>(y - y0);
        for (int x = 0; x < width; ++x) {
            luma_a[x] = luminance(clamped(a(x, y)));
            luma_b[x] = luminance(clamped(b(x, y)));
            weight[x] = counts(mask, x, y);
        }
    }
    return rows;
}

// Rows y0 to y1 of ssim_map(): a strip is small enough to stay in the cache.
void ssim_strip(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask, int y0, int y1,
                Image<float>& map) {
    const int first = std::max(y0 - kWindow / 2, 0), last = std::min(y1 + kWindow / 2, a.height());
    const LumaRows rows = luma_rows(a, b, mask, first, last);
    const cv::Mat weighted_a = rows.a.mul(rows.weight), weighted_b = rows.b.mul(rows.weight);
    const cv::Mat total = windowed(rows.weight), sum_a = windowed(weighted_a), sum_b = windowed(weighted_b);
    const cv::Mat sum_aa = windowed(weighted_a.mul(rows.a)), sum_bb = windowed(weighted_b.mul(rows.b));
    const cv::Mat sum_ab = windowed(weighted_a.mul(rows.b));
    for (int y = y0; y < y1; ++y) {
        const auto row = [&](const cv::Mat& sums) { return sums.ptr<float>(y - first); };
        const float *w = row(total), *s_a = row(sum_a), *s_b = row(sum_b);
        const float *s_aa = row(sum_aa), *s_bb = row(sum_bb), *s_ab = row(sum_ab);
        for (int x = 0; x < a.width(); ++x) {
            if (!counts(mask, x, y)) continue;
            const float mean_a = s_a[x] / w[x], mean_b = s_b[x] / w[x];
            const float variance_a = std::max(s_aa[x] / w[x] - mean_a * mean_a, 0.0f);
            const float variance_b = std::max(s_bb[x] / w[x] - mean_b * mean_b, 0.0f);
            const float covariance = s_ab[x] / w[x] - mean_a * mean_b;
            map(x, y) = (2 * mean_a * mean_b + kC1) * (2 * covariance + kC2) /
                        ((mean_a * mean_a + mean_b * mean_b + kC1) * (variance_a + variance_b + kC2));
        }
    }
}

// Numbers in the order of the floats they stand for.
std::uint32_t rank_of(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);  // -0 is 0
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
float value_of(std::uint32_t rank) {
    return std::bit_cast<float>(rank & 0x80000000u ? rank & 0x7fffffffu : ~rank);
}

}  // namespace

PixelMask measured(const Image<float>& confidence) {
    PixelMask mask(confidence.width(), confidence.height());
    for (std::size_t i = 0; i < mask.size(); ++i) mask.pixels()[i] = confidence.pixels()[i] > 0;
    return mask;
}

double psnr_db(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask) {
    require_alike(a, b, mask);
    const double error2 = required_mean(a.region(), mask, [&](int x, int y) {
        const glm::dvec3 d(clamped(a(x, y)) - clamped(b(x, y)));
        return glm::dot(d, d) / 3;
    });
    return error2 == 0 ? std::numeric_limits<double>::infinity() : -10 * std::log10(error2);
}

double mean_difference(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask) {
    require_alike(a, b, mask);
    return required_mean(a.region(), mask, [&](int x, int y) {
        const glm::dvec3 d(clamped(b(x, y)) - clamped(a(x, y)));
        return (d.x + d.y + d.z) / 3;
    });
}

Image<float> luma_difference(const Image<Rgb>& a, const Image<Rgb>& b) {
    require_alike(a, b, {});
    Image<float> difference(a.width(), a.height());
    parallel_for(0, a.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) luma_difference(a.row(y), b.row(y), difference.row(y));
    });
    return difference;
}

void luma_difference(std::span<const Rgb> a, std::span<const Rgb> b, std::span<float> difference) {
    for (std::size_t i = 0; i < difference.size(); ++i)
        difference[i] = luminance(clamped(b[i])) - luminance(clamped(a[i]));
}

Image<float> ssim_map(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask) {
    require_alike(a, b, mask);
    Image<float> map(a.width(), a.height());
    const int strips = (a.height() + kStripRows - 1) / kStripRows;
    parallel_for(0, strips, 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            ssim_strip(a, b, mask, i * kStripRows, std::min((i + 1) * kStripRows, a.height()), map);
    });
    return map;
}

double ssim(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask) {
    const Image<float> map = ssim_map(a, b, mask);
    const auto value = [&](int x, int y) { return static_cast<double>(map(x, y)); };
    constexpr int half = kWindow / 2;
    const Region inner{half, half, map.width() - half, map.height() - half};
    const auto inside = inner.empty() ? std::nullopt : mean_over(inner, mask, value);
    return inside ? *inside : required_mean(map.region(), mask, value);
}

std::optional<double> luma_correlation(const Image<Rgb>& a, const Image<Rgb>& b, const PixelMask& mask) {
    require_alike(a, b, mask);
    constexpr double least_deviation = 0.01;
    using Sums = std::array<double, 6>;  // 1, a, b, aa, bb, ab
    std::vector<Sums> rows(static_cast<std::size_t>(a.height()));
    parallel_for(0, a.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            Sums sums{};
            for (int x = 0; x < a.width(); ++x) {
                if (!counts(mask, x, y)) continue;
                const double u = luminance(clamped(a(x, y))), v = luminance(clamped(b(x, y)));
                sums[0] += 1, sums[1] += u, sums[2] += v, sums[3] += u * u, sums[4] += v * v,
                    sums[5] += u * v;
            }
            rows[static_cast<std::size_t>(y)] = sums;
        }
    });
    Sums sums{};
    for (const Sums& row : rows)
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += row[i];
    const auto& [n, u, v, uu, vv, uv] = sums;
    TP_REQUIRE(n > 0, "the mask leaves pixels to compare");
    const double variance_a = uu / n - u / n * u / n, variance_b = vv / n - v / n * v / n;
    if (std::min(variance_a, variance_b) < least_deviation * least_deviation) return std::nullopt;
    return (uv / n - u / n * v / n) / std::sqrt(variance_a * variance_b);
}

Image<float> delta_e_2000_map(const Image<Rgb>& a, const Image<Rgb>& b) {
    require_alike(a, b, {});
    Image<float> map(a.width(), a.height());
    parallel_for(0, a.height(), 4, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) delta_e_2000_row(a.row(y), b.row(y), map.row(y));
    });
    return map;
}

double mean(const Image<float>& values, const PixelMask& mask) {
    require_alike(values, values, mask);
    return required_mean(values.region(), mask,
                         [&](int x, int y) { return static_cast<double>(values(x, y)); });
}

double percentile(const Image<float>& values, double part, const PixelMask& mask) {
    require_alike(values, values, mask);
    TP_REQUIRE(part >= 0 && part <= 1, "a part lies in 0..1");
    // The upper half of the rank first, then the lower half among those: no copy, and whole numbers add up to
    // the same on any number of threads.
    const auto histogram = [&](const auto& bin_of) {
        std::vector<std::size_t> bins(kBins);
        std::mutex adding;
        parallel_for(0, values.height(), 64, [&](int begin, int end) {
            std::vector<std::size_t> some(kBins);
            for (int y = begin; y < end; ++y)
                for (int x = 0; x < values.width(); ++x) {
                    const float value = values(x, y);
                    if (!counts(mask, x, y) || std::isnan(value)) continue;
                    if (const int bin = bin_of(rank_of(value)); bin >= 0)
                        ++some[static_cast<std::size_t>(bin)];
                }
            const std::lock_guard lock(adding);
            for (std::size_t i = 0; i < kBins; ++i) bins[i] += some[i];
        });
        return bins;
    };
    // The bin that has the number `at` of them; `at` becomes its place within.
    const auto bin_with = [](const std::vector<std::size_t>& bins, std::size_t& at) {
        std::size_t bin = 0;
        for (; at >= bins[bin]; ++bin) at -= bins[bin];
        return static_cast<std::uint32_t>(bin);
    };
    const std::vector<std::size_t> upper =
        histogram([](std::uint32_t rank) { return static_cast<int>(rank >> 16); });
    const std::size_t number = std::accumulate(upper.begin(), upper.end(), std::size_t{0});
    if (number == 0) return std::numeric_limits<double>::quiet_NaN();
    auto at = static_cast<std::size_t>(std::llround(part * static_cast<double>(number - 1)));
    const std::uint32_t half = bin_with(upper, at);
    const std::vector<std::size_t> lower = histogram(
        [&](std::uint32_t rank) { return rank >> 16 == half ? static_cast<int>(rank & 0xffffu) : -1; });
    return value_of(half << 16 | bin_with(lower, at));
}

}  // namespace tangi
