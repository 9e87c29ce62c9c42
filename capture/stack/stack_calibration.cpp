#include "capture/stack/stack_calibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capture/formats/lights_format.h"
#include "capture/photo/photo_folder.h"
#include "capture/photo/photo_format.h"
#include "surface/base/error.h"
#include "surface/file/visible_files.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// The one .lp of a folder; the one project of another program (.relight, .dome) where there is none.
fs::path find_lights_file(const fs::path& folder) {
    std::vector<std::string> found, of_others;
    for (const fs::path& path : visible_files(folder)) {
        const LightsFormat* format = lights_format_named(path);
        if (!format || format->search == LightsSearch::never) continue;
        (format->search == LightsSearch::first ? found : of_others).push_back(path.filename().string());
    }
    if (found.empty()) found = std::move(of_others);
    std::sort(found.begin(), found.end());
    if (found.empty() && photos_in(folder).empty())
        fail(
            "{}: neither photographs ({}) nor a lights file in "
            "this folder",
            folder.string(), photo_formats_in_words());
    if (found.empty())
        fail(
            "{0}: no lights file ({1}) in this folder; name one with --lights FILE.lp, or "
            "make one from the photographs: tangipaint calibrate {0} --out {0}/lights.lp --uncalibrated "
            "(without "
            "--uncalibrated where they show a mirror sphere)",
            folder.string(), extensions_in_words([](const LightsFormat& format) {
                return format.search != LightsSearch::never;
            }));
    if (found.size() > 1)
        fail("{}: {} lights files in this folder ({}); choose one with --lights FILE.lp", folder.string(),
             found.size(), joined(found));
    return folder / found.front();
}

void apply_colour(Stack& stack, const CaptureColour& colour, const fs::path& path) {
    if (stack.channels == 1) {
        stack.warnings.push_back(
            fmt::format("{}: its colours are not used, since the photographs of {} are grey", path.string(),
                        stack.folder.string()));
        return;
    }
    if (colour.misfit > kWorstChart) {
        stack.warnings.push_back(fmt::format(
            "{}: its colours are not used, since they are off by {:.1f} (mean CIEDE2000 of the chart): "
            "is it a colour chart, and in their light?",
            path.string(), colour.misfit));
        return;
    }
    const bool rec709 = stack.develop.raw_colour == RawColour::rec709;
    if (stack.is_raw && rec709 != colour.raw_rec709)
        fail("{}: its colour chart was read from raws with --raw-colour {}; give the same", path.string(),
             colour.raw_rec709 ? "rec709" : "camera");
    const DevelopOptions& develop = stack.develop;
    std::vector<std::string> here;
    if (develop.dark) here.emplace_back("dark");
    if (develop.flat) here.emplace_back("flat");
    if (develop.ambient) here.emplace_back("ambient");
    if (develop.brackets) here.emplace_back("brackets");
    if (here != colour.developed_with)
        stack.warnings.push_back(fmt::format(
            "{}: its colour chart was read with {}, the photographs are read with {}; where that changes "
            "colours, they are off: give the same to calibrate",
            path.string(), colour.developed_with.empty() ? "no frames" : "--" + joined(colour.developed_with),
            here.empty() ? "no frames" : "--" + joined(here)));
    stack.colour = colour;
    if (stack.transfer || stack.is_raw || stack.bits == 32) return;
    stack.transfer = colour.transfer;
    stack.transfer_of_chart = true;
}

// Puts what was calibrated into the frame of the crop.
void apply_lights(Stack& stack, const CaptureFile& capture) {
    const CaptureFile seen = seen_from(in_picture(capture), stack.crop);
    for (StackPhoto& photo : stack.photos) {
        const std::string name = photo.light.name;
        photo.light = seen.lights[static_cast<std::size_t>(photo.number)];
        photo.light.name = name;
    }
    stack.mm_per_pixel = seen.mm_per_pixel;
    stack.camera_mm = seen.camera_mm;
}

// Lengths that differ by more than rounding make positions of what passes for directions.
constexpr double kLengthsDiffer = 1.05;

constexpr double kCoarse_deg = 0.5;  // of directions; two are the same within that (duplicate_photos.h)

// [1] Half a unit of the last decimal of directions: each component is within that of what was meant.
double rounding_of(const LightList& file) { return 0.5 * std::pow(10.0, -file.decimals); }

// The standard errors of an .lp that `tangipaint calibrate` wrote are in the capture file beside it, and what
// is poor about it.
void add_what_is_beside(const fs::path& path, StackCalibration& read) {
    const fs::path beside = calibration_files(path).json;
    std::error_code none;
    if (!fs::is_regular_file(beside, none) || !is_lights_file_of(path, beside)) return;
    CaptureFile capture = read_capture_file(beside);
    read.direction_sigma_deg = std::move(capture.direction_sigma_deg);
    read.poor = std::move(capture.poor);
}

