#include "surface/painting_file/tiles_description.h"

#include <nlohmann/json.hpp>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/sha256.h"
#include "surface/file/version.h"
#include "surface/maps/photography_json.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

const std::string kTilesFormat = "tangipaint tiles ";
constexpr int kTilesVersion = 1;

json to_json(const PartInfo& part) {
    return {{"name", part.name},         {"width", part.width}, {"height", part.height},
            {"channels", part.channels}, {"half", part.half},   {"attributes", part.attributes}};
}

PartInfo part_of(const json& part) {
    return {part.at("name"),     part.at("width"),      part.at("height"),
            part.at("channels"), part.at("attributes"), part.at("half")};
}

// JSON as JSON where that gives the same text back.
json provenance_of(const std::string& text) {
    json value = json_or_discarded(text);
    return value.is_object() && json_line(value) == text ? value : json(text);
}

std::string hash_of(const json& all) { return sha256_of(json_line(all)); }

PaintingHeader header_of(const json& all) {
    PaintingHeader h;
    h.width = all.at("width");
    h.height = all.at("height");
    h.has_specular_colour = all.at("specular_colour");
    h.has_lobe_axes = all.at("anisotropic_specular");
    h.reflectance_model.diffuse_roughness = all.at("diffuse_roughness");
    h.reflectance_model.second_lobe_weight = all.at("second_lobe_weight");
    h.mm_per_pixel = all.at("mm_per_pixel");
    h.scale_known = all.at("scale_known");
    h.photography = photography_from_json(all.at("photography"));
    const json& provenance = all.at("provenance");
    h.provenance = provenance.is_string() ? provenance.get<std::string>() : json_line(provenance);
    h.dry_hash = all.at("dry_hash");
    for (const json& part : all.at("parts")) h.parts.push_back(part_of(part));
    return h;
}

void require_sizes(const TilesDescription& d) {
    const TileGrid grid(d.header.width, d.header.height);
    if (static_cast<int>(d.hashes.size()) != grid.levels()) throw Error("its levels");
    if (static_cast<int>(d.heights.size()) != grid.count()) throw Error("its heights");
    for (int level = 0; level < grid.levels(); ++level)
        if (static_cast<int>(d.hashes[static_cast<std::size_t>(level)].size()) != grid.count(level))
            throw Error("its tiles");
}

}  // namespace

std::string words_of(const TilesDescription& d) {
    const PaintingHeader& h = d.header;
    json parts = json::array();
    for (const PartInfo& part : h.parts) parts.push_back(to_json(part));
    json heights = json::array();
    for (const HeightRange& range : d.heights) heights.push_back({range.lowest, range.highest});
    json all = {{"format", fmt::format("{}{}", kTilesFormat, kTilesVersion)},
                {"software", program_name()},
                {"width", h.width},
                {"height", h.height},
                {"tile", kPaintingTile},
                {"specular_colour", h.has_specular_colour},
                {"anisotropic_specular", h.has_lobe_axes},
                {"diffuse_roughness", h.reflectance_model.diffuse_roughness},
                {"second_lobe_weight", h.reflectance_model.second_lobe_weight},
                {"mm_per_pixel", h.mm_per_pixel},
                {"scale_known", h.scale_known},
                {"photography", to_json(h.photography)},
                {"provenance", provenance_of(h.provenance)},
                {"dry_hash", h.dry_hash},
                {"parts", parts},
                {"made_of", d.made_of},
                {"heights_mm", heights},
                {"tiles", d.hashes}};
    all["sha256"] = hash_of(all);
    return json_lines(all, 1);
}

TilesDescription read_tiles_description(const fs::path& folder) {
    const fs::path file = folder / kTilesDescription;
    if (!fs::exists(file))
        fail(
            "{}: is a painting of tiles that is not whole: {} is missing; make it again with the same "
            "command, "
            "which keeps the tiles that are there, or copy the folder again",
            folder.string(), kTilesDescription);
    json all = read_json(read_text_file(file), file.string());
    const json word = all.is_object() ? all.value("format", json()) : json();
    const std::string format = word.is_string() ? word.get<std::string>() : "";
    if (!format.starts_with(kTilesFormat)) fail("{}: does not describe a painting of tiles", file.string());
    if (format != fmt::format("{}{}", kTilesFormat, kTilesVersion))
        fail("{}: is of format '{}', and {} reads '{}{}'; take a newer version of the program", file.string(),
             shortened(format), program_name(), kTilesFormat, kTilesVersion);
    try {
        const std::string stored = all.at("sha256");
        all.erase("sha256");
        if (hash_of(all) != stored) throw Error("its hash");
        TilesDescription description{header_of(all), all.at("made_of"), all.at("tiles"), {}};
        for (const json& range : all.at("heights_mm"))
            description.heights.push_back({range.at(0), range.at(1)});
        require_sizes(description);
        return description;
    } catch (const std::exception&) {  // of a parser, about fields that nobody knows
        fail(
            "{}: is damaged, or was changed: it is not what its hash (sha256) is of; copy it again, or make "
            "the painting again with the same command, which keeps the tiles that are there",
            file.string());
    }
}

}  // namespace tangi
