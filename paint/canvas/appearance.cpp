#include "paint/canvas/appearance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

#include "paint/canvas/appearance_part.h"
#include "paint/canvas/appearance_rows.h"
#include "paint/canvas/appearance_slopes.h"
#include "paint/optics/kubelka_munk.h"
#include "surface/base/parallel.h"
#include "surface/maps/surface_part.h"
#include "surface/math/portable_math.h"
#include "surface/reflectance/anisotropy.h"

namespace tangi {

namespace {

// All paint of the canvas, from the bottom up.
std::vector<const PaintLayer*> layers_of(const Canvas& canvas) {
    std::vector<const PaintLayer*> layers;
    for (const DriedLayer& layer : canvas.dried()) layers.push_back(&layer.paint);
    layers.push_back(&canvas.wet());
    return layers;
}

// One of the films that a tile of a layer has, in a part of it, row by row.
struct PartOfTile {
    std::vector<Pigment> pigments;
    std::vector<std::vector<float>> volumes_mm;  // of each

    PartOfTile(const PaintTile& tile, bool upper, const std::vector<Pigment>& all, const Region& part) {
        for (const IngredientId id : tile.ingredients) {
            if (is_upper(id) != upper) continue;
            pigments.push_back(all[paint_of(id)]);
            std::vector<float>& to = volumes_mm.emplace_back();
            to.reserve(static_cast<std::size_t>(part.width()) * static_cast<std::size_t>(part.height()));
            for (int y = part.y0; y < part.y1; ++y) {
                const float* from = tile.plane(id).data() + (y % kTileSize) * kTileSize + part.x0 % kTileSize;
                to.insert(to.end(), from, from + part.width());
            }
        }
    }
    std::vector<std::span<const float>> planes() const { return {volumes_mm.begin(), volumes_mm.end()}; }
};

// Of what is dry; more than a reflectance can hold is as much more under any light.
Rgb seen_under(Illuminant illuminant, const Rgb& dry) {
    if (illuminant == Illuminant::d65) return dry;
    const float most = std::max({dry.r, dry.g, dry.b, 1.0f});
    return glm::max(to_linear_rgb(reflectance_of_rgb(dry / most), illuminant) * most, Rgb(0));
}

void see_all_under(Illuminant illuminant, Surface& surface) {
    if (illuminant == Illuminant::d65) return;
    parallel_for(0, surface.height(), 16, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < surface.width(); ++x)
                surface.diffuse(x, y) = seen_under(illuminant, surface.diffuse(x, y));
    });
}

// As colours_of(), by the model of the thesis.
std::vector<Rgb> thesis_colours(const std::vector<PartOfTile>& layers, std::vector<Rgb> dry,
                                const AppearanceOptions& options) {
    const Transfer srgb{Transfer::Kind::srgb};
    for (Rgb& colour : dry) colour = seen_under(options.illuminant, colour);
    for (const PartOfTile& layer : layers) {
        std::vector<Rgb> masstones;
        std::vector<const std::vector<float>*> planes;
        for (std::size_t k = 0; k < layer.pigments.size(); ++k) {
            const Pigment& paint = layer.pigments[k];
            if (is_clear(paint)) continue;
            const Rgb colour = to_linear_rgb(opaque_look({paint.k, paint.s}), options.illuminant);
            masstones.push_back(srgb.encode(glm::clamp(colour, 0.0f, 1.0f)));
            planes.push_back(&layer.volumes_mm[k]);
        }
        std::vector<float> volumes(masstones.size());
        for (std::size_t i = 0; i < dry.size(); ++i) {
            float mm = 0;
            for (std::size_t k = 0; k < volumes.size(); ++k) mm += volumes[k] = (*planes[k])[i];
            if (!(mm > 0)) continue;
            const float covered = 1 - portable::exp(-mm / static_cast<float>(options.covering_mm));
            dry[i] += covered * (srgb.decode(thesis_mixture_srgb(masstones, volumes)) - dry[i]);
        }
    }
    return dry;
}

