// markers.cpp: detection through OpenCV's aruco module, and the bundle adjustment of a plane of squares.
#include "capture/geometry/markers.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <opencv2/aruco.hpp>
#include <set>

#include "surface/base/error.h"
#include "surface/base/median.h"
#include "surface/image/colour.h"
#include "surface/image/homography.h"

namespace tangi {

using glm::dvec2;

namespace {

struct Dictionary {
    const char* name;
    int number;
};

// The small ones of a family are contained in its larger ones.
constexpr Dictionary kDictionaries[] = {{"4x4_50", cv::aruco::DICT_4X4_50},
                                        {"4x4_100", cv::aruco::DICT_4X4_100},
                                        {"4x4_250", cv::aruco::DICT_4X4_250},
                                        {"4x4_1000", cv::aruco::DICT_4X4_1000},
                                        {"5x5_50", cv::aruco::DICT_5X5_50},
                                        {"5x5_100", cv::aruco::DICT_5X5_100},
                                        {"5x5_250", cv::aruco::DICT_5X5_250},
                                        {"5x5_1000", cv::aruco::DICT_5X5_1000},
                                        {"6x6_50", cv::aruco::DICT_6X6_50},
                                        {"6x6_100", cv::aruco::DICT_6X6_100},
                                        {"6x6_250", cv::aruco::DICT_6X6_250},
                                        {"6x6_1000", cv::aruco::DICT_6X6_1000},
                                        {"7x7_50", cv::aruco::DICT_7X7_50},
                                        {"7x7_100", cv::aruco::DICT_7X7_100},
                                        {"7x7_250", cv::aruco::DICT_7X7_250},
                                        {"7x7_1000", cv::aruco::DICT_7X7_1000},
                                        {"aruco_original", cv::aruco::DICT_ARUCO_ORIGINAL},
                                        {"apriltag_36h11", cv::aruco::DICT_APRILTAG_36h11},
                                        {"apriltag_36h10", cv::aruco::DICT_APRILTAG_36h10},
                                        {"apriltag_25h9", cv::aruco::DICT_APRILTAG_25h9},
                                        {"apriltag_16h5", cv::aruco::DICT_APRILTAG_16h5}};

// Grey, 8 bit, with a gamma: black on white is a matter of contrast.
cv::Mat grey_of(const Image<Rgb>& linear) {
    std::vector<float> values;
    values.reserve(linear.size());
    for (const Rgb& c : linear.pixels()) values.push_back(std::isfinite(luminance(c)) ? luminance(c) : 0.0f);
    std::vector<float> sorted = values;
    const auto at =
        sorted.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    const float white = std::max(*at, 1e-9f);
    cv::Mat grey(linear.height(), linear.width(), CV_8U);
    for (int y = 0; y < linear.height(); ++y)
        for (int x = 0; x < linear.width(); ++x) {
            const float v = values[static_cast<std::size_t>(y) * static_cast<std::size_t>(linear.width()) +
                                   static_cast<std::size_t>(x)] /
                            white;
            grey.at<unsigned char>(y, x) =
                cv::saturate_cast<unsigned char>(255 * std::sqrt(std::max(v, 0.0f)));
        }
    return grey;
}

std::optional<double> bilinear(const Image<Rgb>& linear, const dvec2& p) {
    if (!(p.x >= 0 && p.y >= 0 && p.x < linear.width() - 1 && p.y < linear.height() - 1)) return std::nullopt;
    const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
    const double u = p.x - x, v = p.y - y;
    const auto value = [&](int i, int j) { return static_cast<double>(luminance(linear(x + i, y + j))); };
    return (1 - v) * ((1 - u) * value(0, 0) + u * value(1, 0)) +
           v * ((1 - u) * value(0, 1) + u * value(1, 1));
}

// Where the profile across a side, from the black border outwards, passes half of its height, in linear
// light: there a pixel's value is the mean over its area, so that the place is exact for any blur.
std::optional<double> edge_along(const Image<Rgb>& linear, const dvec2& start, const dvec2& outwards,
                                 double reach_px) {
    constexpr int kSteps = 24;
    std::array<double, kSteps + 1> profile;
    for (int i = 0; i <= kSteps; ++i) {
        const std::optional<double> v =
            bilinear(linear, start + outwards * reach_px * (2.0 * i / kSteps - 1));
        if (!v) return std::nullopt;
        profile[static_cast<std::size_t>(i)] = *v;
    }
    const double low = (profile[0] + profile[1] + profile[2]) / 3;
    const double high = (profile[kSteps] + profile[kSteps - 1] + profile[kSteps - 2]) / 3,
                 half = (low + high) / 2;
    if (!(high > 1.5 * low + 1e-6)) return std::nullopt;
    for (std::size_t i = 0; i < kSteps; ++i)
        if (profile[i] < half && profile[i + 1] >= half) {
            const double at = static_cast<double>(i) + (half - profile[i]) / (profile[i + 1] - profile[i]);
            return reach_px * (2 * at / kSteps - 1);
        }
    return std::nullopt;
}

struct Line {
    dvec2 point{0, 0}, along{1, 0};
};

// The line of the side from a to b, clockwise, through its edges; those far from it are left out.
std::optional<Line> side_of(const Image<Rgb>& linear, const dvec2& a, const dvec2& b, double reach_px) {
    const double length = glm::length(b - a);
    const dvec2 along = (b - a) / length, outwards(along.y, -along.x);
    std::vector<dvec2> edges;  // along and across
    for (double t = 0.08; t <= 0.92; t += 0.84 / 40)
        if (const auto edge = edge_along(linear, a + t * length * along, outwards, reach_px))
            edges.emplace_back((t - 0.5) * length, *edge);
    double middle = 0, slope = 0;
    for (int round = 0; round < 3; ++round) {
        if (edges.size() < 8) return std::nullopt;
        double x = 0, y = 0, xx = 0, xy = 0;
        for (const dvec2& e : edges) x += e.x, y += e.y, xx += e.x * e.x, xy += e.x * e.y;
        const double n = static_cast<double>(edges.size());
        slope = (n * xy - x * y) / (n * xx - x * x);
        middle = (y - slope * x) / n;
        std::vector<double> off;
        for (const dvec2& e : edges) off.push_back(std::abs(e.y - middle - slope * e.x));
        const double gate = 3 * 1.4826 * median(off) + 0.02;
        std::erase_if(edges, [&](const dvec2& e) { return std::abs(e.y - middle - slope * e.x) > gate; });
    }
    return Line{0.5 * (a + b) + middle * outwards, along + slope * outwards};
}

// Corners as intersections of the sides. OpenCV's own refinement, on pixels with a gamma, draws them inwards
// by a fifth of a pixel, which is half a percent of a marker of 80 pixels.
void refine(Marker& marker, const Image<Rgb>& linear) {
    std::array<Line, 4> sides;
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec2 &a = marker.corners_px[i], &b = marker.corners_px[(i + 1) % 4];
        // The black border is one of at most nine cells wide.
        const double reach_px = std::clamp(glm::length(b - a) / 9 * 0.8, 1.5, 5.0);
        const std::optional<Line> side = side_of(linear, a, b, reach_px);
        if (!side) return;
        sides[i] = *side;
    }
    for (std::size_t i = 0; i < 4; ++i) {
        const Line &p = sides[(i + 3) % 4], &q = sides[i];
        const double turn = p.along.x * q.along.y - p.along.y * q.along.x;
        if (std::abs(turn) < 0.1 * glm::length(p.along) * glm::length(q.along)) return;
        const dvec2 d = q.point - p.point;
        marker.corners_px[i] = p.point + p.along * ((d.x * q.along.y - d.y * q.along.x) / turn);
    }
}

std::vector<Marker> markers_of(const cv::Mat& grey, const Dictionary& dictionary) {
    const auto parameters = cv::aruco::DetectorParameters::create();
    parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
    parameters->cornerRefinementMinAccuracy = 0.01;
    parameters->cornerRefinementMaxIterations = 50;
    parameters->errorCorrectionRate = 0.3;  // less than the default: the wrong dictionary must not fit
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    cv::aruco::detectMarkers(grey, cv::aruco::getPredefinedDictionary(dictionary.number), corners, ids,
                             parameters);
    std::vector<Marker> markers;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        Marker marker{ids[i], {}};
        for (std::size_t k = 0; k < 4; ++k) marker.corners_px[k] = dvec2(corners[i][k].x, corners[i][k].y);
        markers.push_back(marker);
    }
    std::sort(markers.begin(), markers.end(), [](const Marker& a, const Marker& b) { return a.id < b.id; });
    return markers;
}

