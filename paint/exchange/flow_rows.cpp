#include "paint/exchange/flow_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

constexpr float kRounding =
    0.125f;  // [1] part of a bulge that flows to each side: a chequerboard is flat at once
constexpr float kMostSqueezed = 0.3f;  // [1] of a pixel's paint in one step, to each of two sides
// A slope is measured by an octagon: the larger component and this part [1] of the smaller one, at 45 degrees
// 1.08 times too large at most.
constexpr float kOctagon = 0.41421356f, kDiagonal = 0.70710678f;
constexpr float kTiny = 1e-9f;  // [mm] keeps 0 / 0 away

// [mm] What flows to a neighbour that is `drop` lower, `w` being what can flow at all. Paint flows down steps
// that are too steep; surface tension rounds off what bulges too much, and fills what lies below both
// neighbours, `beyond` being how much higher than here the pixel behind it is.
TP_INLINE float downhill(const TransferRates& r, float yield_mm, float w, float mobile, float bulge,
                         float drop, float beyond) {
    const float pit = std::min(drop, drop + beyond) - r.pit_mm;
    return std::max(r.flow * std::min(std::max(drop - yield_mm, 0.0f), w),
                    kRounding * std::max(std::min(bulge, drop), std::min(pit, mobile)));
}

template <class T>
TP_INLINE void load(T& value, const float* from) {
    std::memcpy(&value, from, sizeof value);
}

// As many pixels of all ingredients as T holds, from x on: flows are read once for all of them.
template <class T>
TP_INLINE void advect_some(int x, const Heading& m, const AdvectedRow& row, const FlowsAround& flows,
                           float* total) {
    // Copies, which nothing that is written can change.
    const RowOfEach row_old = row.old, row_above = row.above, row_below = row.below, row_now = row.now,
                    row_behind = m.sy < 0 ? row.below : row.above;
    const std::size_t count = row.count;
    const std::ptrdiff_t behind_x = x - m.sx;
    const Outflow& here = flows.here;
    T left, right, up, down, ahead, from_left, from_right, from_above, from_below, from_behind;
    load(left, here.left + x);
    load(right, here.right + x);
    load(up, here.up + x);
    load(down, here.down + x);
    load(ahead, here.ahead + x);
    load(from_left, here.right + x - 1);
    load(from_right, here.left + x + 1);
    load(from_above, flows.above.down + x);
    load(from_below, flows.below.up + x);
    load(from_behind, (m.sy < 0 ? flows.below.ahead : flows.above.ahead) + behind_x);
    const T out = left + right + up + down + ahead;
    T sum{};
    for (std::size_t i = 0; i < count; ++i) {
        const float* at = row_old[i] + x;
        T old, on_left, on_right, above, below, behind;
        load(old, at);
        load(on_left, at - 1);
        load(on_right, at + 1);
        load(above, row_above[i] + x);
        load(below, row_below[i] + x);
        load(behind, row_behind[i] + behind_x);
        const T now = old - old * out + on_left * from_left + on_right * from_right + above * from_above +
                      below * from_below + behind * from_behind;
        std::memcpy(row_now[i] + x, &now, sizeof now);
        sum += now;
    }
    std::memcpy(total + x, &sum, sizeof sum);
}

// The last columns are done twice rather than one by one: nothing that is read is written.
template <int kLanes>
TP_INLINE void advect_all(const RowSpan& span, const Heading& m, const AdvectedRow& row,
                          const FlowsAround& flows, float* total) {
    int x = span.begin;
    if (span.end - x < kLanes) {
        for (; x < span.end; ++x) advect_some<float>(x, m, row, flows, total);
        return;
    }
    for (; x + kLanes <= span.end; x += kLanes) advect_some<FloatLanes<kLanes>>(x, m, row, flows, total);
    if (span.end - x > kLanes / 2)
        advect_some<FloatLanes<kLanes>>(span.end - kLanes, m, row, flows, total);
    else if (span.end > x)
        advect_some<FloatLanes<kLanes / 2>>(span.end - kLanes / 2, m, row, flows, total);
}

