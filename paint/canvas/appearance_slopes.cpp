#include "paint/canvas/appearance_slopes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "paint/canvas/appearance_rows.h"
#include "surface/math/portable_math.h"

namespace tangi {

namespace {

constexpr float kLevelled_mm = 0.02f;  // of a layer that levels lets 37 % of the detail below through

// The thickness of all layers in a region and two pixels around it, as far as the canvas goes.
class Thickness {
public:
    Thickness(const std::vector<const PaintLayer*>& layers, const Region& region, const Region& canvas)
        : region_(intersection(grown(region), canvas)), values_(region_.width(), region_.height()) {
        for (const PaintLayer* layer : layers)
            layer->add_thickness_mm(region_, values_.data(), static_cast<std::size_t>(region_.width()));
    }
    float operator()(int x, int y) const { return *from(x, y); }
    const float* from(int x, int y) const { return &values_(x - region_.x0, y - region_.y0); }

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
    const float through = portable::exp(-levelling_mm / kLevelled_mm);
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

}  // namespace

void update_normals(const Canvas& canvas, const std::vector<const PaintLayer*>& layers, const Region& region,
                    const Shown& shown) {
    const Surface& dry = canvas.dry();
    const Region all = canvas.region();
    const Thickness thickness(layers, region, all);
    std::vector<const PaintLayer*> levelling;
    for (const DriedLayer& layer : canvas.dried())
        if (layer.levels) levelling.push_back(&layer.paint);
    const Thickness level(levelling, region, all);
    const auto one = [&](int x, int y) {
        const Slope added = slope_at(thickness, x, y, all, canvas.mm_per_pixel());
        Vec3& normal = shown.at(&Surface::normal, x, y);
        normal = dry.normal(x, y);
        if (added.x == 0 && added.y == 0 && !(level(x, y) > 0)) return;
        const Slope below = slope_below(dry, x, y, levelled_at(level, x, y, all));
        normal = normal_of({below.x + added.x, below.y + added.y});
    };
    // Away from the canvas's sides, and where nothing levels, many at once.
    const int first = std::clamp(all.x0 + 1, region.x0, region.x1),
              last = levelling.empty() ? std::clamp(all.x1 - 1, first, region.x1) : first;
    const auto mm = static_cast<float>(canvas.mm_per_pixel());
    for (int y = region.y0; y < region.y1; ++y) {
        const auto [up, down] = beside(y, all.y0, all.y1);
        for (int x = region.x0; x < first; ++x) one(x, y);
        if (first < last)
            tilt_rows(static_cast<std::size_t>(last - first),
                      {thickness.from(first + 1, y), thickness.from(first - 1, y), thickness.from(first, up),
                       thickness.from(first, down), 1 / (2 * mm),
                       1 / (static_cast<float>(std::max(down - up, 1)) * mm)},
                      &dry.normal(first, y), &shown.at(&Surface::normal, first, y));
        for (int x = last; x < region.x1; ++x) one(x, y);
    }
}

}  // namespace tangi
