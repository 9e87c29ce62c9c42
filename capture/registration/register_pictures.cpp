// register_pictures.cpp: two pictures of one painting, taken at different times, laid onto each other.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/registration/picture_features.h"
#include "capture/registration/registration.h"
#include "surface/base/error.h"
#include "surface/image/opencv_view.h"

namespace tangi {

namespace {

constexpr double kInlierPx = 3;  // [pixels of what features are sought in]
constexpr int kLeastInliers = 15;
constexpr int kRegisteringRounds = 6;
constexpr int kPatchPixels = 24000;

Image<float> image_of(const cv::Mat& mat) {
    Image<float> image(mat.cols, mat.rows);
    mat.copyTo(view_of(image));
    return image;
}

cv::Matx33d matx_of(const Homography& h) {
    return {h[0][0], h[1][0], h[2][0], h[0][1], h[1][1], h[2][1], h[0][2], h[1][2], h[2][2]};
}

Homography homography_of(const cv::Matx33d& m) {
    return {m(0, 0), m(1, 0), m(2, 0), m(0, 1), m(1, 1), m(2, 1), m(0, 2), m(1, 2), m(2, 2)};
}

// By features and consensus (RANSAC, Fischler & Bolles 1981; OpenCV's has a fixed seed).
Homography from_features(const Image<float>& reference, const Image<float>& moved) {
    const PictureFeatures features[2] = {features_of(reference), features_of(moved)};
    const FeatureMatches matches = matches_of(features[0], features[1]);
    std::vector<cv::Point2f> from, to;
    for (const glm::dvec2& p : matches.from) from.emplace_back(cv::Point2d(p.x, p.y));
    for (const glm::dvec2& p : matches.to) to.emplace_back(cv::Point2d(p.x, p.y));
    cv::Mat inliers, h;
    if (from.size() >= kLeastInliers) h = cv::findHomography(from, to, cv::RANSAC, kInlierPx, inliers, 5000);
    if (h.empty() || cv::countNonZero(inliers) < kLeastInliers)
        fail(
            "the two pictures cannot be registered: {} of {} features of one were found in the other; are "
            "they of the same painting?",
            inliers.empty() ? 0 : cv::countNonZero(inliers), features[0].points.size());
    return enlarging(1 / features[1].scale) * homography_of(h) *
           glm::inverse(enlarging(1 / features[0].scale));
}

}  // namespace

PhotoDrift register_pictures(const Image<float>& reference, const Image<float>& moved) {
    TP_REQUIRE(!reference.empty() && !moved.empty(), "pictures have pixels");
    const MotionFrame frame(reference.width(), reference.height());
    Homography h = from_features(reference, moved);
    const Image<float> contrast = local_contrast(reference, contrast_floor_of(reference));
    PhotoDrift result;
    // Twice, since what is resampled by a rough homography lacks sharpness where that is off.
    for (int pass = 0; pass < 2; ++pass) {
        cv::Mat warped;
        cv::warpPerspective(view_of(moved), warped, matx_of(h), {reference.width(), reference.height()},
                            cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
        const Image<float> brightness = image_of(warped);
        std::vector<AlignmentWindow> windows(1);
        windows[0].pictures = {contrast, local_contrast(brightness, contrast_floor_of(brightness))};
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
