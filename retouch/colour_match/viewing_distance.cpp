#include "retouch/colour_match/viewing_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "surface/base/error.h"
#include "surface/image/colour.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr double kNearest_m = 0.1, kNear_m = 0.3;
constexpr double kNoLight = 1e-6;  // [1] of white: where there is none, there is no colour

double degrees_per_pixel(double mm_per_pixel, double distance_m) {
    return std::atan(mm_per_pixel / (1000 * distance_m)) * 180 / std::numbers::pi;
}

// XYZ to opponent colours (Poirson & Wandell 1993), by columns; their sums of Gaussians: weight, spread
// [deg].
const glm::dmat3 kOpponent(0.279, -0.449, 0.086, 0.72, 0.29, -0.59, -0.107, -0.077, 0.501);
struct Bell {
    double weight, spread_deg;
};
const std::vector<Bell> kBells[3] = {{{0.921, 0.0283}, {0.105, 0.133}, {-0.108, 4.336}},
                                     {{0.531, 0.0392}, {0.330, 0.494}},
                                     {{0.488, 0.0536}, {0.371, 0.386}}};

// Zhang & Wandell's Gaussian is exp(-r^2 / s^2): a standard deviation of s / sqrt 2.
cv::Mat blurred(const cv::Mat& channel, const std::vector<Bell>& bells, double deg_per_px) {
    double total = 0;
    for (const Bell& bell : bells) total += bell.weight;
    cv::Mat sum = cv::Mat::zeros(channel.size(), CV_32F);
    for (const Bell& bell : bells) {
        const double sigma = bell.spread_deg / std::numbers::sqrt2 / deg_per_px;
        cv::Mat part;
        if (sigma < 0.15) {
            part = channel;
        } else {
            // A wide bell on a small copy: the same to a thousandth, and the cost does not grow with it.
            const double shrink = std::max(1.0, std::floor(sigma / 6));
            cv::Mat small = channel;
            if (shrink > 1)
                cv::resize(channel, small,
                           cv::Size(std::max(1, static_cast<int>(std::round(channel.cols / shrink))),
                                    std::max(1, static_cast<int>(std::round(channel.rows / shrink)))),
                           0, 0, cv::INTER_AREA);
            const double sx = sigma * small.cols / channel.cols, sy = sigma * small.rows / channel.rows;
            // Beyond the picture's size, all of it counts alike.
            cv::GaussianBlur(small, part, cv::Size(), std::min(sx, 4.0 * small.cols),
                             std::min(sy, 4.0 * small.rows), cv::BORDER_REFLECT);
            if (shrink > 1) cv::resize(part, part, channel.size(), 0, 0, cv::INTER_LINEAR);
        }
        sum += part * (bell.weight / total);
    }
    return sum;
}

glm::dmat3 xyz_of_rgb() {
    return {0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522,
            0.1191920, 0.1804375, 0.0721750, 0.9503041};
}

using Opponent = std::array<cv::Mat, 3>;

Opponent channels_of(const Image<Rgb>& linear, const glm::dmat3& to) {
    Opponent channels;
    for (int c = 0; c < 3; ++c) {
        cv::Mat& channel = channels[static_cast<std::size_t>(c)];
        channel = cv::Mat(linear.height(), linear.width(), CV_32F);
        for (int y = 0; y < linear.height(); ++y)
            for (int x = 0; x < linear.width(); ++x)
                channel.at<float>(y, x) = static_cast<float>((to * glm::dvec3(linear(x, y)))[c]);
    }
    return channels;
}

Image<Rgb> picture_of(const Opponent& channels, const glm::dmat3& from) {
    Image<Rgb> picture(channels[0].cols, channels[0].rows);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const glm::dvec3 opponent(channels[0].at<float>(y, x), channels[1].at<float>(y, x),
                                      channels[2].at<float>(y, x));
            picture(x, y) = glm::max(Rgb(from * opponent), Rgb(0));
        }
    return picture;
}

double mean_difference(const Image<Rgb>& a, const Image<Rgb>& b, const Mask& mask) {
    double sum = 0, weights = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const double w = static_cast<double>(mask.pixels()[i]);
        if (!(w > 0)) continue;
        sum += w * delta_e_2000(lab_from_linear(a.pixels()[i]), lab_from_linear(b.pixels()[i]));
        weights += w;
    }
    return weights > 0 ? sum / weights : 0;
}

Image<Rgb> means_over(const Image<Rgb>& picture, const Mask& mask, double sigma_px) {
    // Inside the mask only: paint beside it is no part of the pattern.
    cv::Mat weighted(picture.height(), picture.width(), CV_32FC4);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const float w = mask(x, y);
            const Rgb& c = picture(x, y);
            weighted.at<cv::Vec4f>(y, x) = {w * c.r, w * c.g, w * c.b, w};
        }
    cv::GaussianBlur(weighted, weighted, cv::Size(), sigma_px, sigma_px, cv::BORDER_CONSTANT);
    Image<Rgb> result = picture;
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const cv::Vec4f& v = weighted.at<cv::Vec4f>(y, x);
            if (mask(x, y) > 0 && v[3] > 1e-6f) result(x, y) = Rgb(v[0], v[1], v[2]) / v[3];
        }
    return result;
}

}  // namespace

double contrast_sensitivity(double cycles_per_degree, double luminance_cd_m2, double field_deg) {
    TP_REQUIRE(cycles_per_degree > 0 && luminance_cd_m2 > 0 && field_deg > 0, "of a grating that is there");
    const double u2 = cycles_per_degree * cycles_per_degree, l = luminance_cd_m2;
    return 5200 * std::exp(-0.0016 * u2 * std::pow(1 + 100 / l, 0.08)) /
           std::sqrt((1 + 144 / (field_deg * field_deg) + 0.64 * u2) *
                     (63 / std::pow(l, 0.83) + 1 / (1 - std::exp(-0.02 * u2))));
}

