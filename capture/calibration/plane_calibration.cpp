#include "capture/calibration/plane_calibration.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "capture/geometry/best_marker_photo.h"
#include "capture/geometry/plane_pose.h"
#include "capture/geometry/scale_agreement.h"
#include "surface/base/error.h"
#include "surface/image/homography.h"

namespace tangi {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

namespace {

constexpr double kMostEnlarged = 4;  // [1] area of the picture by that of the photographs
constexpr double kDoubtfulTilt_deg = 1;
// [1] of the picture or the photographs that undoing a lens's distortion may move out of the other: a zoom at
// its wide end, 5 % of distortion at the border, moves some 6 %.
constexpr double kMostMovedOut = 0.15;
constexpr double kFocalsDiffer = 0.03;  // [1] relative; a calibrated lens is known to a hundredth

// A plane in the undistorted photographs, in mm or, of a chart of unknown size, in its pitch.
struct SeenPlane {
    Homography to_picture{1};
    bool in_mm = true;
    double point_sigma_px = kPointSigma_px;
    std::array<dvec2, 4> places_px{};  // that it was told by
    std::string by;
};

dvec2 without_lens(const std::optional<Lens>& lens, const dvec2& place_px) {
    return lens ? undistorted(*lens, place_px) : place_px;
}

template <std::size_t n>
std::array<dvec2, n> without_lens(const std::optional<Lens>& lens, std::array<dvec2, n> places_px) {
    for (dvec2& place : places_px) place = without_lens(lens, place);
    return places_px;
}

// The box of points, as corners from the top left on.
Corners box_of(const std::vector<Marker>& markers) {
    dvec2 low(1e300), high(-1e300);
    for (const Marker& marker : markers)
        for (const dvec2& corner : marker.corners_px)
            low = glm::min(low, corner), high = glm::max(high, corner);
    return {low, dvec2(high.x, low.y), high, dvec2(low.x, high.y)};
}

void add_scale(PlaneCalibration& c, Scale scale) {
    c.warnings.insert(c.warnings.end(), scale.warnings.begin(), scale.warnings.end());
    c.scales.push_back(std::move(scale));
}

// How large pixels of the photographs are on the painting, from place to place: known once it is rectified.
RelativeScale relative_scale(const PlaneCalibration& c) {
    if (!c.geometry || !c.geometry->rectification) return [](const dvec2&) { return 1.0; };
    const Homography to_photo = *c.geometry->rectification;
    const dvec2 middle((c.width - 1) / 2.0, (c.height - 1) / 2.0);
    return [=](const dvec2& place) {
        return mm_per_pixel_at(to_photo, place == dvec2(0) ? middle : place);  // a resolution has no place
    };
}

// Without the lens's distortion.
struct SeenMarkers {
    std::vector<Marker> markers;
    std::optional<MarkerPlane> plane{};  // that they lie in; empty where they were not looked for
};

// What is to be rectified by: the painting's corners, else markers, else the chart.
SeenPlane plane_to_rectify(const SeenMarkers& seen, const ColourCalibration* chart,
                           const std::optional<Lens>& lens) {
    if (seen.plane)
        return {seen.plane->plane_to_picture, true, std::max(seen.plane->residual_px, 0.05),
                box_of(seen.markers), "markers"};
    if (!chart)
        fail(
            "--rectify: by what? Give the painting's corners and size (--corners, --painting-mm), the side "
            "of "
            "ArUco markers in the photographs (--marker-mm), or photograph a colour chart");
    const ChartCorners corners = without_lens(lens, chart_corners(chart->chart));
    const ChartCorners places{{{0, 4}, {6, 4}, {6, 0}, {0, 0}}};
    return {homography_between(places, corners), false, std::max(chart->chart.grid_residual_px, 0.2), corners,
            "chart"};
}

// The whole photograph without perspective, not turned: what is level in its middle stays level.
struct Upright {
    Homography picture_to_photo{1};
    int width = 0, height = 0;
    double pitch = 1;  // of a pixel, in the plane's unit
};
Upright upright(const SeenPlane& plane, int width, int height) {
    const Homography to_plane = glm::inverse(plane.to_picture);
    const dvec2 centre((width - 1) / 2.0, (height - 1) / 2.0);
    const std::array<dvec2, 4> photo = {dvec2(0, 0), dvec2(width - 1, 0), dvec2(width - 1, height - 1),
                                        dvec2(0, height - 1)};
    const double side = (to_plane * dvec3(centre, 1)).z;
    for (const dvec2& corner : photo)
        if (!((to_plane * dvec3(corner, 1)).z * side > 0.05 * side * side))
            fail(
                "--rectify: by the {} the painting's plane is seen from so far aside that it reaches its "
                "horizon in the photographs; give --corners and --painting-mm",
                plane.by);
    const dvec2 along = mapped(to_plane, centre + dvec2(1, 0)) - mapped(to_plane, centre);
    const dvec2 x = glm::normalize(along), y(-x.y, x.x);
    dvec2 low(1e300), high(-1e300);
    double finest = mm_per_pixel_at(plane.to_picture, centre);
    const double middle = finest;
    for (const dvec2& corner : photo) {
        const dvec2 p = mapped(to_plane, corner), q(glm::dot(p, x), glm::dot(p, y));
        low = glm::min(low, q), high = glm::max(high, q);
        finest = std::min(finest, mm_per_pixel_at(plane.to_picture, corner));
    }
    // As fine as the photographs where they are finest, unless that makes the picture far larger.
    const dvec2 size = high - low;
    const double area = kMostEnlarged * width * height;
    double pitch = finest;
    if (size.x * size.y / (pitch * pitch) > area) pitch = middle;
    if (size.x * size.y / (pitch * pitch) > area || std::max(size.x, size.y) / pitch > 60000)
        fail(
            "--rectify: the photographs are taken from so far aside that a picture of all they show would "
            "have "
            "{:.0f} x {:.0f} pixels; give --corners and --painting-mm",
            size.x / pitch, size.y / pitch);
    Upright result;
    result.pitch = pitch;
    result.width = static_cast<int>(std::floor(size.x / pitch)) + 1;
    result.height = static_cast<int>(std::floor(size.y / pitch)) + 1;
    const Homography to_turned(pitch, 0, 0, 0, -pitch, 0, low.x, high.y, 1);
    const Homography to_the_plane(x.x, x.y, 0, y.x, y.y, 0, 0, 0, 1);
    result.picture_to_photo = normalised(plane.to_picture * to_the_plane * to_turned);
    return result;
}

// Parts that one of the two does not show, by a grid.
void measure_outside(const PictureGeometry& g, PlaneCalibration& c) {
    constexpr int n = 100;
    const auto inside = [](const dvec2& p, int width, int height) {
        return p.x > -0.5 && p.y > -0.5 && p.x < width - 0.5 && p.y < height - 0.5;
    };
    int photo = 0, picture = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const dvec2 at((i + 0.5) / n, (j + 0.5) / n);
            photo += !inside(g.place_in_picture(at * dvec2(g.photo_width, g.photo_height) - 0.5), g.width,
                             g.height);
            picture +=
                !inside(g.place_in_photo(at * dvec2(g.width, g.height) - 0.5), g.photo_width, g.photo_height);
        }
    c.photo_outside = photo / static_cast<double>(n * n);
    c.picture_outside = picture / static_cast<double>(n * n);
}

// By differences, for points that are known to point_sigma_px.
double tilt_sigma(const SeenPlane& plane, double focal_px, const dvec2& principal_px) {
    ChartCorners on_plane{};
    const Homography to_plane = glm::inverse(plane.to_picture);
    for (std::size_t i = 0; i < 4; ++i) on_plane[i] = mapped(to_plane, plane.places_px[i]);
    const auto tilt = [&](const std::array<dvec2, 4>& places) {
        const PlanePose pose = pose_of(homography_between(on_plane, places), focal_px, principal_px);
        return dvec2(pose.turn[0].z, pose.turn[1].z);  // of the plane's normal in the camera's frame
    };
    const dvec2 middle = tilt(plane.places_px);
    double variance = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (int k = 0; k < 2; ++k) {
            std::array<dvec2, 4> moved = plane.places_px;
            moved[i][k] += 0.1;
            const dvec2 slope = (tilt(moved) - middle) / 0.1;
            variance += glm::dot(slope, slope) / 2 * plane.point_sigma_px * plane.point_sigma_px;
        }
    return glm::degrees(std::sqrt(variance));
}

// How the camera stands over the picture's plane, where the focal length is known.
void find_pose(const SeenPlane& plane, const std::optional<double>& mm_per_unit, PictureGeometry& g,
               PlaneCalibration& c) {
    const Homography to_plane = glm::inverse(plane.to_picture);
    const dvec2 centre((g.width - 1) / 2.0, (g.height - 1) / 2.0), right = centre + dvec2(1, 0);
    const dvec2 origin = mapped(to_plane, mapped(*g.rectification, centre));
    const dvec2 x = glm::normalize(mapped(to_plane, mapped(*g.rectification, right)) - origin);
    const Homography from_picture_frame(x.x, x.y, 0, -x.y, x.x, 0, origin.x, origin.y, 1);
    const Homography frame_to_photo = plane.to_picture * from_picture_frame;
    if (!c.focal_px) {
        // Seen from far away: only the turn in the plane is known.
        const dvec2 level = mapped(frame_to_photo, {1e-3, 0}) - mapped(frame_to_photo, {0, 0});
        const dvec2 d = glm::normalize(dvec2(level.x, -level.y));
        g.turn = dmat3(d.x, -d.y, 0, d.y, d.x, 0, 0, 0, 1);
        c.warnings.push_back(
            "rectified without a focal length: the lights' directions cannot be carried from the camera's to "
            "the "
            "painting's frame where the camera looks from aside; give --focal-px, --focal-35mm or --lens");
        return;
    }
    const PlanePose pose = pose_of(frame_to_photo, *c.focal_px, c.principal_px);
    g.turn = pose.turn;
    c.tilt_deg = pose.tilt_deg;
    c.tilt_sigma_deg = tilt_sigma(plane, *c.focal_px, c.principal_px);
    if (c.tilt_sigma_deg > kDoubtfulTilt_deg)
        c.warnings.push_back(
            fmt::format("by the {} the painting's plane is tilted by {:.1f} degrees, and that is uncertain "
                        "by {:.1f}: markers far "
                        "apart, or the painting's corners, would tell it better",
                        plane.by, *c.tilt_deg, c.tilt_sigma_deg));
    if (mm_per_unit) g.camera_mm = pose.camera * *mm_per_unit;
    if (std::abs(std::log(pose.stretch)) > 0.05)
        c.warnings.push_back(fmt::format(
            "by the {} and the focal length of {:.0f} pixels the painting looks {:.0f} % too {}: check "
            "its size and the focal length",
            plane.by, *c.focal_px, 100 * std::abs(pose.stretch - 1), pose.stretch > 1 ? "wide" : "high"));
}

// [mm] what the plane's unit is, by the most certain scale.
std::optional<double> unit_mm(const SeenPlane& plane, const PlaneCalibration& c,
                              const std::optional<Lens>& lens) {
    if (plane.in_mm) return 1.0;
    if (c.scales.empty()) return {};
    const Scale& scale = c.scales.front();
    dvec2 place = without_lens(lens, scale.place_px);
    if (scale.method == "ppi") place = dvec2((c.width - 1) / 2.0, (c.height - 1) / 2.0);
    return scale.mm_per_pixel / mm_per_pixel_at(plane.to_picture, place);
}

// The plane of the earlier painting's pixels, in mm where its scale is known, else in pixels.
SeenPlane plane_of(const EarlierPainting& earlier, const PlaneCalibration& c) {
    const double width = earlier.brightness.width() - 1, height = earlier.brightness.height() - 1;
    const double mm = earlier.mm_per_pixel.value_or(1);
    const Homography to_pixels(1 / mm, 0, 0, 0, -1 / mm, 0, width / 2, height / 2, 1);
    SeenPlane plane{c.earlier->to_photo * to_pixels, true, c.earlier->error_px, {}, "painting"};
    const Corners corners = {dvec2(0, 0), dvec2(width, 0), dvec2(width, height), dvec2(0, height)};
    for (std::size_t i = 0; i < 4; ++i) plane.places_px[i] = mapped(c.earlier->to_photo, corners[i]);
    return plane;
}

void rectify(const PlaneOptions& options, const SeenMarkers& seen, const ColourCalibration* chart,
             PictureGeometry& g, PlaneCalibration& c) {
    SeenPlane plane;
    std::optional<double> unit;
    if (options.earlier) {
        const EarlierPainting& earlier = *options.earlier;
        plane = plane_of(earlier, c);
        g.rectification = c.earlier->to_photo;
        g.width = earlier.brightness.width(), g.height = earlier.brightness.height();
        g.mm_per_pixel = earlier.mm_per_pixel;
        unit = earlier.mm_per_pixel ? std::optional(1.0) : std::nullopt;
    } else if (options.corners_px) {
        const Corners corners = without_lens(g.lens, *options.corners_px);
        std::optional<dvec2> size = options.painting_mm;
        if (!size && seen.plane) size = size_on_plane(*seen.plane, corners);
        if (!size)
            fail(
                "--corners: how large is the painting? Give --painting-mm WIDTH,HEIGHT, or the side of "
                "markers "
                "in the photographs (--marker-mm)");
        const Rectification r = rectification(corners, size->x, size->y);
        plane = {glm::inverse(r.picture_to_plane_mm), true, kPointSigma_px, corners, "corners"};
        g.rectification = r.output_to_picture;
        g.width = r.width, g.height = r.height;
        g.mm_per_pixel = r.mm_per_pixel;
        unit = 1.0;
    } else {
        plane = plane_to_rectify(seen, chart, g.lens);
        const Upright picture = upright(plane, g.photo_width, g.photo_height);
        g.rectification = picture.picture_to_photo;
        g.width = picture.width, g.height = picture.height;
        unit = unit_mm(plane, c, g.lens);
        if (unit) g.mm_per_pixel = picture.pitch * *unit;
    }
    c.rectified_by = plane.by;
    find_pose(plane, unit, g, c);
}

std::optional<Lens> read_lens_of(const PlaneOptions& options, int width, int height) {
    if (!options.lens) return {};
    try {
        return lens_for(read_lens(*options.lens), width, height);
    } catch (const Error& error) {
        const std::string what = error.what(), file = options.lens->string();
        fail("{}{}", what.starts_with(file) ? "" : file + ": ", what);
    }
}

// Focal length and principal point: as given, else the lens's.
void take_camera(const PlaneOptions& options, const std::optional<Lens>& lens, PlaneCalibration& c) {
    c.focal_px = options.focal_px;
    c.principal_px = options.principal_px.value_or(dvec2((c.width - 1) / 2.0, (c.height - 1) / 2.0));
    if (!lens) return;
    const double of_lens = (lens->focal_px.x + lens->focal_px.y) / 2;
    if (c.focal_px && std::abs(*c.focal_px / of_lens - 1) > kFocalsDiffer)
        c.warnings.push_back(
            fmt::format("--focal-px {:.6g}: the lens file says {:.6g}; the former is used for the camera's "
                        "distance, the latter to undo the distortion",
                        *c.focal_px, of_lens));
    if (!c.focal_px) c.focal_px = of_lens;
    if (!options.principal_px) c.principal_px = lens->principal_px;
}

Transfer transfer_of(const PlaneOptions& options) {
    return options.transfer.value_or(Transfer{Transfer::Kind::srgb});
}

// Where they are asked for.
SeenMarkers find_markers(const PhotoSet& photos, const PlaneOptions& options, const std::optional<Lens>& lens,
                         PlaneCalibration& c, const Progress& progress) {
    SeenMarkers seen;
    if (!options.marker_mm) return seen;
    MarkedPhoto marked = find_marked_photo(photos, transfer_of(options), options.dictionary, progress);
    c.markers = std::move(marked.markers);
    c.markers_in = photos.name(marked.photo);
    for (const std::string& warning : c.markers.warnings)
        c.warnings.push_back(fmt::format("{}: {}", c.markers_in, warning));
    seen.markers = c.markers.markers;
    for (Marker& marker : seen.markers) marker.corners_px = without_lens(lens, marker.corners_px);
    seen.plane = marker_plane(seen.markers, *options.marker_mm);
    c.marker_residual_px = seen.plane->residual_px;
    add_scale(c, seen.plane->scale);
    return seen;
}

// Of all that was told beside markers.
void add_scales(const PlaneOptions& options, const std::optional<Lens>& lens, const ColourCalibration* chart,
                PlaneCalibration& c) {
    if (options.bar)
        add_scale(c, scale_from_bar(without_lens(lens, options.bar->first_px),
                                    without_lens(lens, options.bar->last_px), options.bar->length_mm));
    if (options.pixels_per_inch) add_scale(c, scale_from_ppi(*options.pixels_per_inch));
    if (options.corners_px && options.painting_mm)
        add_scale(c, scale_from_corners(without_lens(lens, *options.corners_px), options.painting_mm->x,
                                        options.painting_mm->y));
    if (chart && chart->scale) c.scales.push_back(*chart->scale);
}

// What contradicts each other.
void find_contradictions(const PlaneOptions& options, const std::optional<Lens>& lens, PlaneCalibration& c) {
    c.poor = contradictions(c.scales, relative_scale(c));
    if (lens && c.rectified_by.empty() && std::max(c.photo_outside, c.picture_outside) > kMostMovedOut)
        c.poor.push_back(fmt::format(
            "{}: with its distortion undone, {:.0f} % of the photographs lie outside the picture, and "
            "{:.0f} % of the picture is empty; is it of this lens, zoomed and focused as here?",
            options.lens->string(), 100 * c.photo_outside, 100 * c.picture_outside));
    if (options.corners_px && options.painting_mm)
        if (auto why = contradiction_of_corners(without_lens(lens, *options.corners_px), *options.painting_mm,
                                                c.focal_px, c.principal_px, std::hypot(c.width, c.height)))
            c.poor.push_back(std::move(*why));
}

}  // namespace