// The colours of a part of a tile, row by row: films of its layers over what is dry.
std::vector<Rgb> colours_of(const std::vector<PartOfTile>& layers, std::vector<Rgb> dry,
                            const AppearanceOptions& options) {
    if (options.model == PaintModel::thesis) return thesis_colours(layers, std::move(dry), options);
    std::vector<FilmBatch> paints;
    std::vector<std::vector<std::span<const float>>> planes;
    for (const PartOfTile& layer : layers) {
        paints.emplace_back(layer.pigments, options.illuminant);
        planes.push_back(layer.planes());
    }
    std::vector<FilmBatch::Film> films;
    for (std::size_t i = 0; i < layers.size(); ++i) films.push_back({&paints[i], planes[i]});
    FilmBatch::look_through(films, dry, dry);
    return dry;
}

// The gloss of a part of a tile, row by row.
struct Sheen {
    std::vector<float> specular, roughness;
    std::vector<float> coloured;  // part of rho_s that is of what is dry: paints shine white

    SheenRows rows() { return {specular.data(), roughness.data(), coloured.data()}; }
};

// The gloss of a part of a layer, its paints' by volume, over that of what lies below, in place. A varnish
// shines the same over thick paint as over thin. And its thickness is added to `mm`.
void lay_sheen(const PartOfTile& layer, const AppearanceOptions& options, Sheen& below,
               std::vector<float>& mm) {
    const std::size_t n = mm.size();
    std::vector<float> own(3 * n, 0.0f);
    const FilmRows film{own.data(), own.data() + n, own.data() + 2 * n};
    for (std::size_t k = 0; k < layer.pigments.size(); ++k)
        add_paint_rows(n, layer.volumes_mm[k].data(), layer.pigments[k].specular, layer.pigments[k].roughness,
                       film);
    lay_sheen_rows(n, film, static_cast<float>(options.covering_mm), below.rows());
    for (std::size_t i = 0; i < n; ++i) mm[i] += film.mm[i];
}

// Colour and stretch of the lobe of what is dry, as far as it shows.
void update_lobes(const Surface& dry, const Region& part, const std::vector<float>& mm, const Sheen& sheen,
                  const Shown& shown) {
    std::size_t i = 0;
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x, ++i) {
            const float specular = sheen.specular[i],
                        of_dry = specular > 0 ? std::min(sheen.coloured[i] / specular, 1.0f) : 0.0f;
            if (!dry.specular_colour.empty())
                shown.at(&Surface::specular_colour, x, y) =
                    mm[i] > 0 && specular > 0 ? Rgb(1) + of_dry * (dry.specular_colour(x, y) - Rgb(1))
                                              : dry.specular_colour(x, y);
            if (!dry.lobe_axes.empty())
                shown.at(&Surface::lobe_axes, x, y) =
                    mm[i] > 0 ? axes_of(of_dry * stretch_of(dry.lobe_axes(x, y), dry.roughness(x, y)),
                                        sheen.roughness[i])
                              : dry.lobe_axes(x, y);
        }
}

