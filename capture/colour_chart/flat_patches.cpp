// flat_patches.cpp: regions between edges, by the range of values around each pixel.
#include "capture/colour_chart/flat_patches.h"

#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

namespace tangi {

using glm::dvec2;

namespace {

// Each channel divided by its brightest 2 %, with a gamma, so that dark patches have edges too.
cv::Mat stretched(const Image<Rgb>& linear) {
    cv::Mat picture(linear.height(), linear.width(), CV_32FC3);
    for (int k = 0; k < 3; ++k) {
        std::vector<float> values;
        values.reserve(linear.size());
        for (const Rgb& c : linear.pixels()) values.push_back(std::isfinite(c[k]) ? c[k] : 0.0f);
        const auto at =
            values.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), at, values.end());
        const float white = std::max(*at, 1e-9f);
        for (int y = 0; y < linear.height(); ++y)
            for (int x = 0; x < linear.width(); ++x) {
                const float v = linear(x, y)[k] / white;
                picture.at<cv::Vec3f>(y, x)[k] = v > 0 ? std::pow(std::min(v, 2.0f), 1 / 2.2f) : 0.0f;
            }
    }
    cv::GaussianBlur(picture, picture, {3, 3}, 0.7);
    return picture;
}

// Largest minus smallest of the 3 x 3 neighbours, of the channel where that is most.
cv::Mat range_of(const cv::Mat& picture) {
    cv::Mat high, low, channels[3];
    cv::dilate(picture, high, {});
    cv::erode(picture, low, {});
    cv::split(high - low, channels);
    return cv::max(cv::max(channels[0], channels[1]), channels[2]);
}

bool is_rectangular(const cv::Mat& labels, int label, const cv::Rect& box, double area) {
    const cv::Mat mask = labels(box) == label;
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    std::vector<cv::Point> outline, hull;
    for (const auto& part : outlines)
        if (part.size() > outline.size()) outline = part;
    if (outline.size() < 8) return false;
    cv::convexHull(outline, hull);
    // Outlines run through the middles of pixels: half a pixel is missing all around.
    const double around = cv::arcLength(hull, true);
    const double hull_area = cv::contourArea(hull) + around / 2 + 1;
    const cv::RotatedRect rectangle = cv::minAreaRect(hull);
    const double width = rectangle.size.width + 1, height = rectangle.size.height + 1;
    return area > 0.8 * hull_area && hull_area > 0.68 * width * height &&
           std::max(width, height) < 2.5 * std::min(width, height);
}

}  // namespace

std::vector<FlatPatch> flat_patches(const Image<Rgb>& linear, double smallest_px) {
    std::vector<FlatPatch> found;
    if (linear.width() < 32 || linear.height() < 32) return found;
    const cv::Mat range = range_of(stretched(linear));
    const double least = std::max(9.0, (smallest_px - 3) * (smallest_px - 3));
    const double most = static_cast<double>(linear.size()) / 36;
    for (const double limit : {0.012, 0.02, 0.035, 0.06, 0.1}) {
        cv::Mat labels, boxes, middles;
        const int count = cv::connectedComponentsWithStats(range < limit, labels, boxes, middles, 4);
        for (int label = 1; label < count; ++label) {
            const double area = boxes.at<int>(label, cv::CC_STAT_AREA);
            if (area < least || area > most) continue;
            const cv::Rect box(boxes.at<int>(label, cv::CC_STAT_LEFT), boxes.at<int>(label, cv::CC_STAT_TOP),
                               boxes.at<int>(label, cv::CC_STAT_WIDTH),
                               boxes.at<int>(label, cv::CC_STAT_HEIGHT));
            if (area < 0.4 * box.area() || !is_rectangular(labels, label, box, area)) continue;
            const FlatPatch patch{{middles.at<double>(label, 0), middles.at<double>(label, 1)},
                                  std::sqrt(area)};
            // With a higher limit the same patch is a little larger and its middle better known.
            const auto same = std::find_if(found.begin(), found.end(), [&](const FlatPatch& other) {
                return glm::length(other.centre_px - patch.centre_px) <
                       0.3 * std::min(patch.width_px, other.width_px);
            });
            if (same == found.end())
                found.push_back(patch);
            else if (patch.width_px > same->width_px && patch.width_px < 1.5 * same->width_px)
                *same = patch;
        }
    }
    return found;
}

}  // namespace tangi
