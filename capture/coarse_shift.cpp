#include "capture/coarse_shift.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kSize = 256;           // [pixels] longest side of what is correlated
constexpr double kBetter = 1.3;      // [1] correlation at the shift against that at none
constexpr double kLeast = 0.1;       // [1] correlation at the shift
constexpr double kLeastShift = 1.5;  // [pixels of what is correlated]
constexpr double kFarthest = 0.3;    // [1] of the side

cv::Mat spectrum_of(const Image<float>& picture, int reduction, const cv::Size& size) {
    const cv::Mat whole(picture.height(), picture.width(), CV_32F, const_cast<float*>(picture.data()));
    cv::Mat small;
    cv::resize(whole, small, {picture.width() / reduction, picture.height() / reduction}, 0, 0,
               cv::INTER_AREA);
    cv::Mat window, padded = cv::Mat::zeros(size, CV_32F), spectrum;
    cv::createHanningWindow(window, small.size(), CV_32F);
    small = small.mul(window);
    small.copyTo(padded(cv::Rect({0, 0}, small.size())));
    cv::dft(padded, spectrum);
    return spectrum;
}

}  // namespace

std::vector<glm::dvec2> coarse_shifts(const std::vector<Image<float>>& pictures,
                                      const std::vector<glm::dvec3>& lights,
                                      const std::vector<bool>& in_model) {
    const std::size_t count = pictures.size();
    std::vector<glm::dvec2> shifts(count, glm::dvec2(0));
    const int width = pictures.front().width(), height = pictures.front().height();
    const int reduction = std::max(1, (std::max(width, height) + kSize - 1) / kSize);
    if (std::min(width, height) / reduction < 16) return shifts;
    const cv::Size size(cv::getOptimalDFTSize(2 * (width / reduction)),
                        cv::getOptimalDFTSize(2 * (height / reduction)));
    std::vector<cv::Mat> spectra(count);
    std::vector<double> energy(count);
    parallel_for(0, static_cast<int>(count), 1, [&](int begin, int end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
            spectra[i] = spectrum_of(pictures[i], reduction, size);
    });
    const auto correlated = [&](std::size_t a, std::size_t b) {
        cv::Mat product, map;
        cv::mulSpectrums(spectra[a], spectra[b], product, 0, true);
        cv::dft(product, map, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
        return map;
    };
    for (std::size_t i = 0; i < count; ++i) energy[i] = correlated(i, i).at<float>(0, 0);

    std::vector<double> distance(count, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> from(count, 0);
    std::vector<bool> done(count, false);
    const auto first = std::find(in_model.begin(), in_model.end(), true);
    std::size_t next = first == in_model.end() ? 0 : static_cast<std::size_t>(first - in_model.begin());
    for (std::size_t step = 0; step < count; ++step) {
        done[next] = true;
        if (step > 0) {
            const std::size_t near = from[next];
            const cv::Mat map = correlated(next, near);
            const double norm = std::sqrt(energy[next] * energy[near]), still = map.at<float>(0, 0);
            double peak;
            cv::Point at;
            cv::minMaxLoc(map, nullptr, &peak, nullptr, &at);
            glm::dvec2 shift(at.x > size.width / 2 ? at.x - size.width : at.x,
                             at.y > size.height / 2 ? at.y - size.height : at.y);
            const bool believed = norm > 0 && peak > kLeast * norm && peak > kBetter * std::max(still, 0.0) &&
                                  glm::length(shift) >= kLeastShift &&
                                  std::abs(shift.x) < kFarthest * width / reduction &&
                                  std::abs(shift.y) < kFarthest * height / reduction;
            shifts[next] = shifts[near] + (believed ? static_cast<double>(reduction) * shift : glm::dvec2(0));
        }
        double nearest = std::numeric_limits<double>::infinity();
        const std::size_t last = next;
        for (std::size_t i = 0; i < count; ++i) {
            if (done[i]) continue;
            const double d = glm::length(lights[i] - lights[last]);
            // Pictures without a say in the model lead nowhere.
            if (d < distance[i] && (in_model[last] || distance[i] == std::numeric_limits<double>::infinity()))
                distance[i] = d, from[i] = last;
            if (distance[i] < nearest) nearest = distance[i], next = i;
        }
    }
    return shifts;
}

}  // namespace tangi