// Counter-clockwise, looking down z. Quarters of a turn are exact.
Vec3 turned(const Vec3& v, double degrees) {
    Vec3 result = v;
    double rest = degrees;
    for (; rest >= 90; rest -= 90) result = Vec3(-result.y, result.x, result.z);
    for (; rest < 0; rest += 90) result = Vec3(result.y, -result.x, result.z);
    if (rest == 0) return result;
    const double c = std::cos(rest * std::numbers::pi / 180), s = std::sin(rest * std::numbers::pi / 180);
    const double x = static_cast<double>(result.x), y = static_cast<double>(result.y);
    return Vec3(static_cast<float>(c * x - s * y), static_cast<float>(s * x + c * y), v.z);
}

// Vectors of which the file does not say what they are: directions, or positions where the user says so.
void place_bare_vectors(const fs::path& path, const LightList& file, bool in_mm, const LightAxes& axes,
                        StackCalibration& read) {
    add_what_is_beside(path, read);
    for (Light& light : read.lights) light.direction = axes.applied(light.direction);
    const auto [shortest, longest] = std::minmax_element(file.lengths.begin(), file.lengths.end());
    if (in_mm) {
        for (std::size_t i = 0; i < read.lights.size(); ++i)
            read.lights[i] = near_light(read.lights[i].direction * static_cast<float>(file.lengths[i]),
                                        read.lights[i].name);
    } else if (const double rounding = rounding_of(file);
               file.decimals > 0 && std::max(*longest - 1, 1 - *shortest) < std::sqrt(3) * rounding) {
        if (const double off_deg = rounding * std::sqrt(2.0 / 3) * 180 / std::numbers::pi;
            off_deg > kCoarse_deg)
            read.warnings.push_back(
                fmt::format("{}: its directions are rounded to {} decimal{}, which makes them {:.1f} degrees "
                            "wrong in the "
                            "middle, and slopes with them; list them with three decimals or more",
                            path.string(), file.decimals, file.decimals == 1 ? "" : "s", off_deg));
    } else if (*longest > kLengthsDiffer * *shortest) {
        read.warnings.push_back(fmt::format(
            "{}: its vectors have lengths from {:.4g} to {:.4g}, and are taken for directions; if they are "
            "the lights' positions in mm from the picture's centre, say --lights-mm",
            path.string(), *shortest, *longest));
    }
}

std::string bare_formats() {
    return extensions_in_words([](const LightsFormat& format) { return format.bare_vectors; });
}

[[noreturn]] void refuse_lights_in_mm(const fs::path& path) {
    fail("{}: --lights-mm is about the vectors of an {}; this file says itself what its lights are",
         path.string(), bare_formats());
}

[[noreturn]] void refuse_axes(const fs::path& path) {
    fail(
        "{}: --light-axes and --light-rotation-deg are about the vectors of an {}; in this file x points "
        "right "
        "and y up",
        path.string(), bare_formats());
}

// Of a lights file of any format but capture.json.
StackCalibration lights_of(const fs::path& path, bool in_mm, const LightAxes& axes) {
    const LightsFormat& format = lights_format_of(path);
    if (in_mm && !format.bare_vectors) refuse_lights_in_mm(path);
    if (axes.differ() && !format.bare_vectors) refuse_axes(path);
    LightList file = format.read(path);
    StackCalibration read;
    read.lights_path = path;
    read.lights = std::move(file.lights);
    read.warnings = std::move(file.warnings);
    read.rejected = std::move(file.rejected);
    read.picture_width_mm = file.picture_width_mm;
    read.capture = std::move(file.capture);
    if (format.bare_vectors) place_bare_vectors(path, file, in_mm, axes, read);
    if (read.capture) read.capture->lights = read.lights, read.capture_path = path;
    return read;
}

// Positions of one file have no place in the frame of another.
std::vector<Light> directions_of(const std::vector<Light>& lights) {
    std::vector<Light> result;
    for (const Light& light : lights) result.push_back(distant_light(light.direction, light.name));
    return result;
}

// Vectors of length 1 are no positions: a light 1 mm before the painting's middle is none.
bool are_directions(const std::vector<Light>& lights) {
    return std::all_of(lights.begin(), lights.end(), [](const Light& light) {
        return light.position_mm && std::abs(glm::length(*light.position_mm) - 1) < 0.02f;
    });
}

}  // namespace

std::string joined(const std::vector<std::string>& names, std::size_t most) {
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i ? ", " : "") + names[i];
    if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
    return text;
}

Vec3 LightAxes::applied(Vec3 listed) const {
    if (exchanged) std::swap(listed.x, listed.y);
    if (flip_x) listed.x *= -1;
    if (flip_y) listed.y *= -1;
    return rotation_deg != 0 ? turned(listed, rotation_deg) : listed;
}

std::optional<LightAxes> light_axes_of(std::string_view text) {
    for (const bool exchanged : {false, true})
        for (const bool flip_x : {false, true})
            for (const bool flip_y : {false, true})
                if (const LightAxes axes{exchanged, flip_x, flip_y}; text == in_words(axes)) return axes;
    return std::nullopt;
}

