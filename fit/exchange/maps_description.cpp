// maps_description.cpp: what the maps.json or brdf.json of a folder says of its maps (import_maps.h).
#include <nlohmann/json.hpp>

#include "fit/exchange/import_maps.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/renamed_keys.h"
#include "surface/file/atomic_file.h"
#include "surface/maps/photography_json.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

// What is told of maps beside them. Throws Error where that cannot be read.
nlohmann::json told_in(const fs::path& path) {
    nlohmann::json about = read_json(read_text_file(path), path.string());
    return about.is_object() ? about : nlohmann::json::object();
}

// A number within these limits; none where nothing is said.
std::optional<double> number_in(const fs::path& path, const std::string& name, const nlohmann::json& value,
                                double least, double most) {
    if (value.is_null()) return {};
    if (!value.is_number() || !(value.get<double>() >= least && value.get<double>() <= most))
        fail("{}: {} = {} is no number from {} to {}; mend it, or take it away", path.string(), name,
             shown(value), least, most);
    return value.get<double>();
}

void take_scale(const fs::path& path, const nlohmann::json& about, ImportOptions& options) {
    if (options.mm_per_pixel) return;
    options.mm_per_pixel =
        number_in(path, "mm_per_pixel", about.value("mm_per_pixel", nlohmann::json()), 1e-6, 1e3);
    options.scale_known = about.value("scale_known", nlohmann::json(true)) == true;
}

// What a layer of OpenLIME has to be told beside its maps.
ImportOptions as_openlime_is_told(const fs::path& path, ImportOptions options) {
    if (!fs::is_regular_file(path)) return options;
    const nlohmann::json about = told_in(path);
    take_scale(path, about, options);
    const nlohmann::json spaces = about.value("colorspaces", nlohmann::json());
    if (spaces.is_object() && spaces.contains("kd") && !options.diffuse_srgb)
        options.diffuse_srgb = spaces["kd"] != "linear";  // as OpenLIME reads it
    const nlohmann::json limits = about.value("alphaLimits", nlohmann::json());
    if (!limits.is_null() && !options.alpha_min && !options.alpha_max) {
        const bool two = limits.is_array() && limits.size() == 2;
        const auto limit = [&](int i) {
            return two ? number_in(path, fmt::format("alphaLimits[{}]", i), limits[i], 1e-3, 1)
                       : std::optional<double>();
        };
        options.alpha_min = limit(0);
        options.alpha_max = limit(1);
        if (!options.alpha_min || !options.alpha_max || !(*options.alpha_min < *options.alpha_max))
            fail(
                "{}: alphaLimits are to be two numbers, the least alpha and the greatest; mend them, or give "
                "--alpha-min and --alpha-max",
                path.string());
    }
    return options;
}

// How maps of whole numbers were written: the others as every program has them, 0 to 1 and n = 2 c - 1.
void take_whole_numbers(const fs::path& path, const nlohmann::json& maps, ImportOptions& options) {
    const auto field = [&](const char* map, const char* name) {
        const nlohmann::json one = maps.is_object() ? maps.value(map, nlohmann::json()) : nlohmann::json();
        return one.is_object() ? one.value(name, nlohmann::json()) : nlohmann::json();
    };
    if (const nlohmann::json encoding = field("diffuse", "encoding");
        !encoding.is_null() && !options.diffuse_srgb)
        options.diffuse_srgb = encoding == "srgb";
    const auto height = [&](const char* end) {
        return number_in(path, fmt::format("maps.height.{}", end), field("height", end), -1e4, 1e4);
    };
    const auto from = height("from"), to = height("to");
    if (!from || !to || options.height_range_mm) return;
    if (!(*from < *to))
        fail("{}: maps.height.from = {} is not below to = {}; mend it, or give --height-range-mm",
             path.string(), *from, *to);
    options.height_from_mm = *from;
    options.height_range_mm = *to - *from;
}

}  // namespace

ImportOptions as_described(const fs::path& folder, ImportOptions options) {
    const fs::path path = folder / "maps.json";
    if (!fs::is_regular_file(path)) return as_openlime_is_told(folder / "brdf.json", std::move(options));
    const nlohmann::json about = with_present_keys(told_in(path));
    if (!about.value("scale_known", nlohmann::json()).is_boolean()) return options;  // another program's
    const auto number = [&](const char* field, double least, double most) {
        return number_in(path, field, about.value(field, nlohmann::json()), least, most);
    };
    options.levelled = true;
    take_scale(path, about, options);
    take_whole_numbers(path, about.value("maps", nlohmann::json()), options);
    try {
        options.photography = photography_from_json(about.value("photography", nlohmann::json::object()));
    } catch (const std::exception&) {  // of a parser, about columns that nobody sees
        fail("{}: what it says of the photography cannot be read; export the maps again, or take that out",
             path.string());
    }
    if (!options.second_lobe_weight) options.second_lobe_weight = number("second_lobe_weight", 0, 1);
    if (!options.diffuse_roughness) options.diffuse_roughness = number("diffuse_roughness", 0, 1);
    return options;
}

}  // namespace tangi