PlaneCalibration calibrate_plane(const PhotoSet& photos, const PlaneOptions& options,
                                 const ColourCalibration* chart, const Progress& progress) {
    PlaneCalibration c;
    const PhotoHeader header = photos.open(0).header();
    c.width = header.width, c.height = header.height;
    PictureGeometry g{.photo_width = c.width, .photo_height = c.height, .width = c.width, .height = c.height};
    g.lens = read_lens_of(options, c.width, c.height);
    take_camera(options, g.lens, c);
    const SeenMarkers markers = find_markers(photos, options, g.lens, c, progress);
    add_scales(options, g.lens, chart, c);
    if (options.earlier) {
        c.earlier = find_painting(photos, *options.earlier, g.lens, transfer_of(options), progress);
        if (options.earlier->mm_per_pixel) add_scale(c, scale_from(*options.earlier, *c.earlier));
    }
    if (options.rectify || options.earlier || g.lens) {
        rank_scales(c.scales, relative_scale(c));  // a chart of unknown size is told by the best of them
        if (options.rectify || options.earlier) rectify(options, markers, chart, g, c);
        measure_outside(g, c);
        c.geometry = g;
    }
    rank_scales(c.scales, relative_scale(c));
    find_contradictions(options, g.lens, c);
    return c;
}

}  // namespace tangi
