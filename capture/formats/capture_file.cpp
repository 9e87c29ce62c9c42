#include "capture/formats/capture_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "capture/formats/json_field.h"
#include "capture/formats/lights_file.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/median.h"
#include "surface/base/renamed_keys.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr const char* kFormat = "tangipaint capture 1";
constexpr std::string_view kAnyFormat = "tangipaint capture ";

glm::dvec3 vector_in(const JsonField& field, double size) {
    const std::vector<JsonField> n = field.list();
    if (n.size() != 3) fail("{}: {} has {} numbers, not 3", field.file(), field.path(), n.size());
    return {n[0].number(-size, size), n[1].number(-size, size), n[2].number(-size, size)};
}

glm::dmat3 mat3(const JsonField& field, double size) {  // a list of rows
    const std::vector<JsonField> rows = field.list();
    if (rows.size() != 3) fail("{}: {} has {} rows, not 3", field.file(), field.path(), rows.size());
    return glm::transpose(
        glm::dmat3(vector_in(rows[0], size), vector_in(rows[1], size), vector_in(rows[2], size)));
}

constexpr double kFarthest_mm = 1e6;        // 1 km
constexpr std::size_t kMostOfReason = 500;  // [bytes] why it is poor; calibrate writes 200

std::optional<Light> light_of(const JsonField& entry, const std::string& file) {
    if (entry["direction"].is_null()) return {};  // left out
    const std::string name = entry["name"].text();
    if (!entry["position_mm"].is_null()) {
        const Vec3 position = Vec3(vector_in(entry["position_mm"], kFarthest_mm));
        if (!(position.z > 0))
            fail("{}: the light of {} is at z = {} mm, below the painting", file, name, position.z);
        return near_light(position, name);
    }
    const Vec3 direction = Vec3(vector_in(entry["direction"], 2));
    if (!(glm::length(direction) > 0.5f)) fail("{}: the direction of {} is no unit vector", file, name);
    return distant_light(direction, name);
}

// Positions of all lights, or of none.
void complete_positions(CaptureFile& capture, const std::string& file) {
    std::vector<float> distances;
    for (const Light& light : capture.lights)
        if (light.position_mm) distances.push_back(glm::length(*light.position_mm));
    if (distances.empty() || distances.size() == capture.lights.size()) return;
    const float middle = median(distances);
    std::string names;
    for (Light& light : capture.lights)
        if (!light.position_mm) {
            light.position_mm = light.direction * middle;
            names += (names.empty() ? "" : ", ") + light.name;
        }
    capture.warnings.push_back(
        fmt::format("{}: only the direction is known of the lights of {}; they are taken to be {:.0f} mm "
                    "away, as the others",
                    file, names, middle));
}

// White balance and matrix of the chart; with the reading's own words for what was not solved.
CaptureColour colour_of(const JsonField& colour, const std::string& file) {
    CaptureColour result;
    const JsonField correction = colour["correction"];
    const glm::dvec3 balance = vector_in(correction["white_balance"], 1e3);
    if (!(std::min({balance.r, balance.g, balance.b}) > 1e-3))
        fail("{}: colour.correction.white_balance is not positive", file);
    const glm::dmat3 matrix = mat3(correction["matrix"], 1e3);
    const glm::dmat3 total = matrix * glm::dmat3(balance.r, 0, 0, 0, balance.g, 0, 0, 0, balance.b);
    if (!(std::abs(glm::determinant(total)) > 1e-6))
        fail("{}: colour.correction.matrix has no inverse", file);
    result.to_camera = glm::inverse(total);
    const glm::dvec3 light = result.light();
    if (!(std::min({light.r, light.g, light.b}) > 0))
        fail("{}: by colour.correction, white would be dark in a channel", file);
    const std::string name = colour["transfer"]["name"].text();
    const std::optional<Transfer> transfer = transfer_named(name);
    if (!transfer)
        fail("{}: colour.transfer.name is '{}', which is no transfer curve", file, shortened(name));
    result.transfer = *transfer;
    if (colour.has("raw_colour")) result.raw_rec709 = colour["raw_colour"].text() == "rec709";
    if (colour["chart"].has("chart_to_picture") && correction.has("patches")) {
        CaptureColour::Chart chart{mat3(colour["chart"]["chart_to_picture"], 1e9), {}};
        const std::vector<JsonField> patches = correction["patches"].list();
        if (patches.size() != chart.reference.size())
            fail("{}: colour.correction.patches has {} entries, not 24", file, patches.size());
        bool known = true;  // files of version 0.1 do not say
        for (std::size_t n = 0; n < patches.size() && known; ++n) {
            known = patches[n].has("reference");
            if (known) chart.reference[n] = Rgb(vector_in(patches[n]["reference"], 10));
        }
        if (known) result.chart = chart;
    }
    if (colour.has("white_balances"))
        for (const JsonField& photo : colour["white_balances"].list())
            result.log_gains[photo["photograph"].text()] = {std::log(photo["red"].number(1e-3, 1e3)),
                                                            std::log(photo["blue"].number(1e-3, 1e3))};
    const JsonField errors = correction["delta_e_2000"], cross_validated = errors["cross_validated"];
    if (errors.has("after")) result.misfit = errors["after"]["mean"].number(0, 1e3);
    if (!cross_validated.is_null()) result.delta_e_2000 = cross_validated["mean"].number(0, 1e3);
    return result;
}

