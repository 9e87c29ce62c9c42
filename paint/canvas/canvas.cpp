#include "paint/canvas/canvas.h"

#include <algorithm>
#include <cmath>

#include "paint/canvas/quantise_volumes.h"
#include "paint/optics/kubelka_munk.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr float kDust_mm = 1e-6f;  // thinner paint is none: what rounding leaves where an eraser was

// The same paint, whatever its gloss, and with medium or without.
bool same_paint(const Pigment& a, const Pigment& b) {
    const auto near = [&](const Spectrum& of_a, const Spectrum& of_b) {
        for (std::size_t band = 0; band < kBands; ++band) {
            const float full_a = of_a[band] / (1 - a.medium), full_b = of_b[band] / (1 - b.medium);
            if (std::abs(full_a - full_b) > 1e-3f * std::max(full_a, full_b)) return false;
        }
        return true;
    };
    return near(a.k, b.k) && near(a.s, b.s);
}

}  // namespace

bool same_scale(double a_mm, double b_mm) { return static_cast<float>(a_mm) == static_cast<float>(b_mm); }

Canvas::Canvas(std::shared_ptr<const Surface> dry, std::optional<double> mm_per_pixel)
    : dry_(std::move(dry)) {
    TP_REQUIRE(dry_ && dry_->width() > 0 && dry_->height() > 0,
               "a canvas is painted on a surface with pixels");
    mm_per_pixel_ = mm_per_pixel.value_or(dry_->mm_per_pixel);
    if (!(mm_per_pixel_ > 0) || !std::isfinite(mm_per_pixel_))
        fail("a canvas's pixels have a size above 0, not {} mm", mm_per_pixel_);
    if (dry_->scale_known && !same_scale(mm_per_pixel_, dry_->mm_per_pixel))
        fail("the painting's pixels are known to be {} mm, not {} mm", dry_->mm_per_pixel, mm_per_pixel_);
    if (dry_->scale_known) mm_per_pixel_ = dry_->mm_per_pixel;
    wet_ = PaintLayer(width(), height());
}

void Canvas::lie_on(std::shared_ptr<const Surface> dry) {
    const auto same_relief = [this](const Surface& other) {
        const auto &a = dry_->height_mm.pixels(), &b = other.height_mm.pixels();
        return other.width() == width() && std::equal(a.begin(), a.end(), b.begin(), b.end());
    };
    TP_REQUIRE(dry && dry->mm_per_pixel == dry_->mm_per_pixel && dry->scale_known == dry_->scale_known &&
                   same_relief(*dry),
               "the dry surface has the relief of the one before");
    dry_ = std::move(dry);
}

IngredientId Canvas::add(const Pigment& ingredient) {
    const auto found = std::find_if(ingredients_.begin(), ingredients_.end(), [&](const Pigment& p) {
        return p.name == ingredient.name && p.k == ingredient.k && p.s == ingredient.s &&
               p.specular == ingredient.specular && p.roughness == ingredient.roughness &&
               p.medium == ingredient.medium;
    });
    if (found != ingredients_.end()) return static_cast<IngredientId>(found - ingredients_.begin());
    if (ingredients_.size() >= kUpper) fail("a canvas holds at most {} different paints", kUpper);
    ingredients_.push_back(ingredient);
    return static_cast<IngredientId>(ingredients_.size() - 1);
}

void Canvas::mark_dirty(TileIndex tile, const Region& part) {
    Region& all = dirty_.try_emplace(tile, Region{}).first->second;
    all = united(all, part);
}

void Canvas::mark_settled(TileIndex tile, const Region& part) {
    Region& all = settled_.try_emplace(tile, Region{}).first->second;
    all = united(all, part);
}

std::vector<Region> Canvas::take_dirty() {
    for (const auto& [tile, part] : settled_) mark_dirty(tile, part);
    settled_.clear();
    return take_painted();
}

std::vector<Region> Canvas::take_painted() {
    std::vector<Region> parts;
    for (const auto& [tile, part] : dirty_) parts.push_back(part);
    dirty_.clear();
    return parts;
}

std::vector<Region> Canvas::take_settled(std::size_t most) {
    std::vector<Region> parts;
    while (parts.size() < most && has_settled()) {
        parts.push_back(settled_.begin()->second);
        settled_.erase(settled_.begin());
    }
    return parts;
}

void Canvas::confine(std::shared_ptr<const Image<float>> mask) {
    TP_REQUIRE(!mask || mask->region() == region(), "a mask has the size of its canvas");
    if (mask)
        for (const float part : mask->pixels())
            if (!(part >= 0 && part <= 1)) fail("a mask holds {}; coverage is 0 to 1", part);
    mask_ = std::move(mask);
}

