#include "paint/files/paint_parts.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

const std::string kVolume = "volume.", kUpperVolume = "volume_upper.";  // in the order of numbers with kUpper

json to_json(const Pigment& p) {
    json result = {{"name", p.name},
                   {"k", p.k},
                   {"s", p.s},
                   {"origin", name_of(p.origin)},
                   {"source", p.source},
                   {"specular", p.specular},
                   {"roughness", p.roughness}};
    if (p.medium > 0) result["medium"] = p.medium;
    return result;
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
    p.medium = object.value("medium", 0.0f);
    if (!(p.medium >= 0 && p.medium < 1))
        throw std::runtime_error(fmt::format("'{}' has medium {}", shortened(p.name), p.medium));
    for (int band = 0; band < kBands; ++band) {
        const auto i = static_cast<std::size_t>(band);
        if (!(p.k[i] >= 0) || !(p.s[i] >= 0) || !std::isfinite(p.k[i]) || !std::isfinite(p.s[i]))
            throw std::runtime_error(
                fmt::format("K or S of '{}' is negative or not finite", shortened(p.name)));
    }
    if (!(p.specular >= 0 && p.specular <= 1) || !(p.roughness >= 1e-6f && p.roughness <= 10))
        throw std::runtime_error(
            fmt::format("'{}' has specular {} and roughness {}", shortened(p.name), p.specular, p.roughness));
    return p;
}

// The number in a channel's name after a prefix, or -1.
int number_after(const std::string& prefix, const std::string& channel) {
    if (!channel.starts_with(prefix)) return -1;
    const std::string digits = channel.substr(prefix.size());
    if (digits.empty() || digits.size() > 5 || digits.find_first_not_of("0123456789") != std::string::npos)
        return -1;
    return std::stoi(digits);
}

// Puts a run of one ingredient's row into the tiles; less than nothing, to rounding, is nothing.
void put_row(PaintLayer& layer, IngredientId id, int y, const float* row) {
    for (int tx = 0; tx < layer.columns(); ++tx) {
        const TileIndex at{tx, y / kTileSize};
        const Region region = layer.region_of(at);
        const float* from = row + region.x0;
        if (std::all_of(from, from + region.width(), [](float v) { return v <= 0; })) continue;
        float* to = layer.writable(at).writable_plane(id).data() +
                    static_cast<std::size_t>((y - region.y0) * kTileSize);
        std::transform(from, from + region.width(), to, [](float v) { return std::max(v, 0.0f); });
    }
}

}  // namespace

std::string volume_channel(IngredientId id) {
    return fmt::format("{}{:05}", is_upper(id) ? kUpperVolume : kVolume, paint_of(id));
}

PartToWrite part_of(const std::string& name, const PaintLayer& layer) {
    PartToWrite part;
    std::set<IngredientId> occurring;
    for (const TileIndex at : layer.painted())
        occurring.insert(layer.tile(at)->ingredients.begin(), layer.tile(at)->ingredients.end());
    if (occurring.empty()) occurring.insert(0);  // an EXR part has a channel
    const std::vector<IngredientId> ids(occurring.begin(), occurring.end());
    part.info = {name, layer.width(), layer.height(), {}, {}};
    for (const IngredientId id : ids) part.info.channels.push_back(volume_channel(id));
    part.fill = [&layer, ids](int y0, int y1, std::span<float* const> planes) {
        for (int ty = y0 / kTileSize; ty * kTileSize < y1; ++ty)
            for (int tx = 0; tx < layer.columns(); ++tx) {
                const auto& tile = layer.tile({tx, ty});
                if (!tile) continue;
                const Region region = layer.region_of({tx, ty});
                for (std::size_t c = 0; c < ids.size(); ++c) {
                    const auto plane = tile->plane(ids[c]);
                    if (plane.empty()) continue;
                    for (int y = std::max(region.y0, y0); y < std::min(region.y1, y1); ++y)
                        std::copy_n(
                            plane.data() + static_cast<std::size_t>((y - region.y0) * kTileSize),
                            region.width(),
                            planes[c] +
                                static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(layer.width()) +
                                region.x0);
                }
            }
    };
    return part;
}

void add_ingredients(PartInfo& info, const std::vector<Pigment>& ingredients) {
    json list = json::array();
    for (const Pigment& pigment : ingredients) list.push_back(to_json(pigment));
    info.attributes["ingredients"] = json_line(list);
}

