#include "cli/capture/calibrate_arguments.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "cli/command.h"

namespace tangi {

namespace {

constexpr double kFarthest_px = 1e6;                     // of places in photographs
constexpr double kShortest_mm = 0.1, kLongest_mm = 1e6;  // of lengths in the scene

// Throws UsageError, naming the flag, where a number is not in the range.
void require_within(std::span<const double> numbers, double least, double most, const std::string& text,
                    const std::string& flag) {
    for (const double n : numbers)
        if (!(n >= least && n <= most))
            throw UsageError(fmt::format("{} {}: {:g} is not in [{:g}, {:g}]", flag, text, n, least, most));
}

GivenSphere sphere_of(const std::string& text) {
    const std::string form = "X,Y,R or a box X0,Y0,X1,Y1 in pixels";
    const std::vector<double> n = numbers_in(text, "--sphere", form);
    require_within(n, -kFarthest_px, kFarthest_px, text, "--sphere");
    if (n.size() == 3 && n[2] > 0) return {.centre_px = {n[0], n[1]}, .radius_px = n[2], .text = text};
    if (n.size() == 4 && n[2] > n[0] && n[3] > n[1])
        return {.centre_px = {(n[0] + n[2]) / 2, (n[1] + n[3]) / 2},
                .radius_px = std::min(n[2] - n[0], n[3] - n[1]) / 2,
                .is_box = true,
                .text = text};
    throw UsageError(fmt::format("--sphere {}: expected {}", text, form));
}

// So many numbers; nothing where the flag was not given.
std::optional<std::vector<double>> numbers_if_given(const std::string& text, const std::string& flag,
                                                    std::size_t count, const std::string& form) {
    if (text.empty()) return {};
    std::vector<double> n = numbers_in(text, flag, form);
    if (n.size() != count) throw UsageError(fmt::format("{} {}: expected {}", flag, text, form));
    return n;
}

std::optional<glm::dvec2> point_of(const std::string& text, const std::string& flag) {
    const auto n = numbers_if_given(text, flag, 2, "X,Y in pixels");
    if (n) require_within(*n, -kFarthest_px, kFarthest_px, text, flag);
    return n ? std::optional(glm::dvec2((*n)[0], (*n)[1])) : std::nullopt;
}

Corners corners_of(const std::vector<double>& n) {
    return {{{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}}};
}

struct PhotoSize {
    int width, height;  // [pixels]
};

// Throws UsageError, naming the flag, where a point does not lie in photographs of this size.
void require_in(const PhotoSize& size, const glm::dvec2& point, const std::string& text,
                const std::string& flag) {
    if (point.x < -0.5 || point.y < -0.5 || point.x > size.width - 0.5 || point.y > size.height - 0.5)
        throw UsageError(fmt::format("{} {}: ({:g}, {:g}) does not lie in the photographs, which are {} x {}",
                                     flag, text, point.x, point.y, size.width, size.height));
}

// Throws UsageError where there is no such dictionary of markers.
void require_dictionary(const std::string& name) {
    const std::vector<std::string> known = marker_dictionaries();
    if (std::find(known.begin(), known.end(), name) == known.end())
        throw UsageError(
            fmt::format("--marker-dictionary {}: is none of auto, {}", name, fmt::join(known, ", ")));
}

std::optional<double> if_given(double value) { return value > 0 ? std::optional(value) : std::nullopt; }

}  // namespace

void CalibrateArguments::add_sphere_flags(Flags& flags) {
    flags.option("--sphere", spheres,
                 "where a sphere is: X,Y,R or a box X0,Y0,X1,Y1 in pixels from the top left; once for each "
                 "sphere; found automatically where not given");
    flags.flag("--diffuse-sphere", matt, "the sphere is matt (grey or white), not a mirror");
    flags.flag("--no-spheres", no_spheres, "look for no spheres: only colours, scale, lens and plane");
    flags
        .option("--sphere-radius-mm", sphere_radius_mm,
                "radius of the spheres; two spheres or more then tell positions")
        .check(within(0.1, 1e4));
}

void CalibrateArguments::add_camera_flags(Flags& flags) {
    flags.option("--focal-px", focal_px, "focal length of the camera in pixels; far away where not given")
        .check(within(10, 1e6));
    flags.option("--focal-35mm", focal_35mm, "its 35-mm equivalent in mm, as in EXIF, instead")
        .check(within(1, 1e4));
    flags.option("--principal-px", principal,
                 "X,Y where the camera looks straight ahead; the picture's centre");
    flags.option("--origin-px", origin,
                 "X,Y where the painting's frame has its origin; the picture's centre");
    flags.option("--camera-distance-mm", camera_distance_mm, "from the camera to the painting's plane")
        .check(within(1, 1e6));
    flags
        .option("--sphere-height-mm", sphere_height_mm,
                "of the spheres' centres above the painting's plane; their radius where not given")
        .check(within(-1e5, 1e5));
}

void CalibrateArguments::add_chart_flags(Flags& flags) {
    flags
        .option(
            "--chart", chart,
            "colour chart of 24 patches: auto (sought), off, or its corners X,Y,X,Y,X,Y,X,Y in pixels, in "
            "order around it")
        .show_default();
    flags.option("--chart-reference", chart_reference,
                 "what the patches should be (.csv or .json); the classic chart's published values where "
                 "not given");
    flags
        .option("--chart-pitch-mm", chart_pitch_mm,
                "from one patch's middle to the next; tells the scale at the chart")
        .check(within(0.1, 1e3));
}

// Scale and plane.
void CalibrateArguments::add_plane_flags(Flags& flags) {
    flags
        .option("--marker-mm", marker_mm,
                "side of the ArUco markers in the photographs; they are found and tell the scale")
        .check(within(0.1, 1e4));
    flags.option("--marker-dictionary", marker_dictionary, "of the markers, such as 4x4_50; auto: found out")
        .show_default();
    flags.option("--scale-bar", scale_bar, "X,Y,X,Y,MM: the ends of a scale bar in pixels, and its length");
    flags.option("--ppi", ppi, "pixels per inch of photographs that were scanned").check(within(1, 1e5));
    flags.option("--corners", corners,
                 "X,Y,X,Y,X,Y,X,Y: the painting's corners in pixels, from its top left clockwise");
    flags.option("--painting-mm", painting_mm, "WIDTH,HEIGHT of the painting, with --corners");
    flags.flag("--rectify", rectify,
               "make the fit's picture upright: by --corners, else by the markers, else by the chart");
    flags.option("--align-to", align_to,
                 "painting file of an earlier state, such as before treatment: the fit's picture is to lie "
                 "on it, pixel by pixel");
    flags.option("--lens", lens, "calibration file of OpenCV (.yml, .xml), to undo the lens's distortion");
}

void CalibrateArguments::add_to(Flags& flags) {
    flags.option("PHOTOS", folder, "folder of photographs, one for each light");
    flags.option("--photos", photos, "photographs, instead of a folder");
    flags
        .option(
            "--out", out,
            "the lights file to write (.lp), with a capture file (.json) and a page (.html) of its name "
            "beside "
            "it (capture.json and capture.html beside lights.lp); or the capture file (.json), with a page "
            "and a lights file of its name")
        .required();
    flags.flag("--force", force, "replace files of these names even where tangipaint did not write them");
    add_sphere_flags(flags);
    add_camera_flags(flags);
    flags.flag("--uncalibrated", uncalibrated,
               "find the lights from the photographs of a nearly flat object alone, without spheres");
    flags.flag("--inverted", inverted,
               "with --uncalibrated: the other reading of the relief, hills for valleys (see the report)");
    flags.flag("--fixed-camera", fixed_camera, "the camera did not move: do not register the photographs");
    flags
        .option("--transfer", transfer,
                "how the photographs are encoded: auto, linear, srgb, or a gamma such as 2.2")
        .show_default();
    add_chart_flags(flags);
    add_plane_flags(flags);
    develop.add_to(flags);
}

SphereCalibrationOptions CalibrateArguments::sphere_options() const {
    SphereCalibrationOptions options{.spheres = {},
                                     .matt = matt,
                                     .fixed_camera = fixed_camera,
                                     .sphere_radius_mm = if_given(sphere_radius_mm),
                                     .focal_px = if_given(focal_px),
                                     .focal_35mm = if_given(focal_35mm),
                                     .principal_px = point_of(principal, "--principal-px"),
                                     .origin_px = point_of(origin, "--origin-px"),
                                     .camera_distance_mm = if_given(camera_distance_mm),
                                     .sphere_height_mm = sphere_height_mm};
    if (no_spheres && (matt || !spheres.empty() || sphere_radius_mm > 0))
        throw UsageError("--no-spheres, and a sphere is described: give one or the other");
    for (const std::string& sphere : spheres) options.spheres.push_back(sphere_of(sphere));
    options.transfer = parse_transfer(transfer);
    return options;
}

std::optional<ColourCalibrationOptions> CalibrateArguments::colour_options() const {
    if (chart == "off") {
        if (chart_pitch_mm > 0)
            throw UsageError("--chart-pitch-mm: is about a colour chart, and --chart off looks for none");
        return {};
    }
    ColourCalibrationOptions options{.transfer = parse_transfer(transfer),
                                     .pitch_mm = if_given(chart_pitch_mm)};
    if (!chart_reference.empty()) options.reference = chart_reference;
    if (chart == "auto") return options;
    const auto n =
        numbers_if_given(chart, "--chart", 8,
                         "auto, off, or the corners X,Y,X,Y,X,Y,X,Y in pixels, in order around the chart");
    options.corners_px = corners_of(*n);
    return options;
}

PlaneOptions CalibrateArguments::plane_options(int width, int height) const {
    PlaneOptions options;
    options.marker_mm = if_given(marker_mm);
    if (marker_dictionary != "auto") {
        if (!options.marker_mm)
            throw UsageError("--marker-dictionary: give the side of the markers as well (--marker-mm)");
        require_dictionary(marker_dictionary);
        options.dictionary = marker_dictionary;
    }
    if (const auto n =
            numbers_if_given(scale_bar, "--scale-bar", 5, "X,Y,X,Y,MM: two points in pixels and a length")) {
        require_within(std::span(*n).last(1), kShortest_mm, kLongest_mm, scale_bar, "--scale-bar");
        options.bar = ScaleBar{{(*n)[0], (*n)[1]}, {(*n)[2], (*n)[3]}, (*n)[4]};
    }
    options.pixels_per_inch = if_given(ppi);
    if (const auto n = numbers_if_given(corners, "--corners", 8,
                                        "X,Y,X,Y,X,Y,X,Y in pixels, from the top left clockwise"))
        options.corners_px = corners_of(*n);
    if (const auto n = numbers_if_given(painting_mm, "--painting-mm", 2, "WIDTH,HEIGHT in mm")) {
        require_within(*n, kShortest_mm, kLongest_mm, painting_mm, "--painting-mm");
        options.painting_mm = glm::dvec2((*n)[0], (*n)[1]);
    }
    if (options.painting_mm && !options.corners_px)
        throw UsageError("--painting-mm: where is the painting? Give its corners (--corners)");
    if (options.corners_px && !options.painting_mm && !options.marker_mm)
        throw UsageError(
            "--corners: how large is the painting? Give --painting-mm, or --marker-mm of markers");
    const PhotoSize size{width, height};
    if (options.corners_px)
        for (const glm::dvec2& corner : *options.corners_px) require_in(size, corner, corners, "--corners");
    if (options.bar)
        for (const glm::dvec2& end : {options.bar->first_px, options.bar->last_px})
            require_in(size, end, scale_bar, "--scale-bar");
    options.rectify = rectify;
    if (!align_to.empty() && (rectify || options.corners_px))
        throw UsageError(
            "--align-to: makes the picture that the painting has; leave out --rectify and --corners");
    if (!lens.empty()) options.lens = lens;
    options.focal_px = if_given(focal_px);
    if (focal_35mm > 0) options.focal_px = focal_35mm / std::hypot(36.0, 24.0) * std::hypot(width, height);
    options.principal_px = point_of(principal, "--principal-px");
    options.transfer = parse_transfer(transfer);
    return options;
}

}  // namespace tangi
