// painter_probe.cpp: of the painter: what is looked at and measured, and the map of horizons.
#include "viewer/model/painter.h"

#include <algorithm>
#include <chrono>
#include <numeric>

namespace tangi {

namespace {

constexpr auto kBetweenWeighings = std::chrono::milliseconds(100);

constexpr std::pair<const char*, float StandardErrors::*> kErrors[] = {
    {"diffuse", &StandardErrors::diffuse},
    {"height", &StandardErrors::height_mm},
    {"roughness", &StandardErrors::roughness},
    {"slope", &StandardErrors::slope},
    {"specular", &StandardErrors::specular}};

// No dried paint in the pixel's tile.
bool lies_bare(const Canvas& canvas, int x, int y) {
    const TileIndex at{x / PaintTile::kSize, y / PaintTile::kSize};
    return std::ranges::none_of(canvas.dried(),
                                [&](const DriedLayer& layer) { return layer.paint.tile(at) != nullptr; });
}

}  // namespace

Probe Painter::look_at(int x, int y, double radius_px) {
    const Canvas& seen = shown_ ? *shown_ : session_.canvas();
    Probe probe{.x = x, .y = y, .material = material_at(surface(), x, y)};
    const Recipe recipe = recipe_at(seen, x, y, radius_px);
    probe.paint_mm = recipe.thickness_mm;
    for (const Portion& portion : recipe.portions)
        probe.recipe.emplace_back(seen.ingredients()[portion.ingredient].name, portion.part);
    if (errors_ && probe.paint_mm == 0 && lies_bare(seen, x, y)) {
        const std::span<const float> values = errors_->at(x, y);
        for (std::size_t c = 0; c < values.size(); ++c)
            for (const auto& [name, member] : kErrors)
                if (errors_->info().channels[c] == name) probe.errors.*member = values[c];
    }
    return probe;
}

// What is left on the brush: several times a second while it paints.
void Painter::weigh_brush() {
    const Brush* brush = session_.brush();
    if (!brush) own_.on_brush = {};
    if (!brush) return;
    const auto now = std::chrono::steady_clock::now();
    if (own_.stroking && now - weighed_ < kBetweenWeighings) return;
    weighed_ = now;
    if (weighed_seed_ != brush->seed() || full_mm3_ == 0) full_mm3_ = brush->full_mm3();
    weighed_seed_ = brush->seed();
    const Canvas* canvas = session_.brush_place() == Place::palette ? session_.board() : &session_.canvas();
    if (!canvas) return;
    const std::vector<double> mm3 = brush->volumes_mm3(canvas->ingredients().size());
    const double sum = std::accumulate(mm3.begin(), mm3.end(), 0.0);
    own_.on_brush = {.fill = full_mm3_ > 0 ? sum / full_mm3_ : 0};
    if (!(own_.on_brush.fill > 0)) return;
    std::vector<Pigment> paints;
    std::vector<float> parts;
    for (std::size_t i = 0; i < mm3.size(); ++i) {
        if (!(mm3[i] > 0.001 * sum)) continue;
        paints.push_back(canvas->ingredients()[i]);
        parts.push_back(static_cast<float>(mm3[i] / sum));
        own_.on_brush.recipe.emplace_back(paints.back().name, mm3[i] / sum);
    }
    std::ranges::sort(own_.on_brush.recipe, std::greater(), &std::pair<std::string, double>::second);
    own_.on_brush.colour = thick_film(paints, parts, look_.illuminant);
}

void Painter::probe(int x, int y) {
    post([this, x, y] {
        if (x < 0 || y < 0 || x >= surface().width() || y >= surface().height()) return;
        Probe probe = look_at(x, y, 0.5);
        const std::lock_guard lock(mutex_);
        news_.probe = std::move(probe);
    });
}

void Painter::pick(double x, double y, double radius_px) {
    post([this, x, y, radius_px] {
        const int px = static_cast<int>(std::lround(x)), py = static_cast<int>(std::lround(y));
        if (px < 0 || py < 0 || px >= surface().width() || py >= surface().height()) return;
        Probe picked = look_at(px, py, std::max(radius_px, 0.5));
        const std::lock_guard lock(mutex_);
        news_.picked = std::move(picked);
    });
}

void Painter::profile(const glm::dvec2& from_px, const glm::dvec2& to_px) {
    post([this, from_px, to_px] {
        HeightProfile profile = height_profile(surface(), from_px, to_px);
        if (!profile.scale_known && mm_per_pixel_ != 1) profile = in_mm(std::move(profile), mm_per_pixel_);
        const std::lock_guard lock(mutex_);
        news_.profile = std::move(profile);
    });
}

void Painter::statistics(const Region& region) {
    post([this, region] {
        RegionStatistics statistics = statistics_of(surface(), region);
        statistics.height_mm.mean *= session_.canvas().height_unit_mm();
        statistics.height_mm.deviation *= session_.canvas().height_unit_mm();
        const std::lock_guard lock(mutex_);
        news_.statistics = statistics;
    });
}

// The heights are copied here; the map, which takes seconds, is made beside.
void Painter::make_horizon() {
    post([this] {
        horizon_stop_ = true;
        if (horizon_thread_.joinable()) horizon_thread_.join();
        horizon_stop_ = false;
        CoarseHeights heights = coarse_heights(surface().height_mm, surface().mm_per_pixel);
        horizon_thread_ = std::thread([this, heights = std::move(heights)] {
            try {
                HorizonMap map =
                    horizon_map(heights, [this](std::string_view, double) { return !horizon_stop_; });
                const std::lock_guard lock(mutex_);
                news_.horizon = std::move(map);
            } catch (const Cancelled&) {
                return;
            }
            wake_();
        });
    });
}

}  // namespace tangi