// All but the normals, in a part of one tile.
void update_part(const Canvas& canvas, const std::vector<const PaintLayer*>& layers, TileIndex at,
                 const Region& part, const Shown& shown, const AppearanceOptions& options) {
    const Surface& dry = canvas.dry();
    const auto unit_mm = static_cast<float>(canvas.height_unit_mm());
    std::vector<PartOfTile> films;
    for (const PaintLayer* layer : layers)
        if (const auto& tile = layer->tile(at)) {
            films.emplace_back(*tile, false, canvas.ingredients(), part);
            if (tile->has_upper()) films.emplace_back(*tile, true, canvas.ingredients(), part);
        }
    std::vector<Rgb> colours;
    Sheen sheen;
    for (int y = part.y0; y < part.y1; ++y) {
        const auto row = [&](auto& to, const auto& map) {
            const auto from =
                map.row(y).subspan(static_cast<std::size_t>(part.x0), static_cast<std::size_t>(part.width()));
            to.insert(to.end(), from.begin(), from.end());
        };
        row(colours, dry.diffuse);
        row(sheen.specular, dry.specular);
        row(sheen.roughness, dry.roughness);
    }
    sheen.coloured = sheen.specular;
    std::vector<float> mm(colours.size()), covered(colours.size());
    for (const PartOfTile& film : films) lay_sheen(film, options, sheen, mm);
    covered_rows(mm.size(), mm.data(), static_cast<float>(options.covering_mm), covered.data());
    if (!films.empty()) colours = colours_of(films, std::move(colours), options);
    const auto width = static_cast<std::size_t>(part.width());
    for (int y = part.y0; y < part.y1; ++y) {
        const std::size_t first = static_cast<std::size_t>(y - part.y0) * width;
        const auto to = [&](auto map) { return &shown.at(map, part.x0, y); };
        std::copy_n(sheen.specular.data() + first, width, to(&Surface::specular));
        std::copy_n(sheen.roughness.data() + first, width, to(&Surface::roughness));
        Rgb* diffuse = to(&Surface::diffuse);
        float *height = to(&Surface::height_mm), *confidence = to(&Surface::confidence);
        const Rgb* dry_diffuse = &dry.diffuse(part.x0, y);
        const float *dry_height = &dry.height_mm(part.x0, y), *known = &dry.confidence(part.x0, y);
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t i = first + x;
            // What a reflectance cannot hold (rho_d beyond 1) is covered like the rest.
            diffuse[x] =
                mm[i] > 0 ? glm::max(colours[i], Rgb(0)) : seen_under(options.illuminant, dry_diffuse[x]);
            height[x] = dry_height[x] + mm[i] / unit_mm;
            confidence[x] = std::max(known[x], covered[i]);
        }
    }
    if (!dry.specular_colour.empty() || !dry.lobe_axes.empty()) update_lobes(dry, part, mm, sheen, shown);
}

// What is to be made anew in one tile.
struct Changed {
    Region part, normals;  // may be empty
};

void unite(Region& all, const Region& more) {
    if (more.empty()) return;
    all = all.empty() ? more
                      : Region{std::min(all.x0, more.x0), std::min(all.y0, more.y0),
                               std::max(all.x1, more.x1), std::max(all.y1, more.y1)};
}

// `changed` as in update_appearance().
void update(const Canvas& canvas, std::span<const Region> changed, const Shown& shown,
            const AppearanceOptions& options, const Progress& progress) {
    std::map<TileIndex, Changed> wanted;
    for (const Region& part : changed) {
        if (part.empty()) continue;
        TP_REQUIRE(part.x0 / kTileSize == (part.x1 - 1) / kTileSize &&
                       part.y0 / kTileSize == (part.y1 - 1) / kTileSize,
                   "a part lies within one tile");
        if (const Region seen = intersection(part, shown.part); !seen.empty())
            unite(wanted[{part.x0 / kTileSize, part.y0 / kTileSize}].part, seen);
        const Region around = intersection(grown(part), shown.part);
        if (around.empty()) continue;
        for (int y = around.y0 / kTileSize; y * kTileSize < around.y1; ++y)
            for (int x = around.x0 / kTileSize; x * kTileSize < around.x1; ++x)
                unite(wanted[{x, y}].normals, intersection(around, canvas.wet().region_of({x, y})));
    }
    const std::vector<std::pair<TileIndex, Changed>> all(wanted.begin(), wanted.end());
    const auto layers = layers_of(canvas);
    std::mutex reporting;
    int done = 0;
    parallel_for(0, static_cast<int>(all.size()), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const auto& [tile, what] = all[static_cast<std::size_t>(i)];
            if (!what.part.empty()) update_part(canvas, layers, tile, what.part, shown, options);
            if (!what.normals.empty()) update_normals(canvas, layers, what.normals, shown);
        }
        const std::lock_guard lock(reporting);
        done += end - begin;
        report(progress, "blend layers", done / static_cast<double>(all.size()));
    });
}

