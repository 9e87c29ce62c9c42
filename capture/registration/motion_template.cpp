#include "capture/registration/motion_template.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "capture/registration/edge_field.h"
#include "surface/base/parallel.h"

namespace tangi::motion_template {

using glm::dvec2;

namespace {

constexpr std::size_t kMostShakePixels = 20000;  // for four unknowns
constexpr float kClear = 0.02f;                  // [1 per pixel] mean edge that is worth following

}  // namespace

Directions directions_of(const Image<float>& photo, float step, double blur) {
    const EdgeField field = edge_field({&photo, 1}, step);
    Directions d{cv::Mat(photo.height(), photo.width(), CV_32F),
                 cv::Mat(photo.height(), photo.width(), CV_32F)};
    for (int y = 0; y < photo.height(); ++y)
        for (int x = 0; x < photo.width(); ++x) {
            d.cosine.at<float>(y, x) = field.tensor(x, y).x - field.tensor(x, y).z;
            d.sine.at<float>(y, x) = 2 * field.tensor(x, y).y;
        }
    for (cv::Mat* m : {&d.cosine, &d.sine}) cv::GaussianBlur(*m, *m, {}, blur, blur, cv::BORDER_REPLICATE);
    return d;
}

float sample(const cv::Mat& m, double x, double y) {
    const int x0 = std::clamp(static_cast<int>(x), 0, m.cols - 2),
              y0 = std::clamp(static_cast<int>(y), 0, m.rows - 2);
    const float u = std::clamp(static_cast<float>(x) - static_cast<float>(x0), 0.0f, 1.0f);
    const float v = std::clamp(static_cast<float>(y) - static_cast<float>(y0), 0.0f, 1.0f);
    const float *a = m.ptr<float>(y0) + x0, *b = m.ptr<float>(y0 + 1) + x0;
    return (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
}

Directions mean_of(const std::vector<Directions>& all, const std::vector<CameraMotion>& drifts,
                   const dvec2& centre) {
    Directions mean{cv::Mat::zeros(all[0].cosine.size(), CV_32F),
                    cv::Mat::zeros(all[0].cosine.size(), CV_32F)};
    parallel_for(0, mean.cosine.rows, 8, [&](int begin, int end) {
        for (std::size_t i = 0; i < all.size(); ++i) {
            const ToPhoto to_photo(drifts[i], centre);
            for (int y = begin; y < end; ++y)
                for (int x = 0; x < mean.cosine.cols; ++x) {
                    const dvec2 p = to_photo(dvec2(x, y));
                    mean.cosine.at<float>(y, x) +=
                        sample(all[i].cosine, p.x, p.y) / static_cast<float>(all.size());
                    mean.sine.at<float>(y, x) +=
                        sample(all[i].sine, p.x, p.y) / static_cast<float>(all.size());
                }
        }
    });
    return mean;
}

std::vector<TemplatePixel> template_pixels(const Directions& mean, const dvec2& centre) {
    std::vector<std::pair<float, cv::Point>> clear;
    constexpr int edge = 6;
    for (int y = edge; y < mean.cosine.rows - edge; ++y)
        for (int x = edge; x < mean.cosine.cols - edge; ++x) {
            const float strength = std::hypot(mean.cosine.at<float>(y, x), mean.sine.at<float>(y, x));
            if (strength > kClear) clear.push_back({strength, {x, y}});
        }
    if (clear.size() > kMostShakePixels) {
        std::nth_element(clear.begin(), clear.begin() + static_cast<std::ptrdiff_t>(kMostShakePixels),
                         clear.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
        clear.resize(kMostShakePixels);
    }
    std::vector<TemplatePixel> pixels;
    for (const auto& [strength, at] : clear) {
        TemplatePixel pixel{static_cast<float>(at.x), static_cast<float>(at.y), {}, {}};
        const cv::Mat* channels[2] = {&mean.cosine, &mean.sine};
        for (int c = 0; c < 2; ++c) {
            const cv::Mat& m = *channels[c];
            const double gx = (m.at<float>(at.y, at.x + 1) - m.at<float>(at.y, at.x - 1)) / 2.0;
            const double gy = (m.at<float>(at.y + 1, at.x) - m.at<float>(at.y - 1, at.x)) / 2.0;
            pixel.value[c] = m.at<float>(at.y, at.x);
            const dvec2 d = dvec2(at.x, at.y) - centre;
            pixel.slope[c] = {gx, gy, gy * d.x - gx * d.y, gx * d.x + gy * d.y};
        }
        pixels.push_back(pixel);
    }
    return pixels;
}

}  // namespace tangi::motion_template