void Canvas::relief_mm(const Region& region, float* out, std::size_t stride) const {
    TP_REQUIRE(intersection(region, this->region()) == region, "the region lies on the canvas");
    const auto unit_mm = static_cast<float>(height_unit_mm());
    for (int y = region.y0; y < region.y1; ++y) {
        float* to = out + static_cast<std::size_t>(y - region.y0) * stride;
        const auto from = dry_->height_mm.row(y);
        for (int x = region.x0; x < region.x1; ++x)
            to[x - region.x0] += from[static_cast<std::size_t>(x)] * unit_mm;
    }
    for (const DriedLayer& layer : dried_) layer.paint.add_thickness_mm(region, out, stride);
}

std::vector<double> Canvas::volumes_mm3() const {
    std::vector<double> sums = tangi::volumes_mm3(wet_, ingredients_.size(), mm_per_pixel());
    for (const DriedLayer& layer : dried_) {
        const auto more = tangi::volumes_mm3(layer.paint, ingredients_.size(), mm_per_pixel());
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += more[i];
    }
    return sums;
}

std::size_t Canvas::bytes() const {
    std::size_t sum = sizeof *this + wet_.bytes();
    for (const DriedLayer& layer : dried_) sum += layer.paint.bytes();
    return sum;
}

std::shared_ptr<const Surface> in_scale_of(const Canvas& canvas, std::shared_ptr<const Surface> surface) {
    const auto unit_mm = static_cast<float>(canvas.height_unit_mm());
    if (unit_mm == 1) return surface;
    auto scaled = std::make_shared<Surface>(*surface);
    for (float& height : scaled->height_mm.pixels()) height *= unit_mm;
    scaled->mm_per_pixel = canvas.mm_per_pixel();
    scaled->scale_known = canvas.scale_known();
    Photography& p = scaled->photography;
    p.photos.clear();
    p.light_model.reset();
    p.beams.reset();
    for (auto* mm : {&p.rig.camera_distance_mm, &p.rig.light_distance_mm})
        if (*mm) **mm *= unit_mm;
    p.rig.camera_axis_mm *= unit_mm;
    p.rig.surface_above_mm *= unit_mm;
    p.rig.bend_per_mm /= unit_mm;
    return scaled;
}

std::map<std::string, double> volumes_by_name(const std::vector<Pigment>& ingredients,
                                              const std::vector<double>& mm3) {
    TP_REQUIRE(mm3.size() <= ingredients.size(), "volumes of these ingredients");
    std::map<std::string, double> sums;
    std::map<std::string, std::vector<const Pigment*>> known;  // different paints of a name
    for (std::size_t i = 0; i < mm3.size(); ++i) {
        const Pigment& paint = ingredients[i];
        std::vector<const Pigment*>& others = known[paint.name];
        const auto found = std::ranges::find_if(others, [&](const auto* p) { return same_paint(*p, paint); });
        const auto before = found - others.begin();
        if (found == others.end()) others.push_back(&paint);
        if (!(mm3[i] > 0)) continue;
        const auto medium = static_cast<double>(paint.medium);
        sums[before == 0 ? paint.name : fmt::format("{} ({})", paint.name, before + 1)] +=
            (1 - medium) * mm3[i];
        if (medium > 0) sums[kClearMedium] += medium * mm3[i];
    }
    return sums;
}

namespace {

// Volumes of ingredients in one of the films of a spot, summed over its pixels [mm].
struct FilmAt {
    std::vector<float> mm;
    float all = 0;

    explicit FilmAt(const Canvas& canvas) : mm(canvas.ingredients().size(), 0.0f) {}

