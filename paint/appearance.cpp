#include "paint/appearance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

#include "paint/appearance_part.h"
#include "paint/kubelka_munk.h"
#include "surface/anisotropy.h"
#include "surface/parallel.h"
#include "surface/surface_part.h"

namespace tangi {

namespace {

constexpr int kBorder = 2;             // [pixels] that slopes look beyond a tile
constexpr float kLevelled_mm = 0.02f;  // of a layer that levels lets 37 % of the detail below through

Region grown(const Region& r) { return {r.x0 - kBorder, r.y0 - kBorder, r.x1 + kBorder, r.y1 + kBorder}; }

// All paint of the canvas, from the bottom up.
std::vector<const PaintLayer*> layers_of(const Canvas& canvas) {
    std::vector<const PaintLayer*> layers;
    for (const DriedLayer& layer : canvas.dried()) layers.push_back(&layer.paint);
    layers.push_back(&canvas.wet());
    return layers;
}

// The thickness of all layers in a region and two pixels around it, as far as the canvas goes.
class Thickness {
public:
    Thickness(const std::vector<const PaintLayer*>& layers, const Region& region, const Region& canvas)
        : region_(intersection(grown(region), canvas)), values_(region_.width(), region_.height()) {
        for (const PaintLayer* layer : layers)
            layer->add_thickness_mm(region_, values_.data(), static_cast<std::size_t>(region_.width()));
    }
    float operator()(int x, int y) const { return values_(x - region_.x0, y - region_.y0); }

private:
    Region region_;
    Image<float> values_;
};

// The two places that a central difference along one axis is taken of: at the canvas's border, those of the
// pixel beside it. A one-sided difference sees twice the slope of bristle marks, which is black in raking
// light.
std::pair<int, int> beside(int x, int begin, int end) {
    const int middle = end - begin < 3 ? x : std::clamp(x, begin + 1, end - 2);
    return {std::max(middle - 1, begin), std::min(middle + 1, end - 1)};
}

Slope slope_at(const Thickness& t, int x, int y, const Region& canvas, double mm_per_pixel) {
    const auto [left, right] = beside(x, canvas.x0, canvas.x1);
    const auto [up, down] = beside(y, canvas.y0, canvas.y1);
    const auto mm = static_cast<float>(mm_per_pixel);
    return {(t(right, y) - t(left, y)) / (static_cast<float>(std::max(right - left, 1)) * mm),
            (t(x, up) - t(x, down)) / (static_cast<float>(std::max(down - up, 1)) * mm)};
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

// Of what is dry; more than a reflectance can hold is as much more under any lamp.
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
            const float covered = 1 - std::exp(-mm / static_cast<float>(options.covering_mm));
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

struct Sheen {
    float specular = 0, roughness = 0;
    float coloured = 0;  // part of rho_s that is of what is dry: paints shine white
};

// The gloss of a part of a layer, its paints' by volume, over that of what lies below, in place. A varnish
// shines the same over thick paint as over thin.
void lay_sheen(const PartOfTile& layer, const AppearanceOptions& options, std::vector<Sheen>& below) {
    std::vector<Sheen> own(below.size());
    std::vector<float> mm(below.size());
    for (std::size_t k = 0; k < layer.pigments.size(); ++k)
        for (std::size_t i = 0; i < below.size(); ++i) {
            const float volume = layer.volumes_mm[k][i];
            mm[i] += volume;
            own[i].specular += volume * layer.pigments[k].specular;
            own[i].roughness += volume * layer.pigments[k].roughness;
        }
    for (std::size_t i = 0; i < below.size(); ++i) {
        if (!(mm[i] > 0)) continue;
        const float covered = 1 - std::exp(-mm[i] / static_cast<float>(options.covering_mm));
        below[i].specular += covered * (own[i].specular / mm[i] - below[i].specular);
        below[i].roughness += covered * (own[i].roughness / mm[i] - below[i].roughness);
        below[i].coloured *= 1 - covered;
    }
}

// What is below paint that levels has the slope of its height only; elsewhere the slope that was measured.
Slope slope_below(const Surface& dry, int x, int y, float levelling_mm) {
    const Slope measured = slope_of(dry.normal(x, y));
    if (!(levelling_mm > 0)) return measured;
    const int left = std::max(x - 1, 0), right = std::min(x + 1, dry.width() - 1);
    const int up = std::max(y - 1, 0), down = std::min(y + 1, dry.height() - 1);
    const auto unit = static_cast<float>(dry.mm_per_pixel);
    const auto& h = dry.height_mm;
    const Slope of_height = {
        (h(right, y) - h(left, y)) / (static_cast<float>(std::max(right - left, 1)) * unit),
        (h(x, up) - h(x, down)) / (static_cast<float>(std::max(down - up, 1)) * unit)};
    const float through = std::exp(-levelling_mm / kLevelled_mm);
    return {of_height.x + through * (measured.x - of_height.x),
            of_height.y + through * (measured.y - of_height.y)};
}

// Paint that levels at a pixel or, where there is none, beside it: the edge of a fill ends the step down into
// the loss, which the height has and the measured normal has not.
float levelled_at(const Thickness& level, int x, int y, const Region& canvas) {
    if (level(x, y) > 0) return level(x, y);
    return std::max({level(std::max(x - 1, canvas.x0), y), level(std::min(x + 1, canvas.x1 - 1), y),
                     level(x, std::max(y - 1, canvas.y0)), level(x, std::min(y + 1, canvas.y1 - 1))});
}

// A surface that shows a part of the canvas.
struct Shown {
    Surface& surface;
    Region part;

    template <class T>
    T& at(Image<T> Surface::*map, int x, int y) const {
        return (surface.*map)(x - part.x0, y - part.y0);
    }
};

void update_normals(const Canvas& canvas, const std::vector<const PaintLayer*>& layers, const Region& region,
                    const Shown& shown) {
    const Surface& dry = canvas.dry();
    const Thickness thickness(layers, region, canvas.region());
    std::vector<const PaintLayer*> levelling;
    for (const DriedLayer& layer : canvas.dried())
        if (layer.levels) levelling.push_back(&layer.paint);
    const Thickness level(levelling, region, canvas.region());
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) {
            const Slope added = slope_at(thickness, x, y, canvas.region(), canvas.mm_per_pixel());
            Vec3& normal = shown.at(&Surface::normal, x, y);
            normal = dry.normal(x, y);
            if (added.x == 0 && added.y == 0 && !(level(x, y) > 0)) continue;
            const Slope below = slope_below(dry, x, y, levelled_at(level, x, y, canvas.region()));
            normal = normal_of({below.x + added.x, below.y + added.y});
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
    std::vector<Sheen> sheen;
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x) {
            colours.push_back(dry.diffuse(x, y));
            sheen.push_back({dry.specular(x, y), dry.roughness(x, y)});
            sheen.back().coloured = dry.specular(x, y);
        }
    std::vector<float> mm(colours.size());
    for (const PartOfTile& film : films) {
        for (const std::vector<float>& volume_mm : film.volumes_mm)
            for (std::size_t i = 0; i < mm.size(); ++i) mm[i] += volume_mm[i];
        lay_sheen(film, options, sheen);
    }
    if (!films.empty()) colours = colours_of(films, std::move(colours), options);
    std::size_t i = 0;
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x, ++i) {
            Rgb& diffuse = shown.at(&Surface::diffuse, x, y);
            float& specular = shown.at(&Surface::specular, x, y);
            float& roughness = shown.at(&Surface::roughness, x, y);
            float& confidence = shown.at(&Surface::confidence, x, y);
            shown.at(&Surface::height_mm, x, y) = dry.height_mm(x, y) + mm[i] / unit_mm;
            diffuse = seen_under(options.illuminant, dry.diffuse(x, y));
            specular = dry.specular(x, y);
            roughness = dry.roughness(x, y);
            confidence = dry.confidence(x, y);
            if (!dry.lobe_colour.empty()) shown.at(&Surface::lobe_colour, x, y) = dry.lobe_colour(x, y);
            if (!dry.lobe_axes.empty()) shown.at(&Surface::lobe_axes, x, y) = dry.lobe_axes(x, y);
            if (!(mm[i] > 0)) continue;
            const float covered = 1 - std::exp(-mm[i] / static_cast<float>(options.covering_mm));
            // What a reflectance cannot hold (rho_d beyond 1) is covered like the rest.
            diffuse = glm::max(colours[i], Rgb(0));
            specular = sheen[i].specular;
            roughness = sheen[i].roughness;
            const float of_dry =
                sheen[i].specular > 0 ? std::min(sheen[i].coloured / sheen[i].specular, 1.0f) : 0.0f;
            if (!dry.lobe_colour.empty() && sheen[i].specular > 0)
                shown.at(&Surface::lobe_colour, x, y) = Rgb(1) + of_dry * (dry.lobe_colour(x, y) - Rgb(1));
            if (!dry.lobe_axes.empty())
                shown.at(&Surface::lobe_axes, x, y) =
                    axes_of(of_dry * stretch_of(dry.lobe_axes(x, y), dry.roughness(x, y)), roughness);
            confidence = std::max(confidence, covered);
        }
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
    for (float& mm : part.pixels()) mm = std::exp(-mm / static_cast<float>(options.covering_mm));
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