// The dictionary in which most markers are found; small ones come before those that contain them.
MarkerSearch best_of_all(const cv::Mat& grey) {
    MarkerSearch best;
    for (const Dictionary& dictionary : kDictionaries) {
        std::vector<Marker> markers = markers_of(grey, dictionary);
        if (markers.size() > best.markers.size()) best = {dictionary.name, std::move(markers), {}};
    }
    return best;
}

void warn_of_twins(MarkerSearch& search) {
    std::set<int> seen, twice;
    for (const Marker& marker : search.markers)
        if (!seen.insert(marker.id).second) twice.insert(marker.id);
    for (const int id : twice)
        search.warnings.push_back(
            fmt::format("marker {} of dictionary {} is there more than once", id, search.dictionary));
}

// Corners of one marker, from the plane's homography and the marker's place and turn.
struct CornerError {
    dvec2 corner, seen;  // [mm] from the marker's middle, [px]

    template <class T>
    bool operator()(const T* h, const T* pose, T* error) const {
        using std::cos;
        using std::sin;
        const T x = pose[0] + cos(pose[2]) * corner.x - sin(pose[2]) * corner.y;
        const T y = pose[1] + sin(pose[2]) * corner.x + cos(pose[2]) * corner.y;
        const T w = h[6] * x + h[7] * y + T(1);
        error[0] = (h[0] * x + h[1] * y + h[2]) / w - T(seen.x);
        error[1] = (h[3] * x + h[4] * y + h[5]) / w - T(seen.y);
        return true;
    }
};