    void add(const Canvas& canvas, int x, int y, IngredientId film) {
        const auto& tile = canvas.wet().tile({x / kTileSize, y / kTileSize});
        const auto pixel = static_cast<std::size_t>((y % kTileSize) * kTileSize + x % kTileSize);
        for (std::size_t id = 0; tile && id < mm.size(); ++id) {
            const auto plane = tile->plane(static_cast<IngredientId>(id | film));
            if (plane.empty()) continue;
            const float there = std::max(plane[pixel], 0.0f);  // rounding may leave a little less
            mm[id] += there;
            all += there;
        }
    }
};

// [1] Part of `upper` in the mixture with `lower` that looks most like a film of `upper`, so thick, over much
// of `lower`: least colour difference in daylight, by golden section (Kiefer 1953).
double part_that_shows(const std::vector<Pigment>& paints, const FilmAt& upper, const FilmAt& lower,
                       double thickness_mm) {
    const Medium above = mix(paints, upper.mm), below = mix(paints, lower.mm);
    const Lab seen =
        lab_under(film_look(above, static_cast<float>(thickness_mm), opaque_look(below)), Illuminant::d65);
    const auto off = [&](double part) {
        Medium mixed;
        for (std::size_t i = 0; i < kBands; ++i) {
            mixed.k[i] = static_cast<float>(part * above.k[i] + (1 - part) * below.k[i]);
            mixed.s[i] = static_cast<float>(part * above.s[i] + (1 - part) * below.s[i]);
        }
        return delta_e_2000(lab_under(opaque_look(mixed), Illuminant::d65), seen);
    };
    constexpr double kGolden = 0.6180339887498949;
    double low = 0, high = 1;
    for (int step = 0; step < 24; ++step) {
        const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
        if (off(a) < off(b))
            high = b;
        else
            low = a;
    }
    constexpr double kAlone = 1e-3;  // [1] one film as good as alone
    const double part = (low + high) / 2;
    return part < kAlone ? 0 : part > 1 - kAlone ? 1 : part;
}

}  // namespace

Recipe recipe_at(const Canvas& canvas, double x, double y, double radius_px) {
    const double radius = std::max(radius_px, 0.5);
    const Region box = intersection(
        {static_cast<int>(std::floor(x - radius)), static_cast<int>(std::floor(y - radius)),
         static_cast<int>(std::ceil(x + radius)) + 1, static_cast<int>(std::ceil(y + radius)) + 1},
        canvas.region());
    FilmAt lower(canvas), upper(canvas);
    int pixels = 0;
    for (int py = box.y0; py < box.y1; ++py)
        for (int px = box.x0; px < box.x1; ++px) {
            if ((px - x) * (px - x) + (py - y) * (py - y) > radius * radius) continue;
            ++pixels;
            lower.add(canvas, px, py, 0);
            upper.add(canvas, px, py, kUpper);
        }
    Recipe recipe;
    const double all = double(lower.all) + upper.all;
    if (!(all > 0)) return recipe;
    recipe.thickness_mm = all / pixels;
    const double on_top = !(upper.all > 0) ? 0
                          : !(lower.all > 0)
                              ? 1
                              : part_that_shows(canvas.ingredients(), upper, lower, upper.all / pixels);
    for (std::size_t id = 0; id < upper.mm.size(); ++id) {
        const double part = (lower.all > 0 ? (1 - on_top) * lower.mm[id] / lower.all : 0) +
                            (upper.all > 0 ? on_top * upper.mm[id] / upper.all : 0);
        if (part > 0) recipe.portions.push_back({static_cast<IngredientId>(id), part});
    }
    return recipe;
}

std::string free_layer_name(const Canvas& canvas, const std::string& name) {
    const auto taken = [&](const std::string& wanted) {
        return wanted == "wet" ||
               wanted == "dry" ||  // what files and lists call those that are no such layer
               std::ranges::any_of(canvas.dried(), [&](const auto& layer) { return layer.name == wanted; });
    };
    if (!taken(name)) return name;
    std::string stem = name;
    unsigned long number = 1;
    const auto space = name.rfind(' ');
    const bool numbered = space != std::string::npos && space + 1 < name.size() && name.size() - space <= 7 &&
                          name.find_first_not_of("0123456789", space + 1) == std::string::npos;
    if (numbered) {
        stem = name.substr(0, space);
        number = std::stoul(name.substr(space + 1));
    }
    for (;;)
        if (std::string next = fmt::format("{} {}", stem, ++number); !taken(next)) return next;
}

