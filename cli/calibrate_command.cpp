// calibrate_command.cpp: tangipaint calibrate PHOTOS --out lights.lp
#include <glm/geometric.hpp>

#include "capture/calibration_page.h"
#include "capture/colour_calibration.h"
#include "capture/uncalibrated_report.h"
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "surface/atomic_file.h"
#include "surface/error.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct CalibrateArguments {
    std::string folder, out, transfer = "auto", principal, origin;
    std::string chart = "auto", chart_reference;
    double chart_pitch_mm = 0;
    std::vector<std::string> photos, spheres;
    double ball_radius_mm = 0, focal_px = 0, focal_35mm = 0, camera_distance_mm = 0;
    std::optional<double> ball_height_mm;
    bool matt = false, fixed_camera = false, uncalibrated = false, inverted = false;
};

GivenBall ball_of(const std::string& text) {
    const std::string form = "X,Y,R or a box X0,Y0,X1,Y1 in pixels";
    const std::vector<double> n = numbers_in(text, "--sphere", form);
    if (n.size() == 3 && n[2] > 0) return {.centre_px = {n[0], n[1]}, .radius_px = n[2], .text = text};
    if (n.size() == 4 && n[2] > n[0] && n[3] > n[1])
        return {.centre_px = {(n[0] + n[2]) / 2, (n[1] + n[3]) / 2},
                .radius_px = std::min(n[2] - n[0], n[3] - n[1]) / 2,
                .is_box = true,
                .text = text};
    throw UsageError(fmt::format("--sphere {}: expected {}", text, form));
}

std::optional<glm::dvec2> point_of(const std::string& text, const std::string& flag) {
    if (text.empty()) return std::nullopt;
    const std::vector<double> n = numbers_in(text, flag, "X,Y in pixels");
    if (n.size() != 2) throw UsageError(fmt::format("{} {}: expected X,Y in pixels", flag, text));
    return glm::dvec2(n[0], n[1]);
}

std::optional<double> if_given(double value) { return value > 0 ? std::optional(value) : std::nullopt; }

std::optional<Transfer> transfer_of(const CalibrateArguments& a) {
    if (a.transfer == "auto") return {};
    const std::optional<Transfer> transfer = transfer_named(a.transfer);
    if (!transfer)
        throw UsageError(
            fmt::format("--transfer {}: is not auto, linear, srgb, or a gamma in [0.2, 5]", a.transfer));
    return transfer;
}

BallCalibrationOptions options_of(const CalibrateArguments& a) {
    BallCalibrationOptions options{.balls = {},
                                   .matt = a.matt,
                                   .fixed_camera = a.fixed_camera,
                                   .ball_radius_mm = if_given(a.ball_radius_mm),
                                   .focal_px = if_given(a.focal_px),
                                   .focal_35mm = if_given(a.focal_35mm),
                                   .principal_px = point_of(a.principal, "--principal-px"),
                                   .origin_px = point_of(a.origin, "--origin-px"),
                                   .camera_distance_mm = if_given(a.camera_distance_mm),
                                   .ball_height_mm = a.ball_height_mm};
    for (const std::string& sphere : a.spheres) options.balls.push_back(ball_of(sphere));
    options.transfer = transfer_of(a);
    return options;
}

ColourCalibrationOptions colour_options_of(const CalibrateArguments& a) {
    ColourCalibrationOptions options{.transfer = transfer_of(a), .pitch_mm = if_given(a.chart_pitch_mm)};
    if (!a.chart_reference.empty()) options.reference = a.chart_reference;
    if (a.chart == "auto") return options;
    const std::string form = "auto, off, or the corners X,Y,X,Y,X,Y,X,Y in pixels, in order around the chart";
    const std::vector<double> n = numbers_in(a.chart, "--chart", form);
    if (n.size() != 8) throw UsageError(fmt::format("--chart {}: expected {}", a.chart, form));
    options.corners_px = ChartCorners{{{n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}}};
    return options;
}

