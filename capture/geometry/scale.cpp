// scale.cpp: scales from lengths, and rectification.
#include "capture/geometry/scale.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <opencv2/imgproc.hpp>

#include "surface/base/error.h"
#include "surface/image/homography.h"
#include "surface/maps/photography_json.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;
using nlohmann::json;

namespace {

constexpr double kMmPerInch = 25.4;
constexpr int kLargestSide_px = 65535;

void require_positive(double value, const char* what) {
    if (!(value > 0 && std::isfinite(value))) fail("{} is {}; give a positive number", what, value);
}

void require_convex(const Corners& corners) {
    int clockwise = 0;
    double longest = 0, smallest = 1e300;
    for (std::size_t i = 0; i < 4; ++i) {
        const dvec2 &a = corners[i], &b = corners[(i + 1) % 4], &c = corners[(i + 2) % 4];
        if (!std::isfinite(a.x + a.y)) fail("corner {} is ({}, {}); give numbers", i + 1, a.x, a.y);
        const double turn = cross(b - a, c - b);
        clockwise += turn > 0;
        longest = std::max(longest, glm::length(b - a));
        smallest = std::min(smallest, std::abs(turn));
    }
    if (smallest <= 0.01 * longest * longest)
        fail("three of the corners lie nearly on a line; give the four corners of the painting");
    if (clockwise == 0)
        fail(
            "the corners go round anticlockwise; give them as top left, top right, bottom right, bottom "
            "left");
    if (clockwise != 4)
        fail(
            "the corners' sides cross, or one corner lies within the others; give them as top left, top "
            "right, "
            "bottom right, bottom left");
}

Corners rectangle(double width, double height) {
    return {dvec2(-width / 2, height / 2), dvec2(width / 2, height / 2), dvec2(width / 2, -height / 2),
            dvec2(-width / 2, -height / 2)};
}

// How the sides of a quadrilateral compare with those of the rectangle: > 1 where it is too wide.
double aspect_off(const Corners& c, double width_mm, double height_mm) {
    const double across = glm::length(c[1] - c[0]) + glm::length(c[2] - c[3]);
    const double down = glm::length(c[3] - c[0]) + glm::length(c[2] - c[1]);
    return across / down * height_mm / width_mm;
}

std::vector<std::string> warnings_of_sides(const Corners& corners, double width_mm, double height_mm) {
    const double off = aspect_off(corners, width_mm, height_mm);
    if (std::abs(std::log(off)) < std::log(1.15)) return {};
    const bool swapped = std::abs(std::log(aspect_off(corners, height_mm, width_mm))) < std::log(1.15);
    return {fmt::format(
        "the corners look {:.0f} % {} than {:g} x {:g} mm: {}", 100 * std::abs(off - 1),
        off > 1 ? "wider" : "narrower", width_mm, height_mm,
        swapped ? "width and height may be swapped" : "check the size, or the camera looks from aside")};
}

}  // namespace

Scale scale_from_bar(const dvec2& first_px, const dvec2& last_px, double length_mm, double point_sigma_px) {
    require_positive(length_mm, "the scale bar's length in mm");
    const double length_px = glm::length(last_px - first_px);
    if (!(length_px >= 10 && std::isfinite(length_px)))
        fail(
            "the ends of the scale bar, ({:.1f}, {:.1f}) and ({:.1f}, {:.1f}), are {:.1f} pixels apart; at "
            "least 10 "
            "are needed",
            first_px.x, first_px.y, last_px.x, last_px.y, length_px);
    const double mm = length_mm / length_px;
    return {
        mm, mm * std::sqrt(2.0) * point_sigma_px / length_px, 0.5 * (first_px + last_px), "scale bar", {}};
}

Scale scale_from_ppi(double pixels_per_inch) {
    require_positive(pixels_per_inch, "the resolution in pixels per inch");
    const double mm = kMmPerInch / pixels_per_inch;
    return {mm, mm * std::sqrt(1.0 / 12) / pixels_per_inch, {0, 0}, "ppi", {}};
}

double mm_per_pixel_at(const Homography& plane_to_picture, const dvec2& place_px) {
    const Homography inverse = glm::inverse(plane_to_picture);
    // The determinant of a homography's derivative is det H / w^3.
    const dvec3 q = inverse * dvec3(place_px, 1);
    return std::sqrt(std::abs(glm::determinant(inverse) / (q.z * q.z * q.z)));
}

Scale scale_from_corners(const Corners& corners_px, double width_mm, double height_mm,
                         double point_sigma_px) {
    require_positive(width_mm, "the painting's width in mm");
    require_positive(height_mm, "the painting's height in mm");
    require_convex(corners_px);
    const Corners plane = rectangle(width_mm, height_mm);
    const auto scale_at_centre = [&](const Corners& corners) {
        const Homography h = homography_between(plane, corners);
        return mm_per_pixel_at(h, mapped(h, {0, 0}));
    };
    const double mm = scale_at_centre(corners_px);
    double variance = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (int k = 0; k < 2; ++k) {
            Corners moved = corners_px;
            moved[i][k] += 0.1;
            const double slope = (scale_at_centre(moved) - mm) / 0.1;
            variance += slope * slope * point_sigma_px * point_sigma_px;
        }
    const Homography h = homography_between(plane, corners_px);
    return {mm, std::sqrt(variance), mapped(h, {0, 0}), "corners",
            warnings_of_sides(corners_px, width_mm, height_mm)};
}

