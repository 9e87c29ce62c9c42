#include "paint/files/canvas_parts.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr const char* kWet = "wet";
const std::string kDried = "dried.";

// The scale that a painting of unknown scale was painted on with: of its own where nothing says another.
std::optional<double> scale_of(const PartInfo& wet, const Surface& dry, const fs::path& path) {
    const auto found = wet.attributes.find("paint_mm_per_pixel");
    if (found == wet.attributes.end())
        return dry.scale_known ? std::nullopt : std::optional(dry.mm_per_pixel);
    const json value = json_or_discarded(found->second);
    if (!value.is_number() || !(value.get<double>() > 0))
        fail("{}: attribute 'paint_mm_per_pixel' of part 'wet' is '{}', not a size above 0", path.string(),
             shortened(found->second));
    return value.get<double>();
}

const PartInfo* find(const std::vector<PartInfo>& parts, const std::string& name) {
    for (const PartInfo& part : parts)
        if (part.name == name) return &part;
    return nullptr;
}

}  // namespace

std::vector<PartToWrite> paint_parts_of(const Canvas& canvas) {
    std::vector<PartToWrite> parts;
    if (canvas.ingredients().empty()) return parts;
    parts.push_back(part_of(kWet, canvas.wet()));
    add_ingredients(parts.back().info, canvas.ingredients());
    if (canvas.mm_per_pixel() != canvas.dry().mm_per_pixel)  // the dry part says that it does not know
        parts.back().info.attributes["paint_mm_per_pixel"] = fmt::format("{}", canvas.mm_per_pixel());
    for (std::size_t i = 0; i < canvas.dried().size(); ++i) {
        parts.push_back(part_of(kDried + std::to_string(i), canvas.dried()[i].paint));
        parts.back().info.attributes["layer"] = canvas.dried()[i].name;
        if (canvas.dried()[i].levels) parts.back().info.attributes["levels"] = "yes";
    }
    return parts;
}

bool is_paint_part(const std::string& name) { return name == kWet || name.starts_with(kDried); }

Canvas canvas_of_parts(const fs::path& path, std::shared_ptr<const Surface> dry,
                       const std::vector<PartInfo>& parts, const PartReader& read,
                       std::optional<double> mm_per_pixel) {
    const PartInfo* wet = find(parts, kWet);
    // All of them are written together: 'wet' lists what the volumes of the others are of, and layers are
    // numbered from 0.
    const auto dried_count = static_cast<int>(
        std::ranges::count_if(parts, [](const PartInfo& part) { return part.name.starts_with(kDried); }));
    for (int i = 0; i < dried_count; ++i)
        if (!wet || !find(parts, kDried + std::to_string(i)))
            fail(
                "{}: has {} of dried paint, but no part '{}': the file is damaged, or another program "
                "left parts out; take a copy from before",
                path.string(), dried_count == 1 ? "a layer" : fmt::format("{} layers", dried_count),
                wet ? kDried + std::to_string(i) : kWet);
    if (const auto stored = wet ? scale_of(*wet, *dry, path) : std::nullopt) {
        if (mm_per_pixel && !same_scale(*mm_per_pixel, *stored))
            fail("{}: was painted on with pixels of {} mm, not {} mm; leave --mm-per-pixel out",
                 path.string(), *stored, *mm_per_pixel);
        mm_per_pixel = stored;
    }
    if (mm_per_pixel && dry->scale_known && !same_scale(*mm_per_pixel, dry->mm_per_pixel))
        fail("{}: its pixels are known to be {} mm, not {} mm", path.string(), dry->mm_per_pixel,
             *mm_per_pixel);
    Canvas canvas(std::move(dry), mm_per_pixel);
    if (!wet) return canvas;
    read_ingredients(path, *wet, canvas);
    canvas.writable_wet() = layer_of(path, *wet, canvas, read);
    for (int i = 0; i < dried_count; ++i) {
        const PartInfo* part = find(parts, kDried + std::to_string(i));
        const auto layer = part->attributes.find("layer");
        canvas.writable_dried().push_back(
            {layer == part->attributes.end() ? part->name : valid_utf8(layer->second),
             layer_of(path, *part, canvas, read), part->attributes.contains("levels")});
    }
    return canvas;
}

}  // namespace tangi