Image<Rgb> seen_from(const Image<Rgb>& linear, double mm_per_pixel, double distance_m) {
    TP_REQUIRE(mm_per_pixel > 0 && distance_m > 0, "a scale and a distance");
    const double deg = degrees_per_pixel(mm_per_pixel, distance_m);
    const glm::dmat3 to = kOpponent * xyz_of_rgb();
    Opponent channels = channels_of(linear, to);
    for (std::size_t c = 0; c < 3; ++c) channels[c] = blurred(channels[c], kBells[c], deg);
    return picture_of(channels, glm::inverse(to));
}

Image<Rgb> shown_from(const Image<Rgb>& linear, double mm_per_pixel, double distance_m) {
    TP_REQUIRE(mm_per_pixel > 0 && distance_m > 0, "a scale and a distance");
    const double deg = degrees_per_pixel(mm_per_pixel, distance_m);
    glm::dmat3 to = kOpponent * xyz_of_rgb();
    const glm::dvec3 white = to * glm::dvec3(1);
    for (int c = 1; c < 3; ++c)
        for (int of = 0; of < 3; ++of) to[of][c] -= white[c] / white[0] * to[of][0];
    Opponent channels = channels_of(linear, to);
    const cv::Mat light = channels[0];
    cv::max(blurred(light, kBells[0], deg), 0, channels[0]);
    for (std::size_t c = 1; c < 3; ++c) {
        const cv::Mat around = cv::max(blurred(light, kBells[c], deg), kNoLight);
        channels[c] = blurred(channels[c], kBells[c], deg).mul(channels[0] / around);
    }
    return picture_of(channels, glm::inverse(to));
}

double visible_contrast(const Image<Rgb>& pattern, const Image<Rgb>& mean, const Mask& mask,
                        double mm_per_pixel, double distance_m, const ViewingOptions& options) {
    validate(options);
    TP_REQUIRE(pattern.region() == mask.region() && mean.region() == mask.region(), "of the same size");
    const int w = cv::getOptimalDFTSize(mask.width()), h = cv::getOptimalDFTSize(mask.height());
    cv::Mat contrast = cv::Mat::zeros(h, w, CV_32F);
    double area = 0, light = 0;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            if (!(mask(x, y) > 0)) continue;
            const float there = std::max(luminance(mean(x, y)), 1e-4f);
            contrast.at<float>(y, x) = mask(x, y) * (luminance(pattern(x, y)) - there) / there;
            area += static_cast<double>(mask(x, y)), light += static_cast<double>(mask(x, y) * there);
        }
    if (!(area > 0)) return 0;
    const double deg = degrees_per_pixel(mm_per_pixel, distance_m);
    const double field_deg = std::clamp(std::sqrt(area) * deg, 0.1, 60.0);
    const double adapted = std::max(options.luminance_cd_m2 * light / area, 0.01);
    cv::Mat spectrum;
    cv::dft(contrast, spectrum, cv::DFT_COMPLEX_OUTPUT);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const double fx = std::min(x, w - x) / (w * deg), fy = std::min(y, h - y) / (h * deg);
            const double f = std::hypot(fx, fy);
            spectrum.at<cv::Vec2f>(y, x) *=
                f > 0 ? static_cast<float>(contrast_sensitivity(f, adapted, field_deg)) : 0.0f;
        }
    cv::Mat seen;
    cv::dft(spectrum, seen, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
    std::vector<float> values;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (mask(x, y) >= 0.5f) values.push_back(std::abs(seen.at<float>(y, x)));
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
}

Fusion fusion_of(const Image<Rgb>& retouched, const Image<Rgb>& target, const Mask& mask, double pitch_px,
                 double mm_per_pixel, const ViewingOptions& options) {
    TP_REQUIRE(retouched.region() == mask.region() && target.region() == mask.region(), "of the same size");
    const Image<Rgb> mean = means_over(retouched, mask, pitch_px);
    // Near the border, means are of half a pattern: what is seen of it there does not count.
    Mask counted = distance_inside_px(mask);
    float deepest = 1e-3f;
    for (float& v : counted.pixels())
        v = std::clamp(v / (3 * static_cast<float>(pitch_px)), 0.0f, 1.0f), deepest = std::max(deepest, v);
    for (float& v : counted.pixels()) v /= deepest;
    const auto seen = [&](double distance_m) {
        return visible_contrast(retouched, mean, counted, mm_per_pixel, distance_m, options);
    };
    Fusion fusion;
    // Sensitivity falls with frequency only beyond its peak: coming from afar, the first distance where the
    // pattern is seen counts.
    double far = kFarthest_m;
    fusion.fuses = seen(far) < 1;
    double near = far;
    while (fusion.fuses && near > kNearest_m) {
        const double nearer = std::max(near / 1.25, kNearest_m);
        if (seen(nearer) >= 1) {
            far = near, near = nearer;
            for (int i = 0; i < 6; ++i) {
                const double middle = std::sqrt(near * far);
                (seen(middle) >= 1 ? near : far) = middle;
            }
            break;
        }
        far = near = nearer;
    }
    fusion.distance_m = far;
    const auto difference = [&](double distance_m) {
        return mean_difference(seen_from(retouched, mm_per_pixel, distance_m),
                               seen_from(target, mm_per_pixel, distance_m), mask);
    };
    fusion.delta_e_near = difference(kNear_m);
    fusion.delta_e_fused = difference(fusion.distance_m);
    return fusion;
}

}  // namespace tangi