void read_ingredients(const fs::path& path, const PartInfo& info, Canvas& canvas) {
    try {
        const auto text = info.attributes.find("ingredients");
        if (text == info.attributes.end()) throw std::runtime_error("it is missing");
        const json listed = json_or_discarded(text->second);
        if (!listed.is_array()) throw std::runtime_error("it is no list");
        for (const json& ingredient : listed)
            if (canvas.add(pigment_from(ingredient)) + std::size_t(1) != canvas.ingredients().size())
                throw std::runtime_error("two of them are the same");
    } catch (const json::exception&) {  // of a parser, about columns that nobody sees
        fail(
            "{}: is damaged: the paints that it lists (attribute 'ingredients' of part '{}') cannot be read; "
            "copy it again, or take a copy from before",
            path.string(), info.name);
    } catch (const std::exception& error) {
        fail("{}: attribute 'ingredients' of part '{}': {}", path.string(), info.name, error.what());
    }
}

std::vector<IngredientId> ingredients_of(const fs::path& path, const PartInfo& info, std::size_t known,
                                         bool upper) {
    std::vector<IngredientId> ids;
    for (const std::string& channel : info.channels) {
        const int mixed = number_after(kVolume, channel),
                  above = upper ? number_after(kUpperVolume, channel) : -1, id = std::max(mixed, above);
        // An EXR part has a channel, even where nothing was painted with.
        if (!(id >= 0 && static_cast<std::size_t>(id) < known) && !(upper && mixed == 0 && known == 0))
            fail(
                "{}: part '{}' has a channel '{}' for which there is no ingredient: the file is damaged, or "
                "another program left parts out; take a copy from before",
                path.string(), info.name, shortened(channel));
        const auto paint = static_cast<IngredientId>(id);
        ids.push_back(mixed >= 0 ? paint : upper_of(paint));
    }
    return ids;
}

void require_volumes(const fs::path& path, const PartInfo& info, std::size_t channel, int y,
                     std::span<const float> row) {
    for (std::size_t x = 0; x < row.size(); ++x)
        if (!(row[x] >= -1e-6f) || !std::isfinite(row[x]))
            fail("{}: part '{}', channel '{}' holds {} at pixel ({}, {}); volumes are 0 or more",
                 path.string(), info.name, info.channels[channel], row[x], x, y);
}

void require_thickness(const fs::path& path, const PartInfo& info, int y, std::span<const float> sums,
                       float most_mm) {
    for (std::size_t x = 0; x < sums.size(); ++x)
        if (!(sums[x] <= most_mm))
            fail("{}: part '{}' holds {} mm of paint at pixel ({}, {}); there are never more than {:g}",
                 path.string(), info.name, sums[x], x, y, most_mm);
}

PaintLayer layer_of(const fs::path& path, const PartInfo& info, const Canvas& canvas,
                    const PartReader& read) {
    if (info.width != canvas.width() || info.height != canvas.height())
        fail("{}: part '{}' is {} x {}, but the painting is {} x {}", path.string(), info.name, info.width,
             info.height, canvas.width(), canvas.height());
    const std::vector<IngredientId> ids = ingredients_of(path, info, canvas.ingredients().size(), true);
    PaintLayer layer(canvas.width(), canvas.height());
    const auto width = static_cast<std::size_t>(info.width);
    std::vector<float> sums(width);
    read(info, [&](int y0, int y1, std::span<const float* const> planes) {
        for (int y = y0; y < y1; ++y) {
            std::ranges::fill(sums, 0.0f);
            for (std::size_t c = 0; c < planes.size(); ++c) {
                const float* row = planes[c] + static_cast<std::size_t>(y - y0) * width;
                require_volumes(path, info, c, y, {row, width});
                if (canvas.ingredients().empty() &&
                    std::any_of(row, row + width, [](float v) { return v > 0; }))
                    fail(
                        "{}: is damaged: part '{}' holds paint, but its list of paints is empty; copy it "
                        "again, "
                        "or take a copy from before",
                        path.string(), info.name);
                for (std::size_t x = 0; x < width; ++x) sums[x] += row[x];
                put_row(layer, ids[c], y, row);
            }
            require_thickness(path, info, y, sums, kMostPaint_mm);
        }
    });
    return layer;
}

PaintLayer read_layer(const fs::path& path, const PartInfo& info, const Canvas& canvas,
                      const Progress& progress) {
    return layer_of(path, info, canvas, [&](const PartInfo& part, const TakeRows& take) {
        read_painting_part(path, part, take, progress);
    });
}

}  // namespace tangi