Homography homography_of(const double* h) { return {h[0], h[3], h[6], h[1], h[4], h[7], h[2], h[5], 1}; }

Corners square(double side) {
    return {dvec2(-side / 2, side / 2), dvec2(side / 2, side / 2), dvec2(side / 2, -side / 2),
            dvec2(-side / 2, -side / 2)};
}

// Standard error of the scale at a place, by the covariance of the homography.
double scale_sigma(ceres::Problem& problem, const double* h, const dvec2& place_px, double point_sigma_px) {
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::DENSE_SVD;
    options.null_space_rank = -1;
    ceres::Covariance covariance(options);
    double c[64];
    const std::vector<std::pair<const double*, const double*>> blocks = {{h, h}};
    if (!covariance.Compute(blocks, &problem) || !covariance.GetCovarianceBlock(h, h, c)) return 0;
    double slopes[8];
    for (int i = 0; i < 8; ++i) {
        double moved[8];
        std::copy(h, h + 8, moved);
        const double step = 1e-6 * std::max(1e-3, std::abs(h[i]));
        moved[i] += step;
        slopes[i] =
            (mm_per_pixel_at(homography_of(moved), place_px) - mm_per_pixel_at(homography_of(h), place_px)) /
            step;
    }
    double variance = 0;
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 8; ++k) variance += slopes[i] * c[8 * i + k] * slopes[k];
    return point_sigma_px * std::sqrt(std::max(0.0, variance));
}

}  // namespace

std::vector<std::string> marker_dictionaries() {
    std::vector<std::string> names;
    for (const Dictionary& dictionary : kDictionaries) names.emplace_back(dictionary.name);
    return names;
}

MarkerSearch find_markers(const Image<Rgb>& linear, const std::optional<std::string>& name) {
    TP_REQUIRE(!linear.empty(), "a picture has pixels");
    const cv::Mat grey = grey_of(linear);
    MarkerSearch search;
    if (name) {
        const auto* dictionary = std::find_if(std::begin(kDictionaries), std::end(kDictionaries),
                                              [&](const Dictionary& d) { return *name == d.name; });
        if (dictionary == std::end(kDictionaries))
            fail("'{}' is no dictionary of markers; those known are {}", *name,
                 fmt::join(marker_dictionaries(), ", "));
        search = {dictionary->name, markers_of(grey, *dictionary), {}};
        if (search.markers.empty()) search.dictionary.clear();
    } else {
        search = best_of_all(grey);
    }
    for (Marker& marker : search.markers) refine(marker, linear);
    warn_of_twins(search);
    return search;
}

