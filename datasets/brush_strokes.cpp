#include "datasets/brush_strokes.h"

#include <algorithm>

#include "surface/base/error.h"

namespace tangi::procedural {

namespace {

constexpr float kBristleMm = 0.45f;  // width of a streak
constexpr float kFilling = 0.4f;     // part of the relief below that a stroke levels

float reach(const Stroke& stroke) { return stroke.length_mm / 2 + 1.5f * stroke.half_width_mm; }

struct Place {
    float u, v;  // [mm] along the arc from its middle, and to its left
};

Place on_arc(const Stroke& stroke, float dx, float dy) {
    const float x = dx * stroke.cos + dy * stroke.sin, y = dy * stroke.cos - dx * stroke.sin;
    if (std::abs(stroke.curvature) < 1e-5f) return {x, y};
    const float sign = stroke.curvature > 0 ? 1.0f : -1.0f;
    const float radius = sign / stroke.curvature, to_centre = radius - sign * y;
    return {radius * std::atan2(x, to_centre), sign * (radius - std::hypot(x, to_centre))};
}

}  // namespace

void apply(const Stroke& stroke, float x_mm, float y_mm, PaintSample& sample) {
    const float dx = x_mm - stroke.x_mm, dy = y_mm - stroke.y_mm;
    if (dx * dx + dy * dy > reach(stroke) * reach(stroke)) return;
    const auto [u, v] = on_arc(stroke, dx, dy);
    if (std::abs(v) > 1.4f * stroke.half_width_mm) return;
    const float s = u + stroke.length_mm / 2;

    // Streaks of the bristles: fine across, long along the stroke.
    const float coarse = noise(v / kBristleMm, s / (12 * kBristleMm), hash(stroke.seed, 1));
    const float fine = noise(2.3f * v / kBristleMm, s / (6 * kBristleMm), hash(stroke.seed, 2));
    const float bristle = 0.65f * coarse + 0.35f * fine;

    // Outline: q = 1 at the rim; round at the start, ragged at the end.
    const float side = 0.8f * v / stroke.half_width_mm;  // both sides differ, without a step between them
    const float wobble = noise(s / (2 * stroke.half_width_mm), side, hash(stroke.seed, 3));
    const float half_width = stroke.half_width_mm * (1 + 0.18f * wobble - 0.25f * u / stroke.length_mm);
    const float half_length = stroke.length_mm / 2 + (u > 0 ? 0.45f : 0.1f) * stroke.half_width_mm * coarse;
    const float cap = (u > 0 ? 1.3f : 0.9f) * half_width;
    const float beyond = std::max(std::abs(u) - (half_length - cap), 0.0f) / cap;
    const float q = std::hypot(beyond, v / half_width);
    if (q >= 1) return;
    const float edge_mm = std::clamp(0.35f * stroke.half_width_mm, 0.3f, 0.8f);
    const float wet = stroke.load - 0.9f * s / stroke.length_mm + 0.6f * bristle;
    const float cover = smooth_step(0, edge_mm, (1 - q) * half_width) * smooth_step(-0.2f, 0.2f, wet);
    if (cover <= 0) return;

    // Paint is pushed aside into a rim, and more of it is left where the brush lifts off.
    const float rim_at = (q - 0.72f) / 0.17f;
    const float along = 0.6f + 0.6f * noise(s / 3, side, hash(stroke.seed, 4));
    const float end = 1 + (u > 0 ? 0.7f : -0.6f) * std::min(beyond, 1.0f);
    const float rim = std::exp(-rim_at * rim_at) * std::max(along, 0.0f) * end;
    const float body = stroke.thickness_mm * (0.75f + 0.75f * bristle);

    sample.height_mm =
        mix(sample.height_mm, stroke.level_mm, kFilling * cover) + cover * (body + stroke.ridge_mm * rim);
    const float opacity = smooth_step(0.03f, 0.5f, cover);
    const float streak = std::clamp(0.4f + 0.9f * coarse, 0.0f, 1.0f);
    sample.diffuse = glm::vec3(1 - opacity) * sample.diffuse +
                     opacity * ((1 - streak) * stroke.first + streak * stroke.second);
    sample.specular = mix(sample.specular, stroke.specular, opacity);
    sample.roughness = mix(sample.roughness, stroke.roughness * (1 - 0.15f * bristle), opacity);
    sample.specular_colour += opacity * (Rgb(1) - sample.specular_colour);
}

StrokeGrid::StrokeGrid(std::vector<Stroke> strokes, float half_width_mm, float half_height_mm)
    : strokes_(std::move(strokes)), half_width_mm_(half_width_mm), half_height_mm_(half_height_mm) {
    TP_REQUIRE(half_width_mm > 0 && half_height_mm > 0, "a picture has an extent");
    // Cells of the size of a brush, but no more than a million of them.
    const float area = 4 * half_width_mm * half_height_mm;
    cell_mm_ = std::max(3.0f, std::sqrt(area / 1e6f));
    cells_ = Image<std::vector<int>>(static_cast<int>(2 * half_width_mm / cell_mm_) + 1,
                                     static_cast<int>(2 * half_height_mm / cell_mm_) + 1);
    for (int i = 0; i < static_cast<int>(strokes_.size()); ++i) {
        const Stroke& stroke = strokes_[static_cast<std::size_t>(i)];
        // One cell more on all sides serves points just outside the picture.
        const float r = reach(stroke) + cell_mm_;
        const auto cell = [&](float mm, float half) {
            return static_cast<int>(std::floor((mm + half) / cell_mm_));
        };
        const int x1 = std::min(cell(stroke.x_mm + r, half_width_mm_), cells_.width() - 1);
        const int y1 = std::min(cell(stroke.y_mm + r, half_height_mm_), cells_.height() - 1);
        for (int y = std::max(cell(stroke.y_mm - r, half_height_mm_), 0); y <= y1; ++y)
            for (int x = std::max(cell(stroke.x_mm - r, half_width_mm_), 0); x <= x1; ++x) {
                const float cx = (static_cast<float>(x) + 0.5f) * cell_mm_ - half_width_mm_ - stroke.x_mm;
                const float cy = (static_cast<float>(y) + 0.5f) * cell_mm_ - half_height_mm_ - stroke.y_mm;
                if (std::hypot(cx, cy) < r + cell_mm_) cells_(x, y).push_back(i);
            }
    }
}

void StrokeGrid::apply_all(float x_mm, float y_mm, PaintSample& sample) const {
    const int x = static_cast<int>((x_mm + half_width_mm_) / cell_mm_);
    const int y = static_cast<int>((y_mm + half_height_mm_) / cell_mm_);
    for (const int i : cells_.clamped(x, y)) apply(strokes_[static_cast<std::size_t>(i)], x_mm, y_mm, sample);
}

}  // namespace tangi::procedural
