// calibrate_command.cpp: tangipaint calibrate PHOTOS --out lights.lp
#include <climits>
#include <glm/geometric.hpp>

#include "capture/calibration/calibration_page.h"
#include "capture/formats/lights_format.h"
#include "capture/photo/stated_transfer.h"
#include "capture/radiometry/develop_stack.h"
#include "capture/stack/open_screened.h"
#include "capture/stack/photo_profiles.h"
#include "capture/uncalibrated/uncalibrated_report.h"
#include "cli/capture/calibrate_arguments.h"
#include "cli/command_list.h"
#include "fit/pipeline/preprocess.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

nlohmann::json result_of(const SphereCalibration& c, const CalibrationFiles& files) {
    nlohmann::json spheres = nlohmann::json::array(), rejected = nlohmann::json::array();
    for (const FoundSphere& sphere : c.spheres)
        spheres.push_back({{"name", sphere.name},
                           {"centre_px", {sphere.image.centre_px.x, sphere.image.centre_px.y}},
                           {"radius_px", sphere.image.radius_px},
                           {"radius_sigma_px", sphere.image.radius_sigma_px}});
    std::vector<double> sigmas, position_sigmas;
    int positions = 0;
    for (const CalibratedLight& light : c.lights) {
        if (!light.direction) {
            rejected.push_back(light.name);
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
        {"lights", c.calibrated() > 0 ? nlohmann::json(files.lights.string()) : nlohmann::json(nullptr)},
        {"capture", files.json.string()},
        {"report", files.page.string()},
        {"method", c.method},
        {"photographs", {{"all", c.lights.size()}, {"calibrated", c.calibrated()}, {"rejected", rejected}}},
        {"spheres", spheres},
        {"positions", positions},
        {"median_direction_sigma_deg", median(sigmas)},
        {"median_position_sigma_mm", median(position_sigmas)},
        {"camera_moved_rms_px", c.drifts.moved ? c.drifts.rms_px : 0}};
}

nlohmann::json summary_of(const ColourCalibration& c) {
    nlohmann::json levels = nlohmann::json::object();
    for (const ToleranceResult& t : c.tolerances) levels[t.standard] = t.level.empty() ? "none" : t.level;
    const auto worst = c.correction.worst_photo();
    return {{"chart_in", c.found_in},
            {"transfer", c.transfer.name()},
            {"delta_e_2000",
             {{"white_balance", finite(c.correction.before.mean)},
              {"corrected", finite(c.correction.after.mean)},
              {"corrected_maximum", finite(c.correction.after.maximum)},
              {"worst_photograph", worst ? finite(c.correction.of_photos[*worst].after.mean) : nullptr},
              {"cross_validated", finite(c.correction.cross_validated.mean)}}},
            {"white_balances", to_json(c.white_balances, c.photos)},
            {"levels", levels}};
}

nlohmann::json summary_of(const PlaneCalibration& c) {
    nlohmann::json result = {{"scale", nullptr}, {"picture", nullptr}};
    if (const auto scale = c.scale())
        result["scale"] = {
            {"mm_per_pixel", scale->mm_per_pixel}, {"sigma", scale->sigma}, {"method", scale->method}};
    if (!c.geometry) return result;
    const PictureGeometry& g = *c.geometry;
    const auto or_null = [](const std::optional<double>& value) {
        return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
    };
    result["picture"] = {
        {"width", g.width},
        {"height", g.height},
        {"mm_per_pixel", or_null(g.rectification ? g.mm_per_pixel
                                 : c.scale()     ? std::optional(c.scale()->mm_per_pixel)
                                                 : std::nullopt)},
        {"undistorted", g.lens.has_value()},
        {"rectified_by", c.rectified_by.empty() ? nlohmann::json(nullptr) : nlohmann::json(c.rectified_by)},
        {"tilt_deg", or_null(c.tilt_deg)},
        {"tilt_sigma_deg", c.tilt_deg ? nlohmann::json(c.tilt_sigma_deg) : nlohmann::json(nullptr)},
        {"aligned_sigma_px", c.earlier ? nlohmann::json(c.earlier->error_px) : nlohmann::json(nullptr)},
        {"photograph_outside", c.photo_outside},
        {"picture_outside", c.picture_outside}};
    return result;
}

// The photographs that are given, each once.
std::vector<fs::path> given_photographs(const CalibrateArguments& a, std::vector<std::string>& warnings) {
    if (!a.folder.empty()) return pictures_in(a.folder, warnings);
    std::vector<fs::path> paths;
    for (const std::string& photo : a.photos) {
        std::error_code missing;  // told when it is opened
        const auto same = std::find_if(paths.begin(), paths.end(), [&](const fs::path& path) {
            return path == photo || fs::equivalent(path, photo, missing);
        });
        if (same == paths.end())
            paths.emplace_back(photo);
        else
            warnings.push_back(fmt::format("--photos {}: is {}, which is given already; it is used once",
                                           photo, same->string()));
    }
    return paths;
}

// The photographs, developed where that is asked for or they are raws.
PhotoSet photographs(const CalibrateArguments& a, const std::vector<fs::path>& paths,
                     Calibration& calibration, std::vector<std::string>& warnings,
                     std::vector<RejectedPhoto>& rejected, const Progress& progress) {
    StackOptions options;
    options.transfer = parse_transfer(a.transfer);
    options.develop = a.develop.options();
    Stack stack = open_usable_photographs(paths, options, rejected);
    if (a.develop.asks_anything() && !stack.is_raw && stack.bits != 32 && !stack.transfer) {
        // Frames are subtracted from light, and no light is known yet to tell the curve by.
        const auto stated = transfer_of_metadata(metadata_in(stack, stack.photos.front().path));
        if (!stated || !stated->binding || !stated->transfer)
            throw UsageError(
                "--dark, --flat, --ambient and --brackets need to know how the photographs are encoded: give "
                "--transfer linear, srgb or a gamma");
        stack.transfer = stated->transfer;
    }
    const DevelopReport report = develop_stack(stack, {}, progress);
    calibration.development = to_json(report);
    if (stack.is_raw) calibration.raw_colour = a.develop.raw_colour;
    // One picture under two names would count twice: as the fit does, look at all before anything else.
    for (RejectedPhoto& photo : leave_out_damaged_and_copies(stack, progress))
        rejected.push_back(std::move(photo));
    require_few(rejected, stack.photos.size() + rejected.size(), 1, stack.folder.string());
    warnings.insert(warnings.end(), stack.warnings.begin(), stack.warnings.end());
    return PhotoSet(std::move(stack));
}

// What the scale and the lens say of the camera, where the user did not.
void add_camera(const PlaneCalibration& plane, SphereCalibrationOptions& options) {
    constexpr double kStraight_deg = 2;  // beyond, the picture's middle is no measure of the distance
    if (!options.focal_px && !options.focal_35mm) options.focal_px = plane.focal_px;
    if (!options.principal_px && plane.geometry && plane.geometry->lens)
        options.principal_px = plane.principal_px;
    if (plane.geometry) options.lens = plane.geometry->lens;
    const std::optional<Scale> scale = plane.scale();
    if (scale) options.mm_per_pixel = scale->mm_per_pixel;
    if (!scale || !plane.focal_px || options.camera_distance_mm) return;
    if (plane.tilt_deg.value_or(0) > kStraight_deg) return;
    options.camera_distance_mm = *plane.focal_px * scale->mm_per_pixel;
}

// The spheres; none where they are not wanted, or not there and something else was found.
SphereCalibration spheres_of(const CalibrateArguments& a, const PhotoSet& photos,
                             const SphereCalibrationOptions& options, bool something_else,
                             const Progress& progress) {
    if (a.no_spheres) return without_spheres(photos, options);
    try {
        return calibrate_from_spheres(photos, options, progress);
    } catch (const NoSphereError& error) {
        if (!something_else) throw;
        SphereCalibration none = without_spheres(photos, options);
        // Who describes spheres has some in the picture.
        std::vector<std::string>& said =
            a.sphere_radius_mm > 0 || a.sphere_height_mm ? none.poor : none.warnings;
        said.push_back(fmt::format(
            "{}; the rest is written without lights: --no-spheres says that there are none", error.what()));
        return none;
    }
}

// Lights from the photographs alone, and what the result says of them.
nlohmann::json find_uncalibrated(const CalibrateArguments& a, const PhotoSet& photos,
                                 Calibration& calibration, const Progress& progress) {
    std::optional<Transfer> transfer = parse_transfer(a.transfer);
    if (!transfer && calibration.colours) transfer = calibration.colours->transfer;
    const UncalibratedStack stack =
        calibrate_uncalibrated(photos, {.inverted = a.inverted, .transfer = transfer}, progress);
    calibration.lights = stack.calibration;
    calibration.section = readings_section(stack.found, a.out);
    return {{"inverted", a.inverted},
            {"transfer", stack.transfer.name()},
            {"strength_scatter", finite(stack.found.strength_scatter)},
            {"gloss", finite(stack.found.gloss)},
            {"residual", finite(stack.found.residual)},
            {"explained", finite(stack.found.explained)},
            {"curl", finite(stack.found.curl)},
            {"falloff", finite(stack.found.falloff)},
            {"convexity", finite(stack.found.convexity)}};
}

// Warnings and doubts of all parts, into those of the lights.
void add_notes(const std::vector<std::string>& first, Calibration& calibration) {
    SphereCalibration& lights = calibration.lights;
    lights.warnings.insert(lights.warnings.begin(), first.begin(), first.end());
    const auto add = [&](std::vector<std::string>& to, const std::vector<std::string>& more) {
        to.insert(to.end(), more.begin(), more.end());
    };
    if (calibration.colours) add(lights.warnings, calibration.colours->warnings);
    if (calibration.plane) {
        add(lights.warnings, calibration.plane->warnings);
        add(lights.poor, calibration.plane->poor);
    }
    if (calibration.colours && calibration.colours->correction.after.mean > kWorstChart)
        lights.poor.push_back(
            fmt::format("the colour chart's patches are off by {:.1f} (mean CIEDE2000); is it a "
                        "chart, and in their light? The fit will not use it",
                        calibration.colours->correction.after.mean));
}

// [1] By which the scale that spheres and camera tell may differ from a measured one: an outline is good to
// 0.4 pixels, of a radius of 30 or so, and a camera's distance to a hundredth.
constexpr double kScalesDiffer = 0.05;

// A scale that was asked for and is not there, and one that spheres or camera contradict: the fit goes by the
// one of the plane.
void add_doubts_of_scale(const CalibrateArguments& a, Calibration& calibration) {
    SphereCalibration& lights = calibration.lights;
    if (a.chart_pitch_mm > 0 && !(calibration.colours && calibration.colours->scale))
        lights.poor.emplace_back(
            "--chart-pitch-mm: no colour chart is found, so that it tells no scale; say where it is "
            "(--chart X,Y,X,Y,X,Y,X,Y)");
    const std::optional<Scale> scale = calibration.plane ? calibration.plane->scale() : std::nullopt;
    std::optional<double> other = lights.mm_per_pixel;
    std::string by =
        lights.spheres.empty() ? "the camera's distance and focal length" : "the spheres and the camera";
    if (!other && calibration.plane && calibration.plane->focal_px && a.camera_distance_mm > 0) {
        other = a.camera_distance_mm / *calibration.plane->focal_px;
        by = "the camera's distance and focal length";
    }
    if (!scale || !other || calibration.plane->geometry) return;
    const double off = *other / scale->mm_per_pixel - 1;
    if (std::abs(off) <= kScalesDiffer + 3 * scale->sigma / scale->mm_per_pixel) return;
    lights.poor.push_back(
        fmt::format("the scale by {} is {:.5g} ± {:.2g} mm per pixel, that by {} {:.5g}, {:.1f} % {}; the "
                    "former is used. "
                    "Check the lengths, and that what they measure lies in the painting's plane",
                    scale->method, scale->mm_per_pixel, scale->sigma, by, *other, 100 * std::abs(off),
                    off > 0 ? "more" : "less"));
}

// Files that are read, and files that this program did not write.
void refuse_to_replace(const CalibrateArguments& a) {
    const CalibrationFiles files = calibration_files(a.out);
    for (const fs::path& output : {files.lights, files.json, files.page})
        refuse_to_overwrite(output, a.develop.inputs());
    if (a.force) return;
    std::vector<std::string> names;
    for (const fs::path& output : not_ours(files)) names.push_back(output.string());
    if (!names.empty())
        fail(
            "--out {}: would replace {}, which is not as tangipaint wrote it; choose another name, or give "
            "--force",
            a.out, joined(names));
}

// Of the formats of lights files, those that are written.
void require_lights_out(const std::string& out) {
    const LightsFormat* format = lights_format_named(out);
    if (format && format->is_written) return;
    std::string endings;
    for (const LightsFormat& known : lights_formats())
        if (known.is_written)
            endings += fmt::format("{} {} {} {}", endings.empty() ? "a" : ", a", known.name,
                                   endings.empty() ? "ends in" : "in", known.extension);
    throw UsageError(fmt::format("--out {}: {}", out, endings));
}

void require_sense(const CalibrateArguments& a) {
    require_lights_out(a.out);
    if (a.folder.empty() == a.photos.empty())
        throw UsageError("give either a folder of photographs (PHOTOS) or photographs (--photos A B …)");
    if (a.inverted && !a.uncalibrated) throw UsageError("--inverted: goes with --uncalibrated");
    if (a.uncalibrated && (a.matt || a.no_spheres || !a.spheres.empty()))
        throw UsageError(
            "--uncalibrated: takes no sphere; leave out --sphere, --diffuse-sphere and --no-spheres");
    (void)a.sphere_options();
    (void)a.colour_options();
    (void)a.plane_options(INT_MAX, INT_MAX);
}

// All that the photographs tell, and what the result says of it. `damaged`: photographs that are left out of
// `paths`, each with a warning.
nlohmann::json calibrated(const CalibrateArguments& a, const std::vector<fs::path>& paths,
                          const std::optional<EarlierPainting>& earlier, std::vector<std::string> warnings,
                          std::vector<RejectedPhoto> rejected, const Progress& progress) {
    for (const RejectedPhoto& photo : rejected) warnings.push_back(photo.reason + "; rejected");
    Calibration calibration;
    const PhotoSet photos = photographs(a, paths, calibration, warnings, rejected, progress);
    const PhotoHeader header = photos.open(0).header();
    SphereCalibrationOptions sphere_options = a.sphere_options();
    PlaneOptions plane_options = a.plane_options(header.width, header.height);
    plane_options.earlier = earlier;
    if (const auto colour_options = a.colour_options())
        calibration.colours = calibrate_colours(photos, *colour_options, progress);
    const ColourCalibration* chart = calibration.colours ? &*calibration.colours : nullptr;
    if (plane_options.asks_anything() || (chart && chart->scale)) {
        calibration.plane = calibrate_plane(photos, plane_options, chart, progress);
        add_camera(*calibration.plane, sphere_options);
    }
    if (a.no_spheres && !calibration.plane && !chart)
        fail(
            "{}: {}, and --no-spheres leaves nothing else to look for; ask for something: --chart, --ppi, "
            "--scale-bar, --marker-mm, --corners, --lens",
            photos.folder().string(),
            a.colour_options() ? "no colour chart is found" : "--chart off looks for no colour chart");
    nlohmann::json uncalibrated;
    if (a.uncalibrated)
        uncalibrated = find_uncalibrated(a, photos, calibration, progress);
    else
        calibration.lights = spheres_of(a, photos, sphere_options, calibration.plane || chart, progress);
    add_notes(warnings, calibration);
    add_doubts_of_scale(a, calibration);
    SphereCalibration& lights = calibration.lights;
    const CalibrationFiles files = write_calibration(a.out, calibration);
    nlohmann::json result = result_of(lights, files);
    for (const RejectedPhoto& photo : rejected) result["photographs"]["rejected"].push_back(photo.name);
    result["photographs"]["unusable"] = to_json(rejected);
    if (a.uncalibrated) result["uncalibrated"] = uncalibrated;
    result["colour"] = chart ? summary_of(*chart) : nlohmann::json(nullptr);
    const nlohmann::json plane =
        calibration.plane ? summary_of(*calibration.plane) : nlohmann::json::object();
    result["scale"] = plane.value("scale", nlohmann::json(nullptr));
    result["picture"] = plane.value("picture", nlohmann::json(nullptr));
    result["development"] = calibration.development;
    result["warnings"] = told(lights.warnings);
    result["poor"] = lights.poor;
    return result;
}

nlohmann::json run_calibrate(const CalibrateArguments& a) {
    const Progress progress = console_progress();
    require_sense(a);  // flags that make no sense are known before the work
    refuse_to_replace(a);
    { const AtomicFile writable(a.out); }  // and an output that can't be written
    std::vector<std::string> warnings;
    std::vector<fs::path> paths = given_photographs(a, warnings);
    const std::size_t all = paths.size();
    std::optional<EarlierPainting> earlier;
    if (!a.align_to.empty()) earlier = earlier_painting(read_painting(a.align_to, progress));
    std::vector<RejectedPhoto> damaged;
    while (true) try {
            return calibrated(a, paths, earlier, warnings, damaged, progress);
        } catch (const PhotoError& error) {  // damage that shows only when pixels are decoded
            if (std::erase(paths, error.path()) == 0) throw;
            damaged.push_back({error.path().filename().string(), error.what()});
            require_few(damaged, all, 1, error.path().parent_path().string());
        }
}

}  // namespace

Command calibrate_command() {
    return {"calibrate",
            "find lights from spheres, colours from a chart, scale and plane from markers or corners",
            [](Flags& flags) {
                auto a = std::make_shared<CalibrateArguments>();
                a->add_to(flags);
                return [a] { return run_calibrate(*a); };
            }};
}

}  // namespace tangi
