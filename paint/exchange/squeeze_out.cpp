#include "paint/exchange/squeeze_out.h"

#include <algorithm>
#include <cmath>

#include "surface/base/vector_clones.h"

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

// One row of one paint: what is not pressed out of a pixel stays, and what is pressed out of its neighbours
// comes. Nothing is pressed out of the box's border, so rows and columns beyond it may be those at it.
struct PressedRow {
    const float *old, *old_above, *old_below;
    const float *part_x, *part_y, *part_above, *part_below;
};
TP_VECTOR_CLONES
void press_row(int width, const PressedRow& r, float* __restrict paint, float* __restrict total) {
    const float* __restrict old = r.old, * __restrict px = r.part_x, * __restrict py = r.part_y;
    const auto now = [&](int x, int left, int right) TP_INLINE_LAMBDA {
        return old[x] - old[x] * (std::abs(px[x]) + std::abs(py[x])) + old[left] * std::max(px[left], 0.0f) +
               old[right] * std::max(-px[right], 0.0f) + r.old_above[x] * std::max(r.part_above[x], 0.0f) +
               r.old_below[x] * std::max(-r.part_below[x], 0.0f);
    };
    const auto put = [&](int x, float mm) TP_INLINE_LAMBDA {
        paint[x] = mm;
        total[x] += mm;
    };
    put(0, now(0, 0, std::min(1, width - 1)));
    for (int x = 1; x < width - 1; ++x) put(x, now(x, x - 1, x + 1));
    if (width > 1) put(width - 1, now(width - 1, width - 2, width - 1));
}

}  // namespace

void find_outwards(const StandingTip& tip, const StepBox& box, Outwards& out) {
    const auto width = static_cast<std::size_t>(box.width);
    out.x.assign(width * static_cast<std::size_t>(box.height), 0.0f);
    out.y.assign(out.x.size(), 0.0f);
    const float c = tip.cosine, s = tip.sine;
    const bool all_around = tip.towards_x == 0 && tip.towards_y == 0;
    // Where the dome is so low that the pressure ends farther away than the band is wide, nothing leaves.
    const float inner = tip.touched - tip.map.steepest * tip.narrowing * tip.band_px;
    for_rows_of_step(box.width, box.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const RowSpan span = box.bristles[static_cast<std::size_t>(y)];
            for (int x = span.begin; x < span.end; ++x) {
                if (box.underside_mm[at(y, box.underside_stride) + static_cast<std::size_t>(x)] >= kOutside)
                    continue;
                const float dx = static_cast<float>(x) - tip.x, dy = static_cast<float>(y) - tip.y;
                const float u = (dx * c + dy * s) * tip.narrowing + static_cast<float>(tip.map.width / 2);
                const float v = (dy * c - dx * s) * tip.narrowing + static_cast<float>(tip.map.height / 2);
                const float dome = dome_at(tip.map, u, v);
                if (dome < inner) continue;
                const float gu = dome_at(tip.map, u + 1, v) - dome_at(tip.map, u - 1, v),
                            gv = dome_at(tip.map, u, v + 1) - dome_at(tip.map, u, v - 1);
                const float steepness = std::sqrt(gu * gu + gv * gv);  // over two texels
                if (steepness < 1e-6f) continue;
                const float nx = (gu * c - gv * s) / steepness, ny = (gu * s + gv * c) / steepness;
                const float beyond_px = (dome - tip.touched) * 2 / (steepness * tip.narrowing);
                const float near = std::clamp(1 + beyond_px / tip.band_px, 0.0f, 1.0f);
                const float side =
                    all_around ? 1.0f : std::max(nx * tip.towards_x + ny * tip.towards_y, 0.0f);
                const float speed = near * near * std::clamp(1 - beyond_px, 0.0f, 1.0f) * side;
                const std::size_t i = at(y, width) + static_cast<std::size_t>(x);
                out.x[i] = speed * nx;
                out.y[i] = speed * ny;
            }
        }
    });
}

void squeeze_out(const StepBox& box, const Outwards& outwards, float squeeze_per_mm, float film_mm,
                 StepScratch& scratch) {
    const auto width = static_cast<std::size_t>(box.width);
    const std::size_t area = width * static_cast<std::size_t>(box.height);
    scratch.planes.resize(std::max(scratch.planes.size(), 3 * area));
    // Parts of each pixel's paint that go along the two axes, and the paint as it was.
    float *part_x = scratch.planes.data(), *part_y = part_x + area, *old = part_y + area;
    for_rows_of_step(box.width, box.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            for (int x = 0; x < box.width; ++x) {
                const std::size_t i = at(y, width) + static_cast<std::size_t>(x),
                                  k = at(y, box.canvas_stride) + static_cast<std::size_t>(x);
                part_x[i] = part_y[i] = 0;
                const bool inner = x > 0 && y > 0 && x + 1 < box.width && y + 1 < box.height;
                if (!inner || !(box.open[k] > 0) || (outwards.x[i] == 0 && outwards.y[i] == 0)) continue;
                const float part =
                    std::min(squeeze_per_mm * std::max(box.total_mm[k] - film_mm, 0.0f), kMostPressed);
                const float px = part * outwards.x[i], py = part * outwards.y[i];
                // Nothing leaves the canvas.
                if (box.open[px < 0 ? k - 1 : k + 1] > 0) part_x[i] = px;
                if (box.open[py < 0 ? k - box.canvas_stride : k + box.canvas_stride] > 0) part_y[i] = py;
            }
    });
    const auto row = [&](float* plane, int y) { return plane + at(std::clamp(y, 0, box.height - 1), width); };
    for_rows_of_step(box.width, box.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) std::fill_n(box.total_mm + at(y, box.canvas_stride), width, 0.0f);
    });
    for (float* paint : box.paint) {
        for_rows_of_step(box.width, box.height, [&](int begin, int end) {
            for (int y = begin; y < end; ++y)
                std::copy_n(paint + at(y, box.canvas_stride), width, old + at(y, width));
        });
        for_rows_of_step(box.width, box.height, [&](int begin, int end) {
            for (int y = begin; y < end; ++y) {
                const PressedRow rows{row(old, y),    row(old, y - 1),    row(old, y + 1),   row(part_x, y),
                                      row(part_y, y), row(part_y, y - 1), row(part_y, y + 1)};
                press_row(box.width, rows, paint + at(y, box.canvas_stride),
                          box.total_mm + at(y, box.canvas_stride));
            }
        });
    }
}

}  // namespace tangi