MarkerPlane marker_plane(const std::vector<Marker>& markers, double side_mm) {
    if (!(side_mm > 0 && std::isfinite(side_mm)))
        fail("the markers' side is {} mm; give a positive number", side_mm);
    if (markers.empty()) fail("there is no marker in the picture");
    const Corners corners = square(side_mm);
    const Homography first = normalised(homography_between(corners, markers[0].corners_px));
    double h[8];
    for (int i = 0; i < 8; ++i) h[i] = first[i % 3][i / 3];
    const Homography inverse = glm::inverse(first);
    std::vector<std::array<double, 3>> poses;
    for (const Marker& marker : markers) {
        Corners plane;
        for (std::size_t k = 0; k < 4; ++k) plane[k] = mapped(inverse, marker.corners_px[k]);
        const dvec2 middle = 0.25 * (plane[0] + plane[1] + plane[2] + plane[3]);
        const dvec2 top = plane[1] + plane[2] - plane[0] - plane[3];
        poses.push_back({middle.x, middle.y, std::atan2(top.y, top.x)});
    }
    poses[0] = {0, 0, 0};
    ceres::Problem problem;
    for (std::size_t m = 0; m < markers.size(); ++m)
        for (std::size_t k = 0; k < 4; ++k)
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<CornerError, 2, 8, 3>(
                                         new CornerError{corners[k], markers[m].corners_px[k]}),
                                     nullptr, h, poses[m].data());
    problem.SetParameterBlockConstant(poses[0].data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-14;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);

    MarkerPlane plane;
    plane.plane_to_picture = homography_of(h);
    dvec2 middle(0);
    for (const Marker& marker : markers)
        for (const dvec2& corner : marker.corners_px)
            middle += corner / (4.0 * static_cast<double>(markers.size()));
    const double numbers = 8.0 * static_cast<double>(markers.size());
    const double unknown = 8 + 3.0 * static_cast<double>(markers.size() - 1);
    plane.residual_px = std::sqrt(2 * summary.final_cost / numbers);
    // One marker leaves nothing over to tell errors by.
    constexpr double kCornerSigma_px = 0.15;
    const double seen = numbers > unknown ? std::sqrt(2 * summary.final_cost / (numbers - unknown)) : 0;
    const double sigma = scale_sigma(problem, h, middle, std::max(kCornerSigma_px, seen));
    plane.scale = {mm_per_pixel_at(plane.plane_to_picture, middle), sigma, middle, "markers", {}};
    return plane;
}

MarkerSearch seen_twice(const std::vector<MarkerSearch>& photographs) {
    TP_REQUIRE(!photographs.empty(), "there are photographs");
    MarkerSearch result = photographs.back();
    std::erase_if(result.markers, [&](const Marker& marker) {
        const double side = glm::length(marker.corners_px[1] - marker.corners_px[0]);
        const auto shows = [&](const MarkerSearch& other) {
            return other.dictionary == result.dictionary &&
                   std::any_of(other.markers.begin(), other.markers.end(), [&](const Marker& m) {
                       return m.id == marker.id &&
                              glm::length(m.corners_px[0] - marker.corners_px[0]) < side / 2;
                   });
        };
        return std::none_of(photographs.begin(), photographs.end() - 1, shows);
    });
    return result;
}

dvec2 size_on_plane(const MarkerPlane& plane, const Corners& corners_px) {
    const Homography inverse = glm::inverse(plane.plane_to_picture);
    Corners c;
    for (std::size_t k = 0; k < 4; ++k) c[k] = mapped(inverse, corners_px[k]);
    return {0.5 * (glm::length(c[1] - c[0]) + glm::length(c[2] - c[3])),
            0.5 * (glm::length(c[3] - c[0]) + glm::length(c[2] - c[1]))};
}

}  // namespace tangi
