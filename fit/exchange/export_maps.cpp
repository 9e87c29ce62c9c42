#include "fit/exchange/export_maps.h"

#include <cmath>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>

#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"
#include "surface/image_file/image_io.h"
#include "surface/maps/height_unit.h"
#include "surface/maps/photography_json.h"
#include "surface/reflectance/anisotropy.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr float kLeastAlpha = 0.01f, kMostAlpha = 1.0f;

// A float as the shortest number that is this float.
double shortest(float value) { return std::stod(fmt::format("{}", value)); }

// How bright the painting was taken and from where; the photographs themselves are not in the maps.
Photography exposure_and_camera(const Photography& p) {
    Photography kept;
    kept.transfer = p.transfer;
    kept.white_level = p.white_level;
    kept.rig = p.rig;
    kept.to_camera = p.to_camera;
    return kept;
}

class Writer {
public:
    Writer(const fs::path& folder, int files, const Progress& progress)
        : folder_(folder), files_(files), progress_(progress) {
        make_folder(folder);
    }
    template <class Write>
    void operator()(const std::string& name, Write&& write) {
        write(folder_ / name);
        paths.push_back(folder_ / name);
        report(progress_, "write maps", static_cast<double>(paths.size()) / files_);
    }
    std::vector<fs::path> paths;

private:
    fs::path folder_;
    int files_;
    const Progress& progress_;
};

}  // namespace

nlohmann::json about_maps(const Surface& s) {
    return {{"software", program_name()},
            {"width", s.width()},
            {"height", s.height()},
            {"mm_per_pixel", s.mm_per_pixel},
            {"scale_known", s.scale_known},
            {"height_unit", height_unit_of(s.mm_per_pixel, s.scale_known)},
            {"diffuse_roughness", s.reflectance_model.diffuse_roughness},
            {"second_lobe_weight", s.reflectance_model.second_lobe_weight},
            {"photography", to_json(exposure_and_camera(s.photography))}};
}

std::vector<fs::path> write_maps(const fs::path& folder, const Surface& s, const Progress& progress) {
    Writer write(folder, 7 + (s.specular_colour.empty() ? 0 : 1) + (s.lobe_axes.empty() ? 0 : 2), progress);
    write("height.exr", [&](const fs::path& path) { write_map(path, s.height_mm); });
    write("normal.exr", [&](const fs::path& path) { write_map(path, s.normal); });
    write("diffuse.exr", [&](const fs::path& path) { write_picture(path, s.diffuse, Transfer{}); });
    write("specular.exr", [&](const fs::path& path) { write_map(path, s.specular); });
    write("roughness.exr", [&](const fs::path& path) { write_map(path, s.roughness); });
    write("confidence.exr", [&](const fs::path& path) { write_map(path, s.confidence); });
    if (!s.specular_colour.empty())
        write("lobe.exr", [&](const fs::path& path) { write_picture(path, s.specular_colour, Transfer{}); });
    if (!s.lobe_axes.empty()) {
        const auto [across, tangent] = axes_maps(s.lobe_axes);
        write("roughness_v.exr", [&, map = &across](const fs::path& path) { write_map(path, *map); });
        write("tangent.exr", [&, map = &tangent](const fs::path& path) { write_map(path, *map); });
    }
    write("maps.json", [&](const fs::path& path) { write_text_file(path, json_lines(about_maps(s))); });
    return write.paths;
}

std::vector<fs::path> write_openlime(const fs::path& folder, const Surface& s, const Progress& progress) {
    const PictureStorage storage{.bits = 8};
    float least = kMostAlpha, most = kLeastAlpha;
    long clamped = 0;
    for (std::size_t i = 0; i < s.roughness.size(); ++i) {
        const float alpha = s.roughness.pixels()[i];
        const Rgb& kd = s.diffuse.pixels()[i];
        clamped += alpha < kLeastAlpha || alpha > kMostAlpha || std::max({kd.r, kd.g, kd.b}) > 1 ||
                   s.specular.pixels()[i] > 1;
        if (!(s.confidence.pixels()[i] > 0)) continue;
        least = std::min(least, std::max(alpha, kLeastAlpha));
        most = std::max(most, std::min(alpha, kMostAlpha));
    }
    if (!(most - least > 1e-3f)) least = std::max(most / 2, kLeastAlpha / 2);
    Writer write(folder, 5, progress);
    write("kd.png",
          [&](const fs::path& path) { write_picture(path, s.diffuse, {Transfer::Kind::srgb}, storage); });
    write("ks.png", [&](const fs::path& path) {
        if (s.specular_colour.empty()) return write_map(path, s.specular, storage);
        Image<Rgb> ks = s.specular_colour;
        for (std::size_t i = 0; i < ks.size(); ++i) ks.pixels()[i] *= s.specular.pixels()[i];
        write_map(path, ks, storage);
    });
    write("normals.png", [&](const fs::path& path) {
        Image<Rgb> encoded = s.normal;
        for (std::size_t i = 0; i < encoded.size(); ++i)  // one that was not measured is shown as a hole
            encoded.pixels()[i] =
                s.confidence.pixels()[i] > 0 ? (encoded.pixels()[i] + 1.0f) / 2.0f : Rgb(0.5f);
        write_map(path, encoded, storage);
    });
    write("gloss.png", [&](const fs::path& path) {
        const float m = 1 - std::pow(most, 0.25f), high = 1 - std::pow(least, 0.25f);
        Image<float> gloss = s.roughness;
        for (float& value : gloss.pixels())
            value = (1 - m - std::pow(std::clamp(value, least, most), 0.25f)) / (high - m);
        write_map(path, gloss, storage);
    });
    const nlohmann::json brdf = {
        {"channels",
         {{"kd", "kd.png"}, {"ks", "ks.png"}, {"normals", "normals.png"}, {"gloss", "gloss.png"}}},
        {"colorspaces", {{"kd", "srgb"}, {"ks", "linear"}}},
        {"alphaLimits", {shortest(least), shortest(most)}},
        {"mm_per_pixel", s.mm_per_pixel},
        {"scale_known", s.scale_known},
        {"clamped_pixels", clamped},
        {"software", program_name()}};
    write("brdf.json", [&](const fs::path& path) { write_text_file(path, json_lines(brdf)); });
    return write.paths;
}

}  // namespace tangi
