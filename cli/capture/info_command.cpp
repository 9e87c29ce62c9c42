// info_command.cpp: tangipaint info FILE: what a painting file, a photograph or a lights file holds.
#include <algorithm>
#include <filesystem>

#include "capture/formats/lights_format.h"
#include "capture/photo/photo_file.h"
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "fit/exchange/ptm_rti_file.h"
#include "fit/pixel/fit_errors.h"
#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "paint/session/session.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/height_unit.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Smallest, median and largest of the measured values of a map.
template <class Value>
nlohmann::json spread(const Surface& s, const Value& value) {
    std::vector<float> values;
    const std::size_t step = std::max<std::size_t>(1, s.height_mm.size() / 1000000);
    for (std::size_t i = 0; i < s.height_mm.size(); i += step)
        if (s.confidence.pixels()[i] > 0) values.push_back(value(i));
    if (values.empty()) return nullptr;
    std::sort(values.begin(), values.end());
    return {{"minimum", values.front()}, {"median", values[values.size() / 2]}, {"maximum", values.back()}};
}

// [1] 0: white .. 1: a channel is missing.
float saturation(const Rgb& colour) { return 1 - std::min({colour.r, colour.g, colour.b}); }

// Heights are counted in `unit` (height_unit.h) of `in_unit`, as the file has them.
struct HeightUnit {
    std::string_view unit;
    float in_unit;
    std::string key() const { return unit == "mm" ? "height_mm" : "height_px"; }
};

HeightUnit heights_of(const Canvas& canvas) {
    return {height_unit_of(canvas.mm_per_pixel(), canvas.scale_known()),
            static_cast<float>(canvas.height_unit_mm())};
}

nlohmann::json describe(const Surface& s, const HeightUnit& height) {
    const Photography& p = s.photography;
    const auto fitted =
        std::count_if(p.photos.begin(), p.photos.end(), [](const auto& photo) { return photo.fitted; });
    const auto measured = std::count_if(s.confidence.pixels().begin(), s.confidence.pixels().end(),
                                        [](float c) { return c > 0; });
    nlohmann::json provenance = json_or_discarded(s.provenance);
    if (provenance.is_discarded()) provenance = s.provenance;
    return {
        {"kind", "painting"},
        {"width", s.width()},
        {"height", s.height()},
        {"mm_per_pixel", s.mm_per_pixel},
        {"scale_known", s.scale_known},
        {"diffuse_roughness", s.reflectance_model.diffuse_roughness},
        {"second_lobe_weight", s.reflectance_model.second_lobe_weight},
        {"specular_colour", !s.specular_colour.empty()},
        {"anisotropic_specular", !s.lobe_axes.empty()},
        {"measured_pixels", measured},
        {"maps",
         {{height.key(), spread(s, [&](std::size_t i) { return height.in_unit * s.height_mm.pixels()[i]; })},
          {"diffuse_luminance", spread(s, [&](std::size_t i) { return luminance(s.diffuse.pixels()[i]); })},
          {"specular", spread(s, [&](std::size_t i) { return s.specular.pixels()[i]; })},
          {"roughness", spread(s, [&](std::size_t i) { return s.roughness.pixels()[i]; })},
          {"lobe_saturation",
           s.specular_colour.empty()
               ? nlohmann::json(nullptr)
               : spread(s, [&](std::size_t i) { return saturation(s.specular_colour.pixels()[i]); })},
          {"roughness_v",
           s.lobe_axes.empty()
               ? nlohmann::json(nullptr)
               : spread(s, [&](std::size_t i) { return s.lobe_axes.pixels()[i].roughness_v; })},
          {"confidence", spread(s, [&](std::size_t i) { return s.confidence.pixels()[i]; })}}},
        {"photographs",
         {{"transfer", p.transfer.name()},
          {"white_level", p.white_level},
          {"fitted", fitted},
          {"held_out", static_cast<long>(p.photos.size()) - fitted}}},
        {"dry_hash", hash_of(s)},
        {"provenance", provenance}};
}

// Wet paint and dried layers, from the bottom up: how much of what they hold.
nlohmann::json describe_paint(const Canvas& canvas) {
    const auto layer = [&](const std::string& name, const PaintLayer& paint) {
        const auto mm3 = volumes_mm3(paint, canvas.ingredients().size(), canvas.mm_per_pixel());
        return nlohmann::json{{"layer", name}, {"volumes_mm3", volumes_by_name(canvas.ingredients(), mm3)}};
    };
    nlohmann::json layers = nlohmann::json::array();
    for (const DriedLayer& dried : canvas.dried()) layers.push_back(layer(dried.name, dried.paint));
    if (!canvas.wet().empty()) layers.push_back(layer("wet", canvas.wet()));
    return layers;
}

