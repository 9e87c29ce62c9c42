#include "retouch/treatment/removed_layers.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "paint/files/paint_parts.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

const std::string kRemoved = "removed.";

// `numbers`: of each paint that the layer has, that of the canvas where it goes.
PaintLayer renumbered(const PaintLayer& layer, const std::vector<IngredientId>& numbers) {
    PaintLayer result(layer.width(), layer.height());
    for (const TileIndex at : layer.painted()) {
        const PaintTile& from = *layer.tile(at);
        PaintTile& to = result.writable(at);
        for (const IngredientId id : from.ingredients) {
            const IngredientId paint = numbers.at(paint_of(id));
            std::ranges::copy(from.plane(id),
                              to.writable_plane(is_upper(id) ? upper_of(paint) : paint).begin());
        }
    }
    return result;
}

}  // namespace

std::vector<DriedLayer> layers_named(const Canvas& canvas, const std::vector<std::string>& names) {
    std::vector<std::string> there;
    std::vector<DriedLayer> layers;
    for (const DriedLayer& layer : canvas.dried()) {
        there.push_back(layer.name);
        if (std::ranges::find(names, layer.name) != names.end()) layers.push_back(layer);
    }
    for (const std::string& name : names)
        if (std::ranges::find(there, name) == there.end())
            fail("there is no dried layer '{}'; there are: {}", name,
                 there.empty() ? "none" : fmt::format("{}", fmt::join(there, ", ")));
    return layers;
}

void write_removed(AtomicFile& file, const Canvas& canvas, const std::vector<DriedLayer>& layers,
                   const Progress& progress) {
    TP_REQUIRE(!layers.empty(), "a layer is kept");
    std::vector<PartToWrite> parts;
    for (const DriedLayer& layer : layers) {
        parts.push_back(part_of(kRemoved + std::to_string(parts.size()), layer.paint));
        parts.back().info.attributes["layer"] = layer.name;
        if (layer.levels) parts.back().info.attributes["levels"] = "yes";
    }
    add_ingredients(parts.front().info, canvas.ingredients());
    write_painting(file, cut(canvas.dry(), {0, 0, 1, 1}), parts, progress);
}

std::vector<DriedLayer> read_removed(const fs::path& path, Canvas& canvas, const Progress& progress) {
    const std::vector<PartInfo> parts = painting_parts(path);
    Canvas own(canvas.dry_shared(), canvas.mm_per_pixel());
    std::vector<DriedLayer> layers;
    for (;;) {
        const auto part = std::ranges::find(parts, kRemoved + std::to_string(layers.size()), &PartInfo::name);
        if (part == parts.end()) break;
        if (layers.empty()) read_ingredients(path, *part, own);
        const auto name = part->attributes.find("layer");
        layers.push_back({name == part->attributes.end() ? part->name : valid_utf8(name->second),
                          read_layer(path, *part, own, progress), part->attributes.contains("levels")});
    }
    std::vector<IngredientId> numbers;
    for (const Pigment& paint : own.ingredients()) numbers.push_back(canvas.add(paint));
    for (DriedLayer& layer : layers) layer.paint = renumbered(layer.paint, numbers);
    return layers;
}

}  // namespace tangi
