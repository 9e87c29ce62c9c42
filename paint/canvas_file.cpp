#include "paint/canvas_file.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "paint/appearance.h"
#include "surface/error.h"
#include "surface/painting_file.h"
#include "surface/painting_parts.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr int kSize = PaintTile::kSize;
constexpr const char* kWet = "wet";
const std::string kDried = "dried.", kVolume = "volume.";

std::string channel_of(IngredientId id) { return fmt::format("{}{:05}", kVolume, id); }

json to_json(const Pigment& p) {
    return {{"name", p.name},
            {"k", p.k},
            {"s", p.s},
            {"origin", name_of(p.origin)},
            {"source", p.source},
            {"specular", p.specular},
            {"roughness", p.roughness}};
}

Pigment pigment_from(const json& object) {
    Pigment p;
    p.name = object.at("name").get<std::string>();
    p.k = object.at("k").get<Spectrum>();
    p.s = object.at("s").get<Spectrum>();
    p.source = object.value("source", std::string());
    for (const PigmentOrigin origin : {PigmentOrigin::measured, PigmentOrigin::masstone_and_tint,
                                       PigmentOrigin::masstone, PigmentOrigin::colour})
        if (object.value("origin", std::string()) == name_of(origin)) p.origin = origin;
    p.specular = object.at("specular").get<float>();
    p.roughness = object.at("roughness").get<float>();
    for (int band = 0; band < kBands; ++band) {
        const auto i = static_cast<std::size_t>(band);
        if (!(p.k[i] >= 0) || !(p.s[i] >= 0) || !std::isfinite(p.k[i]) || !std::isfinite(p.s[i]))
            throw std::runtime_error(fmt::format("K or S of '{}' is negative or not finite", p.name));
    }
    if (!(p.specular >= 0 && p.specular <= 1) || !(p.roughness >= 1e-6f && p.roughness <= 10))
        throw std::runtime_error(
            fmt::format("'{}' has specular {} and roughness {}", p.name, p.specular, p.roughness));
    return p;
}

PartToWrite part_of(const std::string& name, const PaintLayer& layer) {
    PartToWrite part;
    std::set<IngredientId> occurring;
    for (const TileIndex at : layer.painted())
        occurring.insert(layer.tile(at)->ingredients.begin(), layer.tile(at)->ingredients.end());
    if (occurring.empty()) occurring.insert(0);  // an EXR part has a channel
    const std::vector<IngredientId> ids(occurring.begin(), occurring.end());
    part.info = {name, layer.width(), layer.height(), {}, {}};
    for (const IngredientId id : ids) part.info.channels.push_back(channel_of(id));
    part.fill = [&layer, ids](int y0, int y1, std::span<float* const> planes) {
        for (int ty = y0 / kSize; ty * kSize < y1; ++ty)
            for (int tx = 0; tx < layer.columns(); ++tx) {
                const auto& tile = layer.tile({tx, ty});
                if (!tile) continue;
                const Region region = layer.region_of({tx, ty});
                for (std::size_t c = 0; c < ids.size(); ++c) {
                    const auto plane = tile->plane(ids[c]);
                    if (plane.empty()) continue;
                    for (int y = std::max(region.y0, y0); y < std::min(region.y1, y1); ++y)
                        std::copy_n(
                            plane.data() + static_cast<std::size_t>((y - region.y0) * kSize), region.width(),
                            planes[c] +
                                static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(layer.width()) +
                                region.x0);
                }
            }
    };
    return part;
}

// The number in a channel's name, or -1.
int ingredient_in(const std::string& channel) {
    if (!channel.starts_with(kVolume)) return -1;
    const std::string digits = channel.substr(kVolume.size());
    if (digits.empty() || digits.size() > 5 || digits.find_first_not_of("0123456789") != std::string::npos)
        return -1;
    return std::stoi(digits);
}

// Puts a run of one ingredient's row into the tiles.
void put_row(PaintLayer& layer, IngredientId id, int y, const float* row) {
    for (int tx = 0; tx < layer.columns(); ++tx) {
        const TileIndex at{tx, y / kSize};
        const Region region = layer.region_of(at);
        const float* from = row + region.x0;
        if (std::all_of(from, from + region.width(), [](float v) { return v == 0; })) continue;
        PaintTile& tile = layer.writable(at);
        std::copy_n(from, region.width(),
                    tile.writable_plane(id).data() + static_cast<std::size_t>((y - region.y0) * kSize));
    }
}

PaintLayer read_layer(const fs::path& path, const PartInfo& info, const Canvas& canvas,
                      const Progress& progress) {
    if (info.width != canvas.width() || info.height != canvas.height())
        fail("{}: part '{}' is {} x {}, but the painting is {} x {}", path.string(), info.name, info.width,
             info.height, canvas.width(), canvas.height());
    for (const std::string& channel : info.channels) {
        const int id = ingredient_in(channel);
        const bool known = id >= 0 && static_cast<std::size_t>(id) < canvas.ingredients().size();
        if (!known && !(id == 0 && canvas.ingredients().empty()))
            fail("{}: part '{}' has a channel '{}' for which there is no ingredient", path.string(),
                 info.name, channel);
    }
    PaintLayer layer(canvas.width(), canvas.height());
    read_painting_part(
        path, info,
        [&](int y0, int y1, std::span<const float* const> planes) {
            for (std::size_t c = 0; c < planes.size(); ++c)
                for (int y = y0; y < y1; ++y) {
                    const float* row =
                        planes[c] + static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(info.width);
                    for (int x = 0; x < info.width; ++x)
                        if (!(row[x] >= -1e-6f) || !std::isfinite(row[x]))
                            fail(
                                "{}: part '{}', channel '{}' holds {} at pixel ({}, {}); volumes are 0 or "
                                "more",
                                path.string(), info.name, info.channels[c], row[x], x, y);
                    put_row(layer, static_cast<IngredientId>(ingredient_in(info.channels[c])), y, row);
                }
        },
        progress);
    return layer;
}