// [deg] As the spheres tell it; 0 where no sphere does.
double direction_sigma_of(const JsonField& entry, bool by_spheres) {
    constexpr double kWorst = 90;
    return by_spheres && entry.has("direction_sigma_deg") ? entry["direction_sigma_deg"].number(0, kWorst)
                                                          : 0;
}

}  // namespace

CalibrationFiles calibration_files(const std::filesystem::path& out) {
    CalibrationFiles files{out, out, out};
    files.lights.replace_extension(".lp");
    if (lower_extension(out) != ".json") {
        files.lights = out;
        if (out.stem() == "lights") files.json = files.page = out.parent_path() / "capture";
    }
    files.json.replace_extension(".json");
    files.page.replace_extension(".html");
    return files;
}

bool is_lights_file_of(const std::filesystem::path& lights, const std::filesystem::path& capture) {
    constexpr float same = 1e-4f;
    try {
        const std::vector<Light> written = read_lights_file(lights).lights,
                                 found = read_capture_file(capture).lights;
        return std::equal(written.begin(), written.end(), found.begin(), found.end(),
                          [](const Light& a, const Light& b) {
                              return a.name == b.name && glm::length(a.direction - b.direction) < same;
                          });
    } catch (const Error&) {
        return false;  // one of them is none
    }
}

namespace {

// The whole file, with the keys of now.
json json_of_capture(const std::filesystem::path& path) {
    const std::string file = path.string();
    if (!std::filesystem::exists(path))
        fail("{}: cannot be read; give the capture.json that tangipaint calibrate wrote", file);
    const std::string text = read_text_file(path);
    if (text.empty()) fail("{}: is empty, or no file; calibrate again", file);
    json whole = with_present_keys(read_json(text, file));
    if (!whole.is_object() || !whole.contains("format") || whole["format"] != kFormat)
        fail("{}: is not a capture file of this program (format \"{}\")", file, kFormat);
    return whole;
}

// Sizes, frame and camera.
void read_camera(const JsonField& top, const std::string& file, CaptureFile& capture) {
    const JsonField photographs = top["photographs"], camera = top["camera"];
    capture.width = static_cast<int>(photographs["width"].number(1, 1e6));
    capture.height = static_cast<int>(photographs["height"].number(1, 1e6));
    const std::vector<JsonField> origin = top["frame"]["origin_px"].list();
    if (origin.size() != 2) fail("{}: frame.origin_px has {} numbers, not 2", file, origin.size());
    capture.origin_px = {origin[0].number(-1e6, 1e6), origin[1].number(-1e6, 1e6)};
    if (!camera["mm_per_pixel"].is_null()) capture.mm_per_pixel = camera["mm_per_pixel"].number(1e-6, 1e3);
    if (!camera["position_mm"].is_null())
        capture.camera_mm = Vec3(vector_in(camera["position_mm"], kFarthest_mm));
    if (capture.camera_mm && !(capture.camera_mm->z > 0))
        fail("{}: camera.position_mm is below the painting", file);
}

void read_lights(const JsonField& top, const json& whole, const std::string& file, CaptureFile& capture) {
    const std::string method = whole.contains("method") ? top["method"].text() : std::string();
    const bool by_spheres =  // "mirror balls" in version 0.1
        method.find("sphere") != std::string::npos || method.find("ball") != std::string::npos;
    for (const JsonField& entry : top["lights"].list()) {
        const auto light = light_of(entry, file);
        if (!light) continue;
        capture.lights.push_back(*light);
        capture.direction_sigma_deg.push_back(direction_sigma_of(entry, by_spheres));
    }
    complete_positions(capture, file);
}

void read_geometry(const json& whole, const std::string& file, CaptureFile& capture) {
    if (!whole.contains("geometry") || whole["geometry"].is_null()) return;  // as in files of version 0.1
    try {
        capture.geometry = geometry_from_json(whole["geometry"]);
    } catch (const std::exception& error) {
        fail("{}: geometry: {}; calibrate again", file, why_wrong_field(error));
    }
    if (capture.geometry->photo_width != capture.width || capture.geometry->photo_height != capture.height)
        fail("{}: geometry.photograph_px is not the size of its photographs", file);
}

void read_what_is_poor(const json& whole, const std::string& file, CaptureFile& capture) {
    if (const json& poor = whole.value("poor", json()); poor.is_array())
        for (const json& reason : poor)
            if (reason.is_string())
                capture.poor.push_back(fmt::format("{}: calibrate called it poor: {}", file,
                                                   shortened(reason.get<std::string>(), kMostOfReason)));
}

}  // namespace