nlohmann::json result_of(const BallCalibration& c, const CalibrationFiles& files) {
    nlohmann::json balls = nlohmann::json::array(), left_out = nlohmann::json::array();
    for (const FoundBall& ball : c.balls)
        balls.push_back({{"name", ball.name},
                         {"centre_px", {ball.image.centre_px.x, ball.image.centre_px.y}},
                         {"radius_px", ball.image.radius_px},
                         {"radius_sigma_px", ball.image.radius_sigma_px}});
    std::vector<double> sigmas, position_sigmas;
    int positions = 0;
    for (const CalibratedLight& light : c.lights) {
        if (!light.direction) {
            left_out.push_back(light.name);
            continue;
        }
        sigmas.push_back(light.direction_sigma_deg);
        if (!light.position_mm) continue;
        ++positions;
        position_sigmas.push_back(glm::length(light.position_sigma_mm));
    }
    const auto median = [](std::vector<double> values) -> nlohmann::json {
        if (values.empty()) return nullptr;
        std::sort(values.begin(), values.end());
        return values[values.size() / 2];
    };
    return {
        {"lights", files.lights.string()},
        {"capture", files.json.string()},
        {"report", files.page.string()},
        {"method", c.method},
        {"photographs", {{"all", c.lights.size()}, {"calibrated", c.calibrated()}, {"left_out", left_out}}},
        {"balls", balls},
        {"positions", positions},
        {"median_direction_sigma_deg", median(sigmas)},
        {"median_position_sigma_mm", median(position_sigmas)},
        {"camera_moved_rms_px", c.drifts.moved ? c.drifts.rms_px : 0}};
}

nlohmann::json summary_of(const ColourCalibration& c) {
    nlohmann::json levels = nlohmann::json::object();
    for (const ToleranceResult& t : c.tolerances) levels[t.standard] = t.level.empty() ? "none" : t.level;
    return {{"chart_in", c.found_in},
            {"transfer", c.transfer.name()},
            {"delta_e_2000",
             {{"white_balance", finite(c.correction.before.mean)},
              {"corrected", finite(c.correction.after.mean)},
              {"corrected_maximum", finite(c.correction.after.maximum)},
              {"left_out", finite(c.correction.left_out.mean)}}},
            {"levels", levels}};
}

nlohmann::json run_uncalibrated(const CalibrateArguments& a, const std::vector<fs::path>& paths,
                                const std::vector<std::string>& warnings) {
    UncalibratedStack stack = calibrate_uncalibrated(
        paths, {.inverted = a.inverted, .transfer = transfer_of(a)}, console_progress());
    std::vector<std::string>& told_too = stack.calibration.warnings;
    told_too.insert(told_too.begin(), warnings.begin(), warnings.end());
    nlohmann::json result = result_of(stack.calibration, write_uncalibrated(a.out, stack));
    result["uncalibrated"] = {{"inverted", a.inverted},
                              {"transfer", stack.transfer.name()},
                              {"strength_scatter", finite(stack.found.strength_scatter)},
                              {"residual", finite(stack.found.residual)},
                              {"explained", finite(stack.found.explained)},
                              {"curl", finite(stack.found.curl)},
                              {"falloff", finite(stack.found.falloff)},
                              {"convexity", finite(stack.found.convexity)}};
    result["colour"] = nullptr;
    result["warnings"] = told(stack.calibration.warnings);
    result["poor"] = stack.calibration.poor;
    return result;
}

