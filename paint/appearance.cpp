#include "paint/appearance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <set>

#include "paint/kubelka_munk.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kSize = PaintTile::kSize;
constexpr int kBorder = 2;             // [pixels] that slopes look beyond a tile
constexpr float kLevelled_mm = 0.02f;  // of a layer that levels lets 37 % of the detail below through

// All paint of the canvas, from the bottom up.
std::vector<const PaintLayer*> layers_of(const Canvas& canvas) {
    std::vector<const PaintLayer*> layers;
    for (const DriedLayer& layer : canvas.dried()) layers.push_back(&layer.paint);
    layers.push_back(&canvas.wet());
    return layers;
}

// The thickness of all layers in a tile and two pixels around it, as far as the canvas goes.
class Thickness {
public:
    Thickness(const std::vector<const PaintLayer*>& layers, const Region& tile, const Region& canvas)
        : region_{std::max(tile.x0 - kBorder, canvas.x0), std::max(tile.y0 - kBorder, canvas.y0),
                  std::min(tile.x1 + kBorder, canvas.x1), std::min(tile.y1 + kBorder, canvas.y1)},
          values_(region_.width(), region_.height()) {
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

// Films of one tile of one layer over the colours that lie below, in place.
void lay_film(const PaintTile& tile, const std::vector<Pigment>& pigments, const AppearanceOptions& options,
              std::vector<Spectrum>& below) {
    std::vector<Pigment> used;
    std::vector<std::span<const float>> planes;
    for (const IngredientId id : tile.ingredients) {
        used.push_back(pigments[id]);
        planes.push_back(tile.plane(id));
    }
    const FilmBatch films(used, options.illuminant);
    std::vector<Spectrum> above(below.size());
    films.look(planes, below, above);
    std::swap(below, above);
}

struct Sheen {
    float specular = 0, roughness = 0;
};

// The gloss of one tile of one layer, its paints' by volume, over that of what lies below, in place. A
// varnish shines the same over thick paint as over thin.
void lay_sheen(const PaintTile& tile, const std::vector<Pigment>& pigments, const AppearanceOptions& options,
               std::vector<Sheen>& below) {
    std::vector<Sheen> own(below.size());
    std::vector<float> mm(below.size());
    for (const IngredientId id : tile.ingredients) {
        const std::span<const float> plane = tile.plane(id);
        for (std::size_t i = 0; i < plane.size(); ++i) {
            mm[i] += plane[i];
            own[i].specular += plane[i] * pigments[id].specular;
            own[i].roughness += plane[i] * pigments[id].roughness;
        }
    }
    for (std::size_t i = 0; i < below.size(); ++i) {
        if (!(mm[i] > 0)) continue;
        const float covered = 1 - std::exp(-mm[i] / static_cast<float>(options.covering_mm));
        below[i].specular += covered * (own[i].specular / mm[i] - below[i].specular);
        below[i].roughness += covered * (own[i].roughness / mm[i] - below[i].roughness);
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

// The normals of a tile: all that paint in the tiles beside it changes.
void update_normals(const Canvas& canvas, const Thickness& thickness, const Region& region, Surface& s) {
    const Surface& dry = canvas.dry();
    std::vector<const PaintLayer*> levelling;
    for (const DriedLayer& layer : canvas.dried())
        if (layer.levels) levelling.push_back(&layer.paint);
    const Thickness level(levelling, region, canvas.region());
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) {
            const Slope added = slope_at(thickness, x, y, canvas.region(), canvas.mm_per_pixel());
            s.normal(x, y) = dry.normal(x, y);
            if (added.x == 0 && added.y == 0 && !(level(x, y) > 0)) continue;
            const Slope below = slope_below(dry, x, y, level(x, y));
            s.normal(x, y) = normal_of({below.x + added.x, below.y + added.y});
        }
}

void update_tile(const Canvas& canvas, TileIndex at, bool normals_only, Surface& s,
                 const AppearanceOptions& options) {
    const auto layers = layers_of(canvas);
    const Surface& dry = canvas.dry();
    const auto unit_mm = static_cast<float>(canvas.height_unit_mm());
    const Region region = canvas.wet().region_of(at);
    const Thickness thickness(layers, region, canvas.region());
    update_normals(canvas, thickness, region, s);
    if (normals_only) return;
    const auto painted = [&](const PaintLayer* layer) { return layer->tile(at) != nullptr; };
    const bool any_layer = std::any_of(layers.begin(), layers.end(), painted);

    // Colours, and gloss: a layer's own, by volume, as far as it covers what lies below.
    std::vector<Spectrum> look;
    std::vector<Sheen> sheen;
    if (any_layer) {
        look.resize(PaintTile::kPixels);
        sheen.resize(PaintTile::kPixels);
        for (int y = region.y0; y < region.y1; ++y)
            for (int x = region.x0; x < region.x1; ++x) {
                const auto i = static_cast<std::size_t>((y - region.y0) * kSize + x - region.x0);
                look[i] = reflectance_of_rgb(dry.diffuse(x, y));
                sheen[i] = {dry.specular(x, y), dry.roughness(x, y)};
            }
        for (const PaintLayer* layer : layers)
            if (const auto& tile = layer->tile(at)) {
                lay_film(*tile, canvas.ingredients(), options, look);
                lay_sheen(*tile, canvas.ingredients(), options, sheen);
            }
    }
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) {
            const float mm = thickness(x, y);
            s.height_mm(x, y) = dry.height_mm(x, y) + mm / unit_mm;
            s.diffuse(x, y) = dry.diffuse(x, y);
            s.specular(x, y) = dry.specular(x, y);
            s.roughness(x, y) = dry.roughness(x, y);
            s.confidence(x, y) = dry.confidence(x, y);
            if (!(mm > 0)) continue;
            const auto i = static_cast<std::size_t>((y - region.y0) * kSize + x - region.x0);
            const float covered = 1 - std::exp(-mm / static_cast<float>(options.covering_mm));
            // What a reflectance cannot hold (rho_d beyond 1) is covered like the rest.
            s.diffuse(x, y) = glm::max(to_linear_rgb(look[i], options.illuminant), Rgb(0));
            s.specular(x, y) = sheen[i].specular;
            s.roughness(x, y) = sheen[i].roughness;
            s.confidence(x, y) = std::max(s.confidence(x, y), covered);
        }
}

}  // namespace

void update_appearance(const Canvas& canvas, std::span<const TileIndex> tiles, Surface& surface,
                       const AppearanceOptions& options, const Progress& progress) {
    validate(options);
    TP_REQUIRE(surface.height_mm.region() == canvas.region(), "the surface is this canvas's");
    const std::set<TileIndex> changed(tiles.begin(), tiles.end());
    std::set<TileIndex> wanted;
    for (const TileIndex tile : tiles)
        for (int y = std::max(tile.y - 1, 0); y <= std::min(tile.y + 1, canvas.wet().rows() - 1); ++y)
            for (int x = std::max(tile.x - 1, 0); x <= std::min(tile.x + 1, canvas.wet().columns() - 1); ++x)
                wanted.insert({x, y});
    const std::vector<TileIndex> all(wanted.begin(), wanted.end());
    std::mutex reporting;
    int done = 0;
    parallel_for(0, static_cast<int>(all.size()), 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            const TileIndex tile = all[static_cast<std::size_t>(i)];
            update_tile(canvas, tile, !changed.contains(tile), surface, options);
        }
        const std::lock_guard lock(reporting);
        done += end - begin;
        report(progress, "blend layers", done / static_cast<double>(all.size()));
    });
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
    std::set<TileIndex> painted;
    for (const PaintLayer* layer : layers_of(canvas))
        for (const TileIndex tile : layer->painted()) painted.insert(tile);
    const std::vector<TileIndex> tiles(painted.begin(), painted.end());
    update_appearance(canvas, tiles, surface, options, progress);
    return surface;
}

}  // namespace tangi
