#include "paint/press_out.h"

#include <algorithm>
#include <cmath>

namespace tangi {

namespace {

constexpr float kMostPressed = 0.3f;  // [1] of a pixel's paint in one step, along each axis

std::size_t at(int y, std::size_t stride) { return static_cast<std::size_t>(y) * stride; }

// Bilinear; the border's values beyond it.
float dome_at(const TipMap& map, float u, float v) {
    u = std::clamp(u, 0.0f, static_cast<float>(map.width) - 1.001f);
    v = std::clamp(v, 0.0f, static_cast<float>(map.height) - 1.001f);
    const int iu = static_cast<int>(u), iv = static_cast<int>(v);
    const float fu = u - static_cast<float>(iu), fv = v - static_cast<float>(iv);
    const TexelPair* texel = map.texels + iv * map.width + iu;
    return between<kDomeField>(texel[0], texel[map.width], fu, fv);
}

}  // namespace

void find_outwards(const StandingTip& tip, const StepBox& box, Outwards& out) {
    const auto width = static_cast<std::size_t>(box.width);
    out.x.assign(width * static_cast<std::size_t>(box.height), 0.0f);
    out.y.assign(out.x.size(), 0.0f);
    const float c = tip.cosine, s = tip.sine;
    const bool all_around = tip.towards_x == 0 && tip.towards_y == 0;
    for (int y = 0; y < box.height; ++y) {
        const RowSpan span = box.bristles[static_cast<std::size_t>(y)];
        for (int x = span.begin; x < span.end; ++x) {
            if (box.underside_mm[at(y, box.underside_stride) + static_cast<std::size_t>(x)] >= kOutside)
                continue;
            const float dx = static_cast<float>(x) - tip.x, dy = static_cast<float>(y) - tip.y;
            const float u = (dx * c + dy * s) * tip.narrowing + static_cast<float>(tip.map.width / 2);
            const float v = (dy * c - dx * s) * tip.narrowing + static_cast<float>(tip.map.height / 2);
            const float gu = dome_at(tip.map, u + 1, v) - dome_at(tip.map, u - 1, v),
                        gv = dome_at(tip.map, u, v + 1) - dome_at(tip.map, u, v - 1);
            const float steepness = std::sqrt(gu * gu + gv * gv);  // over two texels
            if (steepness < 1e-6f) continue;
            const float nx = (gu * c - gv * s) / steepness, ny = (gu * s + gv * c) / steepness;
            const float beyond_px = (dome_at(tip.map, u, v) - tip.touched) * 2 / (steepness * tip.narrowing);
            const float near = std::clamp(1 + beyond_px / tip.band_px, 0.0f, 1.0f);
            const float side = all_around ? 1.0f : std::max(nx * tip.towards_x + ny * tip.towards_y, 0.0f);
            const float speed = near * near * std::clamp(1 - beyond_px, 0.0f, 1.0f) * side;
            const std::size_t i = at(y, width) + static_cast<std::size_t>(x);
            out.x[i] = speed * nx;
            out.y[i] = speed * ny;
        }
    }
}

void press_out(const StepBox& box, const Outwards& outwards, float squeeze_per_mm, float film_mm,
               StepScratch& scratch) {
    const auto width = static_cast<std::size_t>(box.width);
    const std::size_t area = width * static_cast<std::size_t>(box.height);
    scratch.planes.resize(std::max(scratch.planes.size(), 3 * area));
    // Parts of each pixel's paint that go along the two axes, and the paint as it was.
    float *part_x = scratch.planes.data(), *part_y = part_x + area, *old = part_y + area;
    for (int y = 0; y < box.height; ++y)
        for (int x = 0; x < box.width; ++x) {
            const std::size_t i = at(y, width) + static_cast<std::size_t>(x),
                              k = at(y, box.canvas_stride) + static_cast<std::size_t>(x);
            part_x[i] = part_y[i] = 0;
            const bool inner = x > 0 && y > 0 && x + 1 < box.width && y + 1 < box.height;
            if (!inner || !(box.open[k] > 0)) continue;
            const float part =
                std::min(squeeze_per_mm * std::max(box.total_mm[k] - film_mm, 0.0f), kMostPressed);
            const float px = part * outwards.x[i], py = part * outwards.y[i];
            // Nothing leaves the canvas.
            if (box.open[px < 0 ? k - 1 : k + 1] > 0) part_x[i] = px;
            if (box.open[py < 0 ? k - box.canvas_stride : k + box.canvas_stride] > 0) part_y[i] = py;
        }
    for (int y = 0; y < box.height; ++y) std::fill_n(box.total_mm + at(y, box.canvas_stride), width, 0.0f);
    for (float* paint : box.paint) {
        for (int y = 0; y < box.height; ++y)
            std::copy_n(paint + at(y, box.canvas_stride), width, old + at(y, width));
        for (int y = 0; y < box.height; ++y)
            for (int x = 0; x < box.width; ++x) {
                const std::size_t i = at(y, width) + static_cast<std::size_t>(x),
                                  k = at(y, box.canvas_stride) + static_cast<std::size_t>(x);
                float now = old[i] - old[i] * (std::abs(part_x[i]) + std::abs(part_y[i]));
                if (x > 0) now += old[i - 1] * std::max(part_x[i - 1], 0.0f);
                if (x + 1 < box.width) now += old[i + 1] * std::max(-part_x[i + 1], 0.0f);
                if (y > 0) now += old[i - width] * std::max(part_y[i - width], 0.0f);
                if (y + 1 < box.height) now += old[i + width] * std::max(-part_y[i + width], 0.0f);
                paint[k] = now;
                box.total_mm[k] += now;
            }
    }
}

}  // namespace tangi