// Standard errors, as the fit stated them.
nlohmann::json describe(const FitErrors& errors, const Surface& s, const HeightUnit& height) {
    const auto of = [&](const Image<HalfError>& map) {
        return spread(s, [&](std::size_t i) { return float(map.pixels()[i]); });
    };
    return {{height.key(),
             spread(s, [&](std::size_t i) { return height.in_unit * float(errors.height.pixels()[i]); })},
            {"slope", of(errors.slope)},
            {"diffuse", of(errors.diffuse)},
            {"specular", of(errors.specular)},
            {"roughness", of(errors.roughness)}};
}

nlohmann::json describe(const Session& session) {
    const Canvas& canvas = session.canvas();
    const HeightUnit height = heights_of(canvas);
    nlohmann::json json = describe(canvas.dry(), height);
    json["mm_per_pixel"] = canvas.mm_per_pixel();
    json["scale_known"] = canvas.scale_known();
    json["scale_from"] = canvas.dry().scale_known     ? "painting"
                         : canvas.scale_known()       ? "given to paint with"
                         : canvas.mm_per_pixel() == 1 ? "nothing"
                                                      : "assumed";
    json["height_unit"] = height.unit;
    json["paint"] = describe_paint(canvas);
    json["palette"] = json["brush"] = nullptr;
    if (const Canvas* board = session.board())
        json["palette"] = {{"width_mm", board->width() * board->mm_per_pixel()},
                           {"height_mm", board->height() * board->mm_per_pixel()},
                           {"volumes_mm3", volumes_by_name(board->ingredients(), board->volumes_mm3())}};
    if (const Brush* brush = session.brush()) {
        const bool on_palette = session.brush_place() == Place::palette;
        const auto& paints = (on_palette ? *session.board() : canvas).ingredients();
        json["brush"] = {{"shape", traits_of(brush->settings().shape).name},
                         {"size_mm", brush->settings().size_mm},
                         {"used_on", on_palette ? "palette" : "painting"},
                         {"volumes_mm3", volumes_by_name(paints, brush->volumes_mm3(paints.size()))}};
    }
    return json;
}

nlohmann::json describe_lights(const fs::path& path) {
    const LightList file = read_lights(path);
    nlohmann::json lights = nlohmann::json::array();
    for (const Light& light : file.lights) {
        const Vec3& d = light.direction;
        lights.push_back({{"name", light.name},
                          {"direction", {d.x, d.y, d.z}},
                          {"elevation_deg", std::asin(std::clamp(d.z, -1.0f, 1.0f)) * 180 / M_PI},
                          {"azimuth_deg", std::atan2(d.y, d.x) * 180 / M_PI}});
    }
    return {{"kind", "lights"}, {"lights", lights}, {"warnings", told(file.warnings)}};
}

nlohmann::json describe_rti(const fs::path& path) {
    const RtiImage image = read_rti_file(path);
    return {
        {"kind", "rti"},          {"for", "RTI viewers; made by export"}, {"width", image.width},
        {"height", image.height}, {"basis", name_of(image.basis)},        {"terms", terms_of(image.basis)},
        {"lrgb", image.lrgb}};
}

nlohmann::json run_info(const std::string& file) {
    const fs::path path(file);
    if (!fs::exists(path)) fail("{}: no such file", file);
    if (fs::is_directory(path))
        fail("{}: is a folder; name a painting (.exr), a lights file ({}) or a photograph", file,
             extensions_in_words());
    if (!fs::is_regular_file(path)) fail("{}: is a pipe or a device, not a file", file);
    const std::string extension = lower_extension(path);
    if (extension == ".ptm" || extension == ".rti") return describe_rti(path);
    if (is_lights_file(path)) return describe_lights(path);
    if (extension == ".exr" && is_painting(path)) {
        const Progress progress = console_progress();
        Session session(read_canvas(path, progress), artist_acrylics());
        read_tools(path, session, progress);
        const Canvas& canvas = session.canvas();
        nlohmann::json json = describe(session);
        json["standard_errors"] = has_errors(path)
                                      ? describe(read_errors(path), canvas.dry(), heights_of(canvas))
                                      : nlohmann::json(nullptr);
        return json;
    }
    if (extension == ".exr") painting_parts(path);  // says what is wrong with one that is damaged
    const PhotoHeader header = PhotoFile(path).header();
    return {{"kind", "picture"},
            {"width", header.width},
            {"height", header.height},
            {"channels", header.channels},
            {"bits", header.bits},
            {"float", header.is_float},
            {"orientation", header.orientation},
            {"doubts", header.doubts}};
}

}  // namespace

Command info_command() {
    return {"info", "say what a painting, lights file or photograph holds", [](Flags& flags) {
                auto file = std::make_shared<std::string>();
                flags
                    .option(
                        "FILE", *file,
                        fmt::format("painting (.exr), lights file ({}), RTI file (.ptm, .rti) or photograph",
                                    extensions_in_words()))
                    .required();
                return [file] { return run_info(*file); };
            }};
}

}  // namespace tangi