// The parts of the canvas that hold paint.
std::vector<Region> painted_parts(const Canvas& canvas) {
    std::set<TileIndex> painted;
    for (const PaintLayer* layer : layers_of(canvas))
        for (const TileIndex tile : layer->painted()) painted.insert(tile);
    std::vector<Region> parts;
    for (const TileIndex tile : painted) parts.push_back(canvas.wet().region_of(tile));
    return parts;
}

}  // namespace

std::string_view name_of(PaintModel model) { return model == PaintModel::thesis ? "thesis" : "spectral"; }

std::optional<PaintModel> paint_model_named(std::string_view name) {
    for (const PaintModel model : {PaintModel::spectral, PaintModel::thesis})
        if (name == name_of(model)) return model;
    return std::nullopt;
}

void update_appearance(const Canvas& canvas, std::span<const Region> changed, Surface& surface,
                       const AppearanceOptions& options, const Progress& progress) {
    validate(options);
    TP_REQUIRE(surface.height_mm.region() == canvas.region(), "the surface is this canvas's");
    update(canvas, changed, {surface, canvas.region()}, options, progress);
}

Image<float> bare_part(const Canvas& canvas, const AppearanceOptions& options) {
    validate(options);
    if (canvas.ingredients().empty()) return {};
    Image<float> part(canvas.width(), canvas.height());
    for (const PaintLayer* layer : layers_of(canvas))
        layer->add_thickness_mm(part.region(), part.data(), static_cast<std::size_t>(part.width()));
    for (float& mm : part.pixels()) mm = portable::exp(-mm / static_cast<float>(options.covering_mm));
    return part;
}

Surface appearance(const Canvas& canvas, const AppearanceOptions& options, const Progress& progress) {
    Surface surface = canvas.dry();
    see_all_under(options.illuminant, surface);
    update_appearance(canvas, painted_parts(canvas), surface, options, progress);
    return surface;
}

std::shared_ptr<const Surface> shown(const Canvas& canvas, const AppearanceOptions& options,
                                     const Progress& progress) {
    validate(options);
    if (options.illuminant == Illuminant::d65 && painted_parts(canvas).empty()) return canvas.dry_shared();
    return std::make_shared<const Surface>(appearance(canvas, options, progress));
}

Surface appearance_in(const Canvas& canvas, const Region& part, const AppearanceOptions& options) {
    validate(options);
    TP_REQUIRE(!part.empty() && intersection(part, canvas.region()) == part, "the part is of the canvas");
    Surface surface = cut(canvas.dry(), part);
    see_all_under(options.illuminant, surface);
    std::vector<Region> parts;
    const Region around = intersection(grown(part), canvas.region());
    for (int y = around.y0 / kTileSize; y * kTileSize < around.y1; ++y)
        for (int x = around.x0 / kTileSize; x * kTileSize < around.x1; ++x)
            for (const PaintLayer* layer : layers_of(canvas))
                if (layer->tile({x, y})) {
                    parts.push_back(layer->region_of({x, y}));
                    break;
                }
    update(canvas, parts, {surface, part}, options, {});
    return surface;
}

Image<Rgb> diffuse_in(const Canvas& canvas, const Region& part, const AppearanceOptions& options) {
    Image<Rgb> result(part.width(), part.height());
    constexpr int kRows = 4 * kTileSize;
    for (int y = part.y0; y < part.y1; y += kRows) {
        const Region rows{part.x0, y, part.x1, std::min(y + kRows, part.y1)};
        const Surface seen = appearance_in(canvas, rows, options);
        std::copy(seen.diffuse.pixels().begin(), seen.diffuse.pixels().end(),
                  result.row(y - part.y0).begin());
    }
    return result;
}

}  // namespace tangi