namespace {

// What part of either film of a tile is a share of all of its paint, from below: what lies above stays above.
struct FilmShares {
    std::vector<float> mixed, upper;  // [1] of each pixel
};
FilmShares shares_of(const PaintTile& tile, double share) {
    const auto fraction = static_cast<float>(share);
    FilmShares shares{std::vector<float>(PaintTile::kPixels, fraction),
                      std::vector<float>(PaintTile::kPixels, fraction)};
    if (fraction == 1 || !tile.has_upper()) return shares;
    std::vector<float> mixed_mm(PaintTile::kPixels), upper_mm(PaintTile::kPixels);
    for (const IngredientId id : tile.ingredients) {
        const auto plane = tile.plane(id);
        std::vector<float>& sum = is_upper(id) ? upper_mm : mixed_mm;
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += plane[i];
    }
    for (std::size_t i = 0; i < mixed_mm.size(); ++i) {
        const float wanted = fraction * (mixed_mm[i] + upper_mm[i]), below = std::min(wanted, mixed_mm[i]);
        shares.mixed[i] = mixed_mm[i] > 0 ? below / mixed_mm[i] : 0;
        shares.upper[i] = upper_mm[i] > 0 ? (wanted - below) / upper_mm[i] : 0;
    }
    return shares;
}

// Pixels of a tile, from the first of each run to behind its last.
using PixelRuns = std::vector<std::pair<std::size_t, std::size_t>>;

template <class Rows>
PixelRuns runs_within(const Rows& rows, const Region& tile) {
    PixelRuns runs;
    for (int y = tile.y0; y < tile.y1; ++y)
        for (const RowSpan& span : rows[static_cast<std::size_t>(y)]) {
            const int x0 = std::max(span.begin, tile.x0), x1 = std::min(span.end, tile.x1);
            const auto first = static_cast<std::size_t>((y - tile.y0) * kTileSize + x0 - tile.x0);
            if (x1 > x0) runs.emplace_back(first, first + static_cast<std::size_t>(x1 - x0));
        }
    return runs;
}

// Whether there is more paint than dust.
bool lies(const PaintTile& tile, const PixelRuns& runs) {
    return std::ranges::any_of(tile.ingredients, [&](IngredientId id) {
        const auto plane = tile.plane(id);
        return std::ranges::any_of(runs, [&](const auto& run) {
            return std::any_of(plane.begin() + static_cast<std::ptrdiff_t>(run.first),
                               plane.begin() + static_cast<std::ptrdiff_t>(run.second),
                               [](float mm) { return mm > kDust_mm; });
        });
    });
}

void move_share(PaintTile& from, PaintTile& to, double share, const PixelRuns& runs) {
    const FilmShares shares = shares_of(from, share);
    for (const IngredientId id : from.ingredients) {
        const std::span<float> source = from.writable_plane(id), target = to.writable_plane(id);
        const std::vector<float>& part = is_upper(id) ? shares.upper : shares.mixed;
        float owed = 0;  // [mm] what rounding to the grid left wet: given by the next pixels
        for (const auto& [begin, end] : runs)
            for (std::size_t i = begin; i < end; ++i) {
                const float wanted = source[i] * part[i];
                const float rounded = wanted > 0 ? std::min(on_grid(wanted + owed), source[i]) : 0.0f;
                const float moved = part[i] == 1 ? source[i] : rounded;
                owed += wanted - moved;
                target[i] += moved;
                source[i] -= moved;
            }
    }
}

}  // namespace

std::string dry(Canvas& canvas, const std::string& name, const CanvasPart& where, double share) {
    if (!(share > 0 && share <= 1)) fail("drying: part = {} is outside (0, 1]", share);
    const auto rows = rows_of(where, canvas.width(), canvas.height(), canvas.mm_per_pixel());
    PaintLayer &wet = canvas.writable_wet(), *dried = nullptr;
    auto& layers = canvas.writable_dried();
    for (const TileIndex at : canvas.wet().painted()) {
        const PixelRuns runs = runs_within(rows, wet.region_of(at));
        if (!lies(*canvas.wet().tile(at), runs)) continue;
        if (!dried) {
            layers.push_back({free_layer_name(canvas, name), PaintLayer(canvas.width(), canvas.height())});
            dried = &layers.back().paint;
        }
        PaintTile &from = wet.writable(at), &to = dried->writable(at);
        move_share(from, to, share, runs);
        from.drop_empty();
        to.drop_empty();
        if (from.ingredients.empty()) wet.set_tile(at, nullptr);
        if (to.ingredients.empty()) dried->set_tile(at, nullptr);
        canvas.mark_dirty(at);
    }
    if (dried && dried->empty()) {  // less than can be told
        layers.pop_back();
        dried = nullptr;
    }
    return dried ? layers.back().name : std::string();
}

void lift_off(Canvas& canvas, const std::string& name) {
    auto& layers = canvas.writable_dried();
    const auto found = std::find_if(layers.rbegin(), layers.rend(),
                                    [&](const DriedLayer& layer) { return layer.name == name; });
    if (found == layers.rend()) {
        std::string names;
        for (const DriedLayer& layer : layers) names += (names.empty() ? "" : ", ") + layer.name;
        fail("there is no dried layer '{}'; there are: {}", name, names.empty() ? "none" : names);
    }
    for (const TileIndex at : found->paint.painted()) canvas.mark_dirty(at);
    layers.erase(std::next(found).base());
}

}  // namespace tangi
