// info_command.cpp: tangipaint info FILE: what a painting file, a photograph or a lights file holds.
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

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
#include "surface/painting_file/painting_reader.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// Smallest, median and largest of some values.
nlohmann::json spread(std::vector<float> values) {
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

// Measured values of a painting's maps, by their names in the result: of large ones a million of each.
struct MapValues {
    std::map<std::string, std::vector<float>> maps, errors;
    long measured = 0;
};

void add_values(const Surface& s, std::size_t i, const HeightUnit& height, MapValues& values) {
    const auto add = [&](const char* name, float value) { values.maps[name].push_back(value); };
    add(height.key().c_str(), height.in_unit * s.height_mm.pixels()[i]);
    add("diffuse_luminance", luminance(s.diffuse.pixels()[i]));
    add("specular", s.specular.pixels()[i]);
    add("roughness", s.roughness.pixels()[i]);
    add("confidence", s.confidence.pixels()[i]);
    if (!s.specular_colour.empty()) add("lobe_saturation", saturation(s.specular_colour.pixels()[i]));
    if (!s.lobe_axes.empty()) add("roughness_v", s.lobe_axes.pixels()[i].roughness_v);
}

// Block by block, so that no more than one is in memory.
MapValues values_of(const PaintingReader& painting, const HeightUnit& height, const Progress& progress) {
    MapValues values;
    const auto width = static_cast<std::size_t>(painting.width());
    const std::size_t step =
        std::max<std::size_t>(1, width * static_cast<std::size_t>(painting.height()) / 1000000);
    const std::optional<PartInfo> errors = errors_part(painting.header().parts);
    const std::vector<Region> blocks = painting.blocks();
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        report(progress, "read painting", static_cast<double>(b) / static_cast<double>(blocks.size()));
        const Surface s = painting.read(blocks[b]);
        const std::vector<Image<float>> planes =
            errors ? painting.read_part(*errors, blocks[b]) : std::vector<Image<float>>();
        for (int y = 0; y < s.height(); ++y)
            for (int x = 0; x < s.width(); ++x) {
                if (!(s.confidence(x, y) > 0)) continue;
                ++values.measured;
                const std::size_t number = static_cast<std::size_t>(blocks[b].y0 + y) * width +
                                           static_cast<std::size_t>(blocks[b].x0 + x);
                if (number % step != 0) continue;
                add_values(s, static_cast<std::size_t>(y * s.width() + x), height, values);
                for (std::size_t c = 0; c < planes.size(); ++c) {
                    const std::string& name = errors->channels[c];
                    const float value = HalfError(planes[c](x, y));
                    values.errors[name == "height" ? height.key() : name].push_back(
                        name == "height" ? height.in_unit * value : value);
                }
            }
    }
    return values;
}

nlohmann::json spreads(std::map<std::string, std::vector<float>>& maps,
                       const std::vector<std::string>& names) {
    nlohmann::json result = nlohmann::json::object();
    for (const std::string& name : names) result[name] = spread(std::move(maps[name]));
    return result;
}

nlohmann::json describe(const PaintingReader& painting, const HeightUnit& height, const Progress& progress) {
    const PaintingHeader& s = painting.header();
    const Photography& p = s.photography;
    const auto fitted =
        std::count_if(p.photos.begin(), p.photos.end(), [](const auto& photo) { return photo.fitted; });
    MapValues values = values_of(painting, height, progress);
    nlohmann::json provenance = json_or_discarded(s.provenance);
    if (provenance.is_discarded()) provenance = s.provenance;
    return {{"kind", "painting"},
            {"width", s.width},
            {"height", s.height},
            {"mm_per_pixel", s.mm_per_pixel},
            {"scale_known", s.scale_known},
            {"diffuse_roughness", s.reflectance_model.diffuse_roughness},
            {"second_lobe_weight", s.reflectance_model.second_lobe_weight},
            {"specular_colour", s.has_specular_colour},
            {"anisotropic_specular", s.has_lobe_axes},
            {"measured_pixels", values.measured},
            {"maps", spreads(values.maps, {height.key(), "diffuse_luminance", "specular", "roughness",
                                           "lobe_saturation", "roughness_v", "confidence"})},
            {"standard_errors",
             values.errors.empty()
                 ? nlohmann::json(nullptr)
                 : spreads(values.errors, {height.key(), "slope", "diffuse", "specular", "roughness"})},
            {"photographs",
             {{"transfer", p.transfer.name()},
              {"white_level", p.white_level},
              {"fitted", fitted},
              {"held_out", static_cast<long>(p.photos.size()) - fitted}}},
            {"dry_hash", s.dry_hash},
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

// What it is painted with, and in which scale.
void describe_painted(const Session& session, nlohmann::json& json) {
    const Canvas& canvas = session.canvas();
    json["mm_per_pixel"] = canvas.mm_per_pixel();
    json["scale_known"] = canvas.scale_known();
    if (!canvas.dry().scale_known && canvas.scale_known()) json["scale_from"] = "given to paint with";
    json["paint"] = describe_paint(canvas);
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
}

nlohmann::json describe_painting(const fs::path& path) {
    const Progress progress = console_progress();
    const auto painting = open_painting(path);
    const PaintingHeader& header = painting->header();
    std::optional<Session> session;
    HeightUnit height{height_unit_of(header.mm_per_pixel, header.scale_known), 1};
    if (has_paint_or_tools(header)) {
        session.emplace(read_canvas(path, progress), artist_acrylics());
        read_tools(path, *session, progress);
        const Canvas& canvas = session->canvas();
        height = {height_unit_of(canvas.mm_per_pixel(), canvas.scale_known()),
                  static_cast<float>(canvas.height_unit_mm())};
    }
    nlohmann::json json = describe(*painting, height, progress);
    json["height_unit"] = height.unit;
    json["scale_from"] = header.scale_known ? "painting" : header.mm_per_pixel == 1 ? "nothing" : "assumed";
    json["paint"] = nlohmann::json::array();
    json["palette"] = json["brush"] = nullptr;
    if (session) describe_painted(*session, json);
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
    if (is_tiled_painting(path)) return describe_painting(path);
    if (!fs::exists(path)) fail("{}: no such file", file);
    if (fs::is_directory(path))
        fail("{}: is a folder; name a painting (.exr, .tangi), a lights file ({}) or a photograph", file,
             extensions_in_words());
    if (!fs::is_regular_file(path)) fail("{}: is a pipe or a device, not a file", file);
    const std::string extension = lower_extension(path);
    if (extension == ".ptm" || extension == ".rti") return describe_rti(path);
    if (is_lights_file(path)) return describe_lights(path);
    if (extension == ".exr" && is_painting(path)) return describe_painting(path);
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
                        fmt::format(
                            "painting (.exr, .tangi), lights file ({}), RTI file (.ptm, .rti) or photograph",
                            extensions_in_words()))
                    .required();
                return [file] { return run_info(*file); };
            }};
}

}  // namespace tangi