std::string in_words(const LightAxes& axes) {
    return fmt::format("{}{},{}{},z", axes.flip_x ? "-" : "", axes.exchanged ? "y" : "x",
                       axes.flip_y ? "-" : "", axes.exchanged ? "x" : "y");
}

namespace {

// Positions in mm must be that, and need to know how large a pixel is.
void require_positions(const fs::path& folder, const StackCalibration& read,
                       const std::optional<CaptureFile>& capture) {
    if (are_directions(read.lights))
        fail("{}: its vectors are all of length 1: directions, not positions in mm; leave out --lights-mm",
             read.lights_path.string());
    if (!(capture && capture->mm_per_pixel))
        fail(
            "{}: positions in mm need to know how large a pixel is; measure it (tangipaint calibrate {} "
            "--out scale.json --no-spheres --ppi …, --scale-bar, --marker-mm or --corners) and give "
            "--capture "
            "scale.json",
            read.lights_path.string(), folder.string());
}

// A lights file, with what a capture file beside it says of all but the lights.
StackCalibration read_beside(const fs::path& folder, const fs::path& lights_path, const StackOptions& options,
                             const LightAxes& axes, std::optional<CaptureFile> capture) {
    StackCalibration read = lights_of(lights_path, options.lights_in_mm, axes);
    if (options.lights_in_mm) require_positions(folder, read, capture);
    if (!capture) return read;
    if (!options.lights_in_mm) read.lights = directions_of(read.lights);
    capture->lights = read.lights;
    read.warnings.insert(read.warnings.end(), capture->warnings.begin(), capture->warnings.end());
    for (const std::string& reason : capture->poor)  // of the file beside the lights, or of another one
        if (std::find(read.poor.begin(), read.poor.end(), reason) == read.poor.end())
            read.poor.push_back(reason);
    read.capture = std::move(capture);
    read.capture_path = *options.capture_file;
    read.picture_width_mm.reset();
    return read;
}

// A capture file that has the lights, too.
StackCalibration read_capture(const fs::path& path, const StackOptions& options, const LightAxes& axes,
                              std::optional<CaptureFile> capture) {
    if (options.lights_in_mm) refuse_lights_in_mm(path);
    if (axes.differ()) refuse_axes(path);
    if (capture && path != *options.capture_file)
        fail("{} and {}: give one capture file, and a lights file (.lp) beside it", path.string(),
             options.capture_file->string());
    if (!capture) capture = read_capture_file(path);
    if (capture->lights.empty())
        fail("{0}: holds no light; give a lights file beside it: --lights FILE.lp --capture {0}",
             path.string());
    StackCalibration read;
    read.lights = capture->lights;
    read.lights_path = path;
    read.direction_sigma_deg = capture->direction_sigma_deg;
    read.warnings = capture->warnings;
    read.poor = capture->poor;
    read.capture_path = path;
    read.capture = std::move(capture);
    return read;
}

}  // namespace

StackCalibration read_stack_calibration(const fs::path& folder, const StackOptions& options,
                                        const LightAxes& axes) {
    std::optional<CaptureFile> capture;
    if (options.capture_file) capture = read_capture_file(*options.capture_file);
    fs::path lights_path;
    if (options.lights_file)
        lights_path = *options.lights_file;
    else
        lights_path = capture && !capture->lights.empty() ? *options.capture_file : find_lights_file(folder);
    if (!lights_format_of(lights_path).is_capture)
        return read_beside(folder, lights_path, options, axes, std::move(capture));
    return read_capture(lights_path, options, axes, std::move(capture));
}

void apply_geometry(Stack& stack, StackCalibration& calibration) {
    if (!calibration.capture) return;
    CaptureFile& capture = *calibration.capture;
    const Region whole = stack.crop;
    if (capture.width == 0) {
        capture.width = whole.width(), capture.height = whole.height();
        capture.origin_px = {(whole.width() - 1) / 2.0, (whole.height() - 1) / 2.0};
        if (calibration.picture_width_mm)
            capture.mm_per_pixel = *calibration.picture_width_mm / whole.width();
    }
    if (capture.width != whole.width() || capture.height != whole.height())
        fail("{}: was made from photographs of {} x {}, those of {} are {} x {}",
             calibration.capture_path.string(), capture.width, capture.height, stack.folder.string(),
             whole.width(), whole.height());
    if (!capture.geometry) return;
    stack.geometry = capture.geometry;
    stack.crop = {0, 0, capture.geometry->width, capture.geometry->height};
}

void apply_calibration(Stack& stack, const StackCalibration& calibration) {
    if (!calibration.direction_sigma_deg.empty())
        for (StackPhoto& photo : stack.photos)
            photo.direction_sigma_deg =
                calibration.direction_sigma_deg[static_cast<std::size_t>(photo.number)];
    if (!calibration.capture) return;
    apply_lights(stack, *calibration.capture);
    if (calibration.capture->colour)
        apply_colour(stack, *calibration.capture->colour, calibration.capture_path);
}

}  // namespace tangi