template <int kLanes>
TP_INLINE void copy(const RowSpan& span, const float* from, float* to) {
    const int last = span.end - kLanes;
    if (last < span.begin) {
        for (int x = span.begin; x < span.end; ++x) to[x] = from[x];
        return;
    }
    FloatLanes<kLanes> some;
    for (int x = span.begin; x < last; x += kLanes) {
        load(some, from + x);
        std::memcpy(to + x, &some, sizeof some);
    }
    load(some, from + last);
    std::memcpy(to + last, &some, sizeof some);
}

template <int kLanes>
TP_INLINE void advect_and_copy(const RowSpan& span, const RowSpan& done, const Heading& heading,
                               const AdvectedRow& row, const FlowsAround& flows, float* total) {
    advect_all<kLanes>(span, heading, row, flows, total);
    for (std::size_t i = 0; i < row.count; ++i) copy<kLanes>(done, row.above_now[i], row.above[i]);
}

}  // namespace

TP_VECTOR_CLONES
void outflow_row(int n, const TransferRates& rates, const RowMotion& m, const BrushSides& s,
                 const float* __restrict underside, std::size_t underside_stride, const float* __restrict top,
                 std::size_t top_stride, const float* __restrict total, const float* __restrict open,
                 std::size_t stride, const Outflow& out) {
    const TransferRates r = rates;  // a copy, which nothing that is written can change
    const float film = r.film_mm, push = r.push, spread = r.spread, most_bulge = r.bulge_mm,
                still = r.still_mm, stay = r.stay_mm, yield = r.yield_mm;
    float* __restrict left = out.left, * __restrict right = out.right, * __restrict up = out.up, * __restrict down = out.down, * __restrict ahead = out.ahead;
    const float *b_up = underside - underside_stride, *b_down = underside + underside_stride;
    const float *t_up = top - top_stride, *t_down = top + top_stride, *t_up2 = t_up - top_stride,
                *t_down2 = t_down + top_stride, *o_up = open - stride, *o_down = open + stride;
    const float* o_ahead = (m.sy < 0 ? o_up : o_down) + m.sx;
    const float to_left = std::min(std::max(-m.vx, 0.0f), 1.0f),
                to_right = std::min(std::max(m.vx, 0.0f), 1.0f);
    const float across = to_left + to_right, forward = m.sx < 0 ? to_left : to_right, vy0 = m.vy,
                turn = m.turn, sy = static_cast<float>(m.sy);
    const float ax = s.ax, ay = s.ay, a0 = s.a0, right_px = s.right_px, left_px = s.left_px,
                per_band = 1 / std::max(s.band_px, 1.0f), squeeze = s.band_px > 0 ? r.squeeze_per_mm : 0.0f,
                squeeze_left = squeeze * s.left_bears, squeeze_right = squeeze * s.right_bears,
                both = std::abs(ax) + std::abs(ay);
    for (int x = 0; x < n; ++x) {
        // What lies where brushes may not work stays there.
        const float lying = total[x], w = open[x] > 0 ? lying : 0.0f, part = 1 / (w + kTiny), here = top[x];
        const float to_l = here - top[x - 1], to_r = here - top[x + 1], to_u = here - t_up[x],
                    to_d = here - t_down[x];
        const float flowing = std::max(w - stay, 0.0f);
        const float bulge = std::min(0.5f * (to_l + to_r + to_u + to_d) - most_bulge, flowing);
        const float mobile = std::max(w - still, 0.0f);
        // What it holds is the slope, whichever way it goes: along either axis the less, the steeper the
        // other.
        const float yield_x = std::max(yield - kOctagon * std::max(to_u, to_d), kDiagonal * yield);
        const float yield_y = std::max(yield - kOctagon * std::max(to_l, to_r), kDiagonal * yield);
        const float along_x = std::min(yield_x, yield), along_y = std::min(yield_y, yield);
        float l = downhill(r, along_x, flowing, mobile, bulge, to_l, top[x - 2] - here) * part;
        float rr = downhill(r, along_x, flowing, mobile, bulge, to_r, top[x + 2] - here) * part;
        float u = downhill(r, along_y, flowing, mobile, bulge, to_u, t_up2[x] - here) * part;
        float d = downhill(r, along_y, flowing, mobile, bulge, to_d, t_down2[x] - here) * part;
        // What the bristles push: along the motion, and to where they press less.
        const float excess = std::min(std::max(here - underside[x], 0.0f), std::max(w - film, 0.0f));
        // What they squeeze out: the faster the nearer it is to where the pressure ends, and no further.
        const float across_px = a0 + ax * static_cast<float>(x);
        const float beyond_px = std::max(across_px - right_px, -across_px - left_px);
        const float near = std::min(std::max(1 + beyond_px * per_band, 0.0f), 1.0f);
        const float speed =
            underside[x] < kOutside ? near * near * std::min(std::max(1 - beyond_px, 0.0f), 1.0f) : 0.0f;
        const float rest = 1 - (l + rr + u + d);
        const float squeezed =
            std::min((across_px > 0 ? squeeze_right : squeeze_left) * std::max(w - film, 0.0f),
                     kMostSqueezed) *
            speed * rest;
        const float outwards = across_px > 0 ? squeezed : -squeezed, out_x = outwards * ax,
                    out_y = outwards * ay;
        const float pushed = push * excess * part * (rest - squeezed * both);
        const float gx =
            spread * std::min(std::max((underside[x + 1] - underside[x - 1]) * 4.0f, -1.0f), 1.0f);
        const float gy = spread * std::min(std::max((b_down[x] - b_up[x]) * 4.0f, -1.0f), 1.0f);
        const float scale = pushed / (1 + std::abs(gx) + std::abs(gy));
        const float vy = std::min(std::max(vy0 + turn * static_cast<float>(x), -1.0f), 1.0f);
        const float on = std::max(vy * sy, 0.0f), diagonal = forward * on;
        const float beside = 1 - on, straight = 1 - across;
        l += (to_left * beside + std::max(-gx, 0.0f)) * scale;
        rr += (to_right * beside + std::max(gx, 0.0f)) * scale;
        u += (std::max(-vy, 0.0f) * straight + std::max(-gy, 0.0f)) * scale;
        d += (std::max(vy, 0.0f) * straight + std::max(gy, 0.0f)) * scale;
        l += std::max(-out_x, 0.0f);
        rr += std::max(out_x, 0.0f);
        u += std::max(-out_y, 0.0f);
        d += std::max(out_y, 0.0f);
        // Nothing leaves the canvas.
        left[x] = open[x - 1] > 0 ? l : 0.0f;
        right[x] = open[x + 1] > 0 ? rr : 0.0f;
        up[x] = o_up[x] > 0 ? u : 0.0f;
        down[x] = o_down[x] > 0 ? d : 0.0f;
        ahead[x] = o_ahead[x] > 0 ? diagonal * scale : 0.0f;
    }
}

void clear_beside(const RowSpan& span, const RowSpan& looked_at, const Outflow& out) {
    constexpr int lanes = kBesideFlows;
    const FloatLanes<lanes> nothing{};
    for (float* flow : {out.left, out.right, out.up, out.down, out.ahead}) {
        for (int x = span.begin; x > looked_at.begin; x -= lanes)
            std::memcpy(flow + x - lanes, &nothing, sizeof nothing);
        for (int x = span.end; x < looked_at.end; x += lanes) std::memcpy(flow + x, &nothing, sizeof nothing);
    }
}

TP_VECTOR_CLONES
void add_row(int n, const float* __restrict relief, const float* __restrict total, float* __restrict top) {
    for (int x = 0; x < n; ++x) top[x] = relief[x] + total[x];
}

TP_VECTOR_CLONES
void advect_row(const RowSpan& span, const RowSpan& done, const Heading& heading, const AdvectedRow& row,
                const FlowsAround& flows, float* total) {
    with_lanes([&](auto lanes)
                   TP_INLINE_LAMBDA { advect_and_copy<lanes>(span, done, heading, row, flows, total); });
}

}  // namespace tangi