nlohmann::json run_calibrate(const CalibrateArguments& a) {
    const Progress progress = console_progress();
    if (fs::path(a.out).extension() != ".lp")
        throw UsageError(fmt::format("--out {}: a lights file ends in .lp", a.out));
    if (a.folder.empty() == a.photos.empty())
        throw UsageError("give either a folder of photographs (PHOTOS) or photographs (--photos A B …)");
    if (a.inverted && !a.uncalibrated) throw UsageError("--inverted: goes with --uncalibrated");
    if (a.uncalibrated && (a.matt || !a.spheres.empty()))
        throw UsageError("--uncalibrated: takes no ball; leave out --sphere and --matt-ball");
    const BallCalibrationOptions options = options_of(a);
    std::optional<ColourCalibrationOptions> colour_options;
    if (a.chart != "off") colour_options = colour_options_of(a);
    { const AtomicFile writable(a.out); }  // before the work: an output that can't be written is known now
    std::vector<std::string> warnings;
    std::vector<fs::path> paths;
    if (!a.folder.empty())
        paths = pictures_in(a.folder, warnings);
    else
        paths.assign(a.photos.begin(), a.photos.end());
    if (a.uncalibrated) return run_uncalibrated(a, paths, warnings);
    BallCalibration calibration = calibrate_from_balls(paths, options, progress);
    calibration.warnings.insert(calibration.warnings.begin(), warnings.begin(), warnings.end());
    std::optional<ColourCalibration> colours;
    if (colour_options) colours = calibrate_colours(paths, *colour_options, progress);
    if (colours)
        calibration.warnings.insert(calibration.warnings.end(), colours->warnings.begin(),
                                    colours->warnings.end());
    const CalibrationFiles files = write_calibration(a.out, calibration, colours);
    nlohmann::json result = result_of(calibration, files);
    result["colour"] = colours ? summary_of(*colours) : nlohmann::json(nullptr);
    result["warnings"] = told(calibration.warnings);
    result["poor"] = calibration.poor;
    return result;
}

}  // namespace

Command calibrate_command() {
    return {
        "calibrate", "find where the light came from in each photograph, from mirror or matt balls",
        [](Flags& flags) {
            auto a = std::make_shared<CalibrateArguments>();
            flags.option("PHOTOS", a->folder, "folder of photographs, one for each light");
            flags.option("--photos", a->photos, "photographs, instead of a folder");
            flags
                .option("--out", a->out,
                        "the lights file to write (.lp); capture.json and capture.html are written beside it")
                .required();
            flags.option(
                "--sphere", a->spheres,
                "where a ball is: X,Y,R or a box X0,Y0,X1,Y1 in pixels from the top left; once for each "
                "ball; found automatically where not given");
            flags.flag("--matt-ball", a->matt, "the ball is matt (grey or white), not a mirror");
            flags
                .option("--ball-radius-mm", a->ball_radius_mm,
                        "radius of the balls; two balls or more then tell positions")
                .check(positive());
            flags
                .option("--focal-px", a->focal_px,
                        "focal length of the camera in pixels; far away where not given")
                .check(positive());
            flags.option("--focal-35mm", a->focal_35mm, "its 35-mm equivalent in mm, as in EXIF, instead")
                .check(positive());
            flags.option("--principal-px", a->principal,
                         "X,Y where the camera looks straight ahead; the picture's centre");
            flags.option("--origin-px", a->origin,
                         "X,Y where the painting's frame has its origin; the picture's centre");
            flags
                .option("--camera-distance-mm", a->camera_distance_mm,
                        "from the camera to the painting's plane")
                .check(positive());
            flags.option("--ball-height-mm", a->ball_height_mm,
                         "of the balls' centres above the painting's plane; their radius where not given");
            flags.flag("--uncalibrated", a->uncalibrated,
                       "find the lights from the photographs of a nearly flat object alone, without balls");
            flags.flag(
                "--inverted", a->inverted,
                "with --uncalibrated: the other reading of the relief, hills for valleys (see the report)");
            flags.flag("--fixed-camera", a->fixed_camera,
                       "the camera did not move: do not register the photographs");
            flags
                .option("--transfer", a->transfer,
                        "for a matt ball and the chart: auto, linear, srgb, or a gamma such as 2.2")
                .show_default();
            flags
                .option("--chart", a->chart,
                        "colour chart of 24 patches: auto (sought), off, or its corners X,Y,X,Y,X,Y,X,Y in "
                        "pixels, in "
                        "order around it")
                .show_default();
            flags.option(
                "--chart-reference", a->chart_reference,
                "what the patches should be (.csv or .json); the classic chart's published values where "
                "not given");
            flags
                .option("--chart-pitch-mm", a->chart_pitch_mm,
                        "from one patch's middle to the next; tells the scale at the chart")
                .check(positive());
            return [a] { return run_calibrate(*a); };
        }};
}

}  // namespace tangi