bool looks_like_capture(const std::string& text) {
    const json whole = json_or_discarded(text);
    return whole.is_object() && whole.contains("format") && whole["format"].is_string() &&
           whole["format"].get_ref<const std::string&>().starts_with(kAnyFormat);
}

CaptureFile read_capture_file(const std::filesystem::path& path) {
    const std::string file = path.string();
    const json whole = json_of_capture(path);
    const JsonField top(file, whole, "");
    CaptureFile capture;
    read_camera(top, file, capture);
    read_lights(top, whole, file, capture);
    if (whole.contains("colour") && !whole["colour"].is_null())  // files of version 0.1 have none
        capture.colour = colour_of(top["colour"], file);
    read_geometry(whole, file, capture);
    if (capture.colour && whole.contains("development") && whole["development"].is_object())
        for (const char* what : {"dark", "flat", "ambient", "brackets"})
            if (const json& used = whole["development"].value(what, json(nullptr)); !used.empty())
                capture.colour->developed_with.emplace_back(what);
    if (whole.contains("scale") && !whole["scale"].is_null())
        capture.mm_per_pixel = top["scale"]["mm_per_pixel"].number(1e-6, 1e3);
    read_what_is_poor(whole, file, capture);
    return capture;
}

CaptureFile in_picture(const CaptureFile& capture) {
    if (!capture.geometry) return capture;
    const PictureGeometry& geometry = *capture.geometry;
    CaptureFile result = capture;
    result.width = geometry.width;
    result.height = geometry.height;
    const glm::dvec2 centre((geometry.width - 1) / 2.0, (geometry.height - 1) / 2.0);
    if (!geometry.rectification) return result;  // undistorted: the frame stays
    result.origin_px = centre;
    if (geometry.mm_per_pixel) result.mm_per_pixel = geometry.mm_per_pixel;
    result.camera_mm.reset();
    if (geometry.camera_mm) result.camera_mm = Vec3(*geometry.camera_mm);
    // Where the picture's origin lies in the photographs' frame. In perspective the camera is the same point
    // in both; seen from far away, what is above a point stays above it.
    std::optional<glm::dvec3> origin;
    if (capture.camera_mm && geometry.camera_mm) {
        origin = glm::dvec3(*capture.camera_mm) - glm::transpose(geometry.turn) * *geometry.camera_mm;
    } else if (capture.mm_per_pixel && !capture.camera_mm) {
        const glm::dvec2 away = geometry.place_in_photo(centre) - capture.origin_px;
        origin = *capture.mm_per_pixel * glm::dvec3(away.x, -away.y, 0);
    }
    for (Light& light : result.lights) {
        if (light.position_mm && origin)
            light = near_light(Vec3(geometry.turn * (glm::dvec3(*light.position_mm) - *origin)), light.name);
        else
            light = distant_light(Vec3(geometry.turn * glm::dvec3(light.direction)), light.name);
    }
    return result;
}

CaptureFile seen_from(const CaptureFile& capture, const Region& crop) {
    CaptureFile result = capture;
    const glm::dvec2 centre((crop.x0 + crop.x1 - 1) / 2.0, (crop.y0 + crop.y1 - 1) / 2.0);
    const glm::dvec2 away = centre - capture.origin_px;
    result.origin_px = centre;
    std::vector<float> distances;
    for (Light& light : result.lights) {
        if (!light.position_mm) continue;
        if (!capture.mm_per_pixel) {
            light.position_mm.reset();
            continue;
        }
        const Vec3 origin(Vec3(away.x, -away.y, 0) * static_cast<float>(*capture.mm_per_pixel));
        light.position_mm = *light.position_mm - origin;
        light.direction = glm::normalize(*light.position_mm);
        distances.push_back(glm::length(*light.position_mm));
    }
    if (capture.mm_per_pixel && capture.camera_mm)
        result.camera_mm =
            *capture.camera_mm - Vec3(away.x, -away.y, 0) * static_cast<float>(*capture.mm_per_pixel);
    const float middle = median(distances);
    for (Light& light : result.lights)
        if (light.position_mm) {
            const float nearer = middle / glm::length(*light.position_mm);
            light.gain = Rgb(nearer * nearer);
        }
    return result;
}

}  // namespace tangi
