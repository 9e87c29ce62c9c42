#include "capture/registration/picture_features.h"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "surface/image/local_contrast.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr int kFeatureSize = 1200;  // [pixels] longest side in which features are sought
constexpr int kFeatures = 4000;
constexpr double kRatio = 0.8;  // [1] of distances to the best and second-best descriptor (Lowe 2004)
constexpr double kContrastFloor = 0.05;  // [1] of the mean brightness

// Local contrast in 8 bits, reduced; `scale` gets the factor of its size.
cv::Mat for_features(const Image<float>& picture, double& scale) {
    scale = std::min(1.0, kFeatureSize / static_cast<double>(std::max(picture.width(), picture.height())));
    cv::Mat small;
    cv::resize(view_of(picture), small, {}, scale, scale, cv::INTER_AREA);
    Image<float> reduced(small.cols, small.rows);
    small.copyTo(view_of(reduced));
    const Image<float> contrast = local_contrast(reduced, contrast_floor_of(picture));
    cv::Mat bytes;
    view_of(contrast).convertTo(bytes, CV_8U, 160, 128);
    return bytes;
}

}  // namespace

double contrast_floor_of(const Image<float>& brightness) {
    return std::max(kContrastFloor * cv::mean(view_of(brightness))[0], 1e-12);
}

PictureFeatures features_of(const Image<float>& brightness) {
    PictureFeatures features;
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    cv::SIFT::create(kFeatures)->detectAndCompute(for_features(brightness, features.scale), {}, points,
                                                  descriptors);
    for (const cv::KeyPoint& point : points) features.points.emplace_back(point.pt.x, point.pt.y);
    if (descriptors.empty()) return features;
    features.descriptors = Image<float>(descriptors.cols, descriptors.rows);
    descriptors.copyTo(view_of(features.descriptors));
    return features;
}

FeatureMatches matches_of(const PictureFeatures& from, const PictureFeatures& to) {
    FeatureMatches found;
    if (from.descriptors.empty() || to.descriptors.height() < 2) return found;
    std::vector<std::vector<cv::DMatch>> matches;
    cv::BFMatcher(cv::NORM_L2).knnMatch(view_of(from.descriptors), view_of(to.descriptors), matches, 2);
    for (const auto& pair : matches)
        if (pair.size() == 2 && pair[0].distance < kRatio * pair[1].distance) {
            found.from.push_back(from.points[static_cast<std::size_t>(pair[0].queryIdx)]);
            found.to.push_back(to.points[static_cast<std::size_t>(pair[0].trainIdx)]);
        }
    return found;
}

}  // namespace tangi
