#include "paint/session/mixing_board.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/base/error.h"
#include "surface/math/portable_math.h"

namespace tangi {

BoardSize default_board_size(double mm_per_pixel) {
    const BoardSize usual;
    const double width = std::clamp(usual.width_mm, 400 * mm_per_pixel, 1600 * mm_per_pixel);
    return {width, width * usual.height_mm / usual.width_mm};
}

Canvas make_board(const BoardSize& size, double mm_per_pixel) {
    const double width = std::round(size.width_mm / mm_per_pixel),
                 height = std::round(size.height_mm / mm_per_pixel);
    if (!(std::min(width, height) >= 8 && std::max(width, height) <= 8192))
        fail("a palette of {} x {} mm has {} x {} pixels of {} mm; it may have 8 to 8192 a side",
             size.width_mm, size.height_mm, width, height, mm_per_pixel);
    auto surface = std::make_shared<Surface>(static_cast<int>(width), static_cast<int>(height));
    surface->mm_per_pixel = mm_per_pixel;
    surface->scale_known = true;
    std::fill(surface->diffuse.pixels().begin(), surface->diffuse.pixels().end(), Rgb(0.8f));
    std::fill(surface->specular.pixels().begin(), surface->specular.pixels().end(), 0.04f);
    std::fill(surface->roughness.pixels().begin(), surface->roughness.pixels().end(), 0.1f);
    std::fill(surface->confidence.pixels().begin(), surface->confidence.pixels().end(), 1.0f);
    return Canvas(std::move(surface));
}

std::vector<PileEvent> laid_out(const std::vector<std::string>& paints, const BoardSize& size) {
    TP_REQUIRE(!paints.empty(), "there are paints to lay out");
    const double margin = 0.12 * std::min(size.width_mm, size.height_mm);
    const double x = size.width_mm / 2 - margin, y = size.height_mm / 2 - margin;
    const double length = 4 * y + 2 * x;  // up, across, down
    const double spacing = length / static_cast<double>(paints.size());
    std::vector<PileEvent> piles;
    for (std::size_t i = 0; i < paints.size(); ++i) {
        const double s = (static_cast<double>(i) + 0.5) * spacing;
        PileEvent pile;
        pile.paint = {{paints[i], 1}};
        pile.at = s < 2 * y           ? PointMm{-x, -y + s}
                  : s < 2 * y + 2 * x ? PointMm{-x + (s - 2 * y), y}
                                      : PointMm{x, y - (s - 2 * y - 2 * x)};
        pile.size_mm = std::min({24.0, 0.8 * spacing, 1.6 * margin});
        pile.height_mm = std::min(pile.height_mm, pile.size_mm / 8);
        piles.push_back(std::move(pile));
    }
    return piles;
}

namespace {

bool has_other_than(const std::vector<Portion>& recipe, const PaintTile& tile) {
    return std::ranges::any_of(tile.ingredients, [&](IngredientId id) {
        return is_upper(id) || std::ranges::none_of(recipe, [&](const Portion& portion) {
                   return portion.ingredient == paint_of(id);
               });
    });
}

// Of pixel `i` of the tile.
void mix_films(PaintTile& tile, std::size_t i) {
    for (const IngredientId id : std::vector(tile.ingredients)) {
        if (!is_upper(id)) continue;
        const float mm = tile.plane(id)[i];
        tile.writable_plane(id)[i] = 0;
        tile.writable_plane(paint_of(id))[i] += mm;
    }
}

}  // namespace

void lay_pile(Canvas& canvas, const std::vector<Portion>& recipe, PointMm at, double size_mm,
              double height_mm) {
    double parts = 0;
    for (const Portion& portion : recipe) parts += portion.part;
    if (!(parts > 0)) fail("a pile is made of parts of paint that sum to {}", parts);
    // A pile of less than three pixels is as wide as these, and lower: it has its volume wherever it lies.
    const double mm = canvas.mm_per_pixel(), true_radius = size_mm / mm / 2,
                 radius = std::max(true_radius, 1.5);
    const double lower = (true_radius * true_radius) / (radius * radius);
    const double cx = at.x / mm + (canvas.width() - 1) / 2.0, cy = (canvas.height() - 1) / 2.0 - at.y / mm;
    constexpr int size = PaintTile::kSize;
    PaintLayer& wet = canvas.writable_wet();
    const auto first = [&](double c) { return std::max(static_cast<int>(std::floor(c - radius)), 0); };
    const int x0 = first(cx), y0 = first(cy);
    const int x1 = std::min(static_cast<int>(std::ceil(cx + radius)) + 1, canvas.width());
    const int y1 = std::min(static_cast<int>(std::ceil(cy + radius)) + 1, canvas.height());
    if (x0 >= x1 || y0 >= y1) return;
    for (int ty = y0 / size; ty * size < y1; ++ty)
        for (int tx = x0 / size; tx * size < x1; ++tx) {
            const Region tile = wet.region_of({tx, ty});
            PaintTile& paint = wet.writable({tx, ty});
            const bool on_other = has_other_than(recipe, paint);
            for (int y = std::max(y0, tile.y0); y < std::min(y1, tile.y1); ++y)
                for (int x = std::max(x0, tile.x0); x < std::min(x1, tile.x1); ++x) {
                    const double r2 = ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (radius * radius);
                    if (!(r2 < 1)) continue;
                    const auto i = static_cast<std::size_t>((y - tile.y0) * size + x - tile.x0);
                    const double mm_there = height_mm * lower * (1 - r2),
                                 above = on_other ? std::min(mm_there, double(kUpper_mm)) / mm_there : 0;
                    if (on_other) mix_films(paint, i);
                    for (const Portion& portion : recipe) {
                        const double share = height_mm * lower * portion.part / parts * (1 - r2);
                        paint.writable_plane(portion.ingredient)[i] +=
                            static_cast<float>(share * (1 - above));
                        if (on_other)
                            paint.writable_plane(upper_of(portion.ingredient))[i] +=
                                static_cast<float>(share * above);
                    }
                }
            canvas.mark_dirty({tx, ty});
        }
}

PointMm free_place(const Canvas& board, double size_mm) {
    const int width = board.width(), height = board.height();
    const double mm = board.mm_per_pixel();
    // What lies in any box, by sums from the first corner on.
    Image<double> sums(width + 1, height + 1);
    Image<float> film(width, height);
    for (const TileIndex at : board.wet().painted()) {
        const Region r = board.wet().region_of(at);
        board.wet().add_thickness_mm(r, &film(r.x0, r.y0), static_cast<std::size_t>(width));
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            sums(x + 1, y + 1) =
                static_cast<double>(film(x, y)) + sums(x, y + 1) + sums(x + 1, y) - sums(x, y);
    const int side = std::clamp(static_cast<int>(std::ceil(size_mm / mm)), 1, std::min(width, height));
    const int step = std::max(side / 4, 1);
    PointMm best;
    double least = std::numeric_limits<double>::infinity(), nearest = least;
    for (int y = (height - side) / 2 % step; y + side <= height; y += step)
        for (int x = (width - side) / 2 % step; x + side <= width; x += step) {
            const double lies =
                std::max(sums(x + side, y + side) - sums(x, y + side) - sums(x + side, y) + sums(x, y), 0.0);
            const PointMm at{(x + (side - width) / 2.0) * mm, ((height - side) / 2.0 - y) * mm};
            const double away = portable::hypot(at.x, at.y), little = 1e-6 * side * side;
            if (lies < least - little || (lies <= least + little && away < nearest)) {
                least = std::min(lies, least);
                nearest = away;
                best = at;
            }
        }
    return best;
}

void wipe(Canvas& canvas) {
    for (const TileIndex at : canvas.wet().painted()) {
        canvas.writable_wet().set_tile(at, nullptr);
        canvas.mark_dirty(at);
    }
}

}  // namespace tangi