// The scale that a painting of unknown scale was painted on with.
std::optional<double> scale_of(const PartInfo& wet, const fs::path& path) {
    const auto found = wet.attributes.find("paint_mm_per_pixel");
    if (found == wet.attributes.end()) return {};
    const json value = json::parse(found->second, nullptr, false);
    if (!value.is_number() || !(value.get<double>() > 0))
        fail("{}: attribute 'paint_mm_per_pixel' of part 'wet' is '{}', not a size above 0", path.string(),
             found->second);
    return value.get<double>();
}

const PartInfo* find(const std::vector<PartInfo>& parts, const std::string& name) {
    for (const PartInfo& part : parts)
        if (part.name == name) return &part;
    return nullptr;
}

}  // namespace

void write_canvas(AtomicFile& file, const Canvas& canvas, const Progress& progress,
                  std::span<const PartToWrite> further) {
    std::vector<PartToWrite> parts;
    if (!canvas.ingredients().empty()) {
        parts.push_back(part_of(kWet, canvas.wet()));
        json list = json::array();
        for (const Pigment& pigment : canvas.ingredients()) list.push_back(to_json(pigment));
        parts.back().info.attributes["ingredients"] = list.dump();
        if (canvas.mm_per_pixel() != canvas.dry().mm_per_pixel)  // the dry part says that it does not know
            parts.back().info.attributes["paint_mm_per_pixel"] = fmt::format("{}", canvas.mm_per_pixel());
        for (std::size_t i = 0; i < canvas.dried().size(); ++i) {
            parts.push_back(part_of(kDried + std::to_string(i), canvas.dried()[i].paint));
            parts.back().info.attributes["layer"] = canvas.dried()[i].name;
            if (canvas.dried()[i].levels) parts.back().info.attributes["levels"] = "yes";
        }
    }
    parts.insert(parts.end(), further.begin(), further.end());
    write_painting(file, canvas.dry(), parts, progress);
}

void write_canvas(const fs::path& path, const Canvas& canvas, const Progress& progress) {
    AtomicFile file(path);
    write_canvas(file, canvas, progress);
}

std::vector<PartToWrite> parts_beside_paint(const fs::path& path, const Progress& progress) {
    std::vector<PartToWrite> kept;
    for (const PartInfo& info : painting_parts(path)) {
        if (info.name == kWet || info.name.starts_with(kDried)) continue;
        auto planes = std::make_shared<std::vector<Image<float>>>(info.channels.size(),
                                                                  Image<float>(info.width, info.height));
        read_painting_part(
            path, info,
            [&](int y0, int y1, std::span<const float* const> rows) {
                for (std::size_t c = 0; c < rows.size(); ++c)
                    std::copy_n(rows[c], static_cast<std::ptrdiff_t>(y1 - y0) * info.width,
                                (*planes)[c].row(y0).data());
            },
            progress);
        kept.push_back({info, [planes](int y0, int y1, std::span<float* const> rows) {
                            for (std::size_t c = 0; c < rows.size(); ++c) {
                                const Image<float>& plane = (*planes)[c];
                                std::copy_n(plane.row(y0).data(),
                                            static_cast<std::ptrdiff_t>(y1 - y0) * plane.width(), rows[c]);
                            }
                        }});
    }
    return kept;
}

Canvas read_canvas(const fs::path& path, const Progress& progress, std::optional<double> mm_per_pixel) {
    const auto dry = std::make_shared<Surface>(read_painting(path, progress));
    const std::vector<PartInfo> parts = painting_parts(path);
    const PartInfo* wet = find(parts, kWet);
    if (const auto stored = wet ? scale_of(*wet, path) : std::nullopt) {
        if (mm_per_pixel && *mm_per_pixel != *stored)
            fail("{}: was painted on with pixels of {} mm, not {} mm", path.string(), *stored, *mm_per_pixel);
        mm_per_pixel = stored;
    }
    if (mm_per_pixel && dry->scale_known && *mm_per_pixel != dry->mm_per_pixel)
        fail("{}: its pixels are known to be {} mm, not {} mm", path.string(), dry->mm_per_pixel,
             *mm_per_pixel);
    Canvas canvas(dry, mm_per_pixel);
    if (!wet) return canvas;
    try {
        const auto text = wet->attributes.find("ingredients");
        if (text == wet->attributes.end()) throw std::runtime_error("it is missing");
        for (const json& ingredient : json::parse(text->second))
            if (canvas.add(pigment_from(ingredient)) + std::size_t(1) != canvas.ingredients().size())
                throw std::runtime_error("two of them are the same");
    } catch (const std::exception& error) {
        fail("{}: attribute 'ingredients' of part 'wet': {}", path.string(), error.what());
    }
    canvas.writable_wet() = read_layer(path, *wet, canvas, progress);
    for (int i = 0; const PartInfo* part = find(parts, kDried + std::to_string(i)); ++i) {
        const auto layer = part->attributes.find("layer");
        canvas.writable_dried().push_back({layer == part->attributes.end() ? part->name : layer->second,
                                           read_layer(path, *part, canvas, progress),
                                           part->attributes.contains("levels")});
    }
    return canvas;
}

Surface read_painted(const fs::path& path, const Progress& progress) {
    const Canvas canvas = read_canvas(path, progress);
    return canvas.ingredients().empty() ? canvas.dry() : appearance(canvas, {}, progress);
}

}  // namespace tangi