Scale at_plane(const Scale& measured, double height_mm, double camera_distance_mm) {
    require_positive(camera_distance_mm, "the camera's distance in mm");
    if (!(std::abs(height_mm) < camera_distance_mm))
        fail("a height of {:g} mm above the plane is behind the camera at {:g} mm", height_mm,
             camera_distance_mm);
    Scale scale = measured;
    const double factor = camera_distance_mm / (camera_distance_mm - height_mm);
    scale.mm_per_pixel *= factor;
    scale.sigma *= factor;
    return scale;
}

Rectification rectification(const Corners& corners_px, double width_mm, double height_mm,
                            double mm_per_pixel) {
    require_positive(width_mm, "the painting's width in mm");
    require_positive(height_mm, "the painting's height in mm");
    if (mm_per_pixel != 0) require_positive(mm_per_pixel, "the output's scale in mm per pixel");
    require_convex(corners_px);
    Rectification r;
    r.width_mm = width_mm, r.height_mm = height_mm;
    const Homography plane_to_picture = homography_between(rectangle(width_mm, height_mm), corners_px);
    r.picture_to_plane_mm = normalised(glm::inverse(plane_to_picture));
    if (mm_per_pixel == 0) {
        mm_per_pixel = mm_per_pixel_at(plane_to_picture, corners_px[0]);
        for (const dvec2& corner : corners_px)
            mm_per_pixel = std::min(mm_per_pixel, mm_per_pixel_at(plane_to_picture, corner));
    }
    r.mm_per_pixel = mm_per_pixel;
    const double width = std::round(width_mm / mm_per_pixel), height = std::round(height_mm / mm_per_pixel);
    if (!(width >= 1 && height >= 1 && width <= kLargestSide_px && height <= kLargestSide_px))
        fail(
            "{:g} x {:g} mm at {:g} mm per pixel would be {:.0f} x {:.0f} pixels; 1 to {} a side are "
            "possible",
            width_mm, height_mm, mm_per_pixel, width, height, kLargestSide_px);
    r.width = static_cast<int>(width), r.height = static_cast<int>(height);
    // The painting's centre is the output's, whatever the rounding of its size.
    const double s = mm_per_pixel;
    const Homography output_to_plane(s, 0, 0, 0, -s, 0, -s * (width - 1) / 2, s * (height - 1) / 2, 1);
    r.output_to_picture = normalised(plane_to_picture * output_to_plane);
    r.warnings = warnings_of_sides(corners_px, width_mm, height_mm);
    return r;
}

Image<Rgb> rectified(const Image<Rgb>& picture, const Rectification& r) {
    Image<Rgb> result(r.width, r.height);
    if (picture.empty() || result.empty()) return result;
    const cv::Mat from(picture.height(), picture.width(), CV_32FC3, const_cast<Rgb*>(picture.data()));
    cv::Mat to(r.height, r.width, CV_32FC3, result.data());
    // Where pixels of the output are larger than those of the picture, several samples are averaged.
    const double coarse =
        r.mm_per_pixel / mm_per_pixel_at(glm::inverse(r.picture_to_plane_mm),
                                         mapped(glm::inverse(r.picture_to_plane_mm), {0, 0}));
    const int samples = std::clamp(static_cast<int>(std::ceil(coarse - 0.25)), 1, 8);
    cv::Mat part(r.height, r.width, CV_32FC3);
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
            const dvec2 shift((i + 0.5) / samples - 0.5, (j + 0.5) / samples - 0.5);
            const Homography h = r.output_to_picture * Homography(1, 0, 0, 0, 1, 0, shift.x, shift.y, 1);
            cv::Matx33d m;
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column) m(row, column) = h[column][row];
            cv::warpPerspective(from, part, m, part.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                                cv::BORDER_CONSTANT);
            to += part / (samples * samples);
        }
    return result;
}

json to_json(const Scale& scale) {
    return {{"mm_per_pixel", scale.mm_per_pixel},
            {"sigma", scale.sigma},
            {"place_px", {scale.place_px.x, scale.place_px.y}},
            {"method", scale.method},
            {"warnings", scale.warnings}};
}

json to_json(const Rectification& r) {
    return {{"size_mm", {r.width_mm, r.height_mm}},
            {"mm_per_pixel", r.mm_per_pixel},
            {"size_px", {r.width, r.height}},
            {"picture_to_plane_mm", to_json(r.picture_to_plane_mm)},
            {"output_to_picture", to_json(r.output_to_picture)},
            {"warnings", r.warnings}};
}

}  // namespace tangi
