// register_pictures.cpp: two pictures of one painting, taken at different times, laid onto each other.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/registration/registration.h"
#include "surface/base/error.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr int kFeatureSize = 1200;  // [pixels] longest side in which features are sought
constexpr int kFeatures = 4000;
constexpr double kRatio = 0.8;   // [1] of distances to the best and second-best descriptor (Lowe 2004)
constexpr double kInlierPx = 3;  // [pixels of what features are sought in]
constexpr int kLeastInliers = 15;
constexpr int kRegisteringRounds = 6;
constexpr int kPatchPixels = 24000;
constexpr double kContrastFloor = 0.05;  // [1] of the mean brightness

Image<float> image_of(const cv::Mat& mat) {
    Image<float> image(mat.cols, mat.rows);
    mat.copyTo(view_of(image));
    return image;
}

double floor_of(const Image<float>& image) {
    return std::max(kContrastFloor * cv::mean(view_of(image))[0], 1e-12);
}

// Local contrast in 8 bits, reduced; `scale` gets the factor of its size.
cv::Mat for_features(const Image<float>& picture, double& scale) {
    scale = std::min(1.0, kFeatureSize / static_cast<double>(std::max(picture.width(), picture.height())));
    cv::Mat small;
    cv::resize(view_of(picture), small, {}, scale, scale, cv::INTER_AREA);
    const Image<float> contrast = local_contrast(image_of(small), floor_of(picture));
    cv::Mat bytes;
    view_of(contrast).convertTo(bytes, CV_8U, 160, 128);
    return bytes;
}

cv::Matx33d matx_of(const Homography& h) {
    return {h[0][0], h[1][0], h[2][0], h[0][1], h[1][1], h[2][1], h[0][2], h[1][2], h[2][2]};
}

Homography homography_of(const cv::Matx33d& m) {
    return {m(0, 0), m(1, 0), m(2, 0), m(0, 1), m(1, 1), m(2, 1), m(0, 2), m(1, 2), m(2, 2)};
}

// By features (SIFT, Lowe 2004) and consensus (RANSAC, Fischler & Bolles 1981; OpenCV's has a fixed seed).
Homography from_features(const Image<float>& reference, const Image<float>& moved) {
    double scales[2];
    std::vector<cv::KeyPoint> points[2];
    cv::Mat descriptors[2];
    const Image<float>* pictures[2] = {&reference, &moved};
    const auto sift = cv::SIFT::create(kFeatures);
    for (int i = 0; i < 2; ++i)
        sift->detectAndCompute(for_features(*pictures[i], scales[i]), {}, points[i], descriptors[i]);
    std::vector<cv::Point2f> from, to;
    if (!descriptors[0].empty() && descriptors[1].rows > 1) {
        std::vector<std::vector<cv::DMatch>> matches;
        cv::BFMatcher(cv::NORM_L2).knnMatch(descriptors[0], descriptors[1], matches, 2);
        for (const auto& pair : matches)
            if (pair.size() == 2 && pair[0].distance < kRatio * pair[1].distance) {
                from.push_back(points[0][static_cast<std::size_t>(pair[0].queryIdx)].pt);
                to.push_back(points[1][static_cast<std::size_t>(pair[0].trainIdx)].pt);
            }
    }
    cv::Mat inliers, h;
    if (from.size() >= kLeastInliers) h = cv::findHomography(from, to, cv::RANSAC, kInlierPx, inliers, 5000);
    if (h.empty() || cv::countNonZero(inliers) < kLeastInliers)
        fail(
            "the two pictures cannot be registered: {} of {} features of one were found in the other; are "
            "they of the same painting?",
            inliers.empty() ? 0 : cv::countNonZero(inliers), points[0].size());
    return enlarging(1 / scales[1]) * homography_of(h) * glm::inverse(enlarging(1 / scales[0]));
}

}  // namespace

PhotoDrift register_pictures(const Image<float>& reference, const Image<float>& moved) {
    TP_REQUIRE(!reference.empty() && !moved.empty(), "pictures have pixels");
    const MotionFrame frame(reference.width(), reference.height());
    Homography h = from_features(reference, moved);
    const Image<float> contrast = local_contrast(reference, floor_of(reference));
    PhotoDrift result;
    // Twice, since what is resampled by a rough homography lacks sharpness where that is off.
    for (int pass = 0; pass < 2; ++pass) {
        cv::Mat warped;
        cv::warpPerspective(view_of(moved), warped, matx_of(h), {reference.width(), reference.height()},
                            cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
        const Image<float> brightness = image_of(warped);
        std::vector<AlignmentWindow> windows(1);
        windows[0].pictures = {contrast, local_contrast(brightness, floor_of(brightness))};
        Alignment alignment(frame, {{0, 0, 1}, {0, 0, 1}}, {true, true});
        alignment.look_at(windows, kPatchPixels);
        for (int round = 0; round < kRegisteringRounds; ++round) {
            alignment.iterate(MotionModel::homography, 1);
            alignment.pictures[0].homography = Homography(1);
        }
        const AlignedPicture& picture = alignment.pictures[1];
        h = normalised(h * picture.homography);
        result.model = MotionModel::homography;
        result.correlation = picture.correlation;
        result.error_px = std::hypot(rms_displacement(picture.covariance), picture.model_error_px);
        result.registered = picture.certainty > 6 && picture.last.model != MotionModel::none;
    }
    if (!result.registered)
        fail(
            "the two pictures cannot be registered: their features fit, but their edges do not (correlation "
            "{:.2f})",
            result.correlation);
    result.homography = h;
    result.drift_px = rms_displacement(motion_of(h, frame));
    result.warped = result.drift_px > result.error_px;
    return result;
}

}  // namespace tangi
