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

// [1] Parts of a pixel's paint that go to its neighbours.
struct Shares {
    float left, right, up, down, ahead;
};

// [mm] Of what is dry and wet: here, at the neighbours, and behind these.
struct TopsAround {
    float here, left, right, up, down, left2, right2, up2, down2;
};

// What flows by itself of `w` [mm], the paint there.
TP_INLINE Shares flowing(const TransferRates& r, float w, const TopsAround& t) {
    const float part = 1 / (w + kTiny);
    const float to_l = t.here - t.left, to_r = t.here - t.right, to_u = t.here - t.up, to_d = t.here - t.down;
    const float flowing = std::max(w - r.stay_mm, 0.0f);
    const float bulge = std::min(0.5f * (to_l + to_r + to_u + to_d) - r.bulge_mm, flowing);
    const float mobile = std::max(w - r.still_mm, 0.0f);
    // What it holds is the slope, whichever way it goes: along either axis the less, the steeper the other.
    const float yield = r.yield_mm;
    const float yield_x = std::max(yield - kOctagon * std::max(to_u, to_d), kDiagonal * yield);
    const float yield_y = std::max(yield - kOctagon * std::max(to_l, to_r), kDiagonal * yield);
    const float along_x = std::min(yield_x, yield), along_y = std::min(yield_y, yield);
    return {downhill(r, along_x, flowing, mobile, bulge, to_l, t.left2 - t.here) * part,
            downhill(r, along_x, flowing, mobile, bulge, to_r, t.right2 - t.here) * part,
            downhill(r, along_y, flowing, mobile, bulge, to_u, t.up2 - t.here) * part,
            downhill(r, along_y, flowing, mobile, bulge, to_d, t.down2 - t.here) * part, 0.0f};
}

// What bristles squeeze out along a row, by where it is across the brush.
struct RowSqueeze {
    float ax, ay, a0, right_px, left_px, per_band, left, right;
    float both;  // [1] |ax| + |ay|
};

TP_INLINE RowSqueeze squeeze_of(const TransferRates& r, const BrushSides& s) {
    const float squeeze = s.band_px > 0 ? r.squeeze_per_mm : 0.0f;
    return {s.ax,
            s.ay,
            s.a0,
            s.right_px,
            s.left_px,
            1 / std::max(s.band_px, 1.0f),
            squeeze * s.left_bears,
            squeeze * s.right_bears,
            std::abs(s.ax) + std::abs(s.ay)};
}

struct Squeezed {
    float part;  // [1]
    float x, y;  // of it, along the row and across it
};

// What they squeeze out: the faster the nearer it is to where the pressure ends, and no further.
TP_INLINE Squeezed squeezed(const RowSqueeze& s, int x, float underside, float above_film, float rest) {
    const float across_px = s.a0 + s.ax * static_cast<float>(x);
    const float beyond_px = std::max(across_px - s.right_px, -across_px - s.left_px);
    const float near = std::min(std::max(1 + beyond_px * s.per_band, 0.0f), 1.0f);
    const float speed =
        underside < kOutside ? near * near * std::min(std::max(1 - beyond_px, 0.0f), 1.0f) : 0.0f;
    const float part =
        std::min((across_px > 0 ? s.right : s.left) * above_film, kMostSqueezed) * speed * rest;
    const float outwards = across_px > 0 ? part : -part;
    return {part, outwards * s.ax, outwards * s.ay};
}

// How bristles push along a row.
struct RowPush {
    float part, spread;       // [1]
    float to_left, to_right;  // [1] of what is pushed along the row
    float forward, vy, turn, sy;
};

TP_INLINE RowPush push_of(const TransferRates& r, const RowMotion& m) {
    const float to_left = std::min(std::max(-m.vx, 0.0f), 1.0f),
                to_right = std::min(std::max(m.vx, 0.0f), 1.0f);
    return {r.push,
            r.spread,
            to_left,
            to_right,
            m.sx < 0 ? to_left : to_right,
            m.vy,
            m.turn,
            static_cast<float>(m.sy)};
}

// Where what is pushed goes: along the motion, and to where bristles press less; `dx` and `dy` [mm]: by how
// much the underside rises over two pixels.
TP_INLINE Shares pushed_to(const RowPush& p, int x, float pushed, float dx, float dy) {
    const float gx = p.spread * std::min(std::max(dx * 4.0f, -1.0f), 1.0f);
    const float gy = p.spread * std::min(std::max(dy * 4.0f, -1.0f), 1.0f);
    const float scale = pushed / (1 + std::abs(gx) + std::abs(gy));
    const float vy = std::min(std::max(p.vy + p.turn * static_cast<float>(x), -1.0f), 1.0f);
    const float on = std::max(vy * p.sy, 0.0f), diagonal = p.forward * on;
    const float beside = 1 - on, straight = 1 - (p.to_left + p.to_right);
    return {(p.to_left * beside + std::max(-gx, 0.0f)) * scale,
            (p.to_right * beside + std::max(gx, 0.0f)) * scale,
            (std::max(-vy, 0.0f) * straight + std::max(-gy, 0.0f)) * scale,
            (std::max(vy, 0.0f) * straight + std::max(gy, 0.0f)) * scale, diagonal * scale};
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
    // Copies, which nothing that is written can change.
    const TransferRates r = rates;
    const RowSqueeze squeeze = squeeze_of(r, s);
    const RowPush push = push_of(r, m);
    float* __restrict left = out.left, * __restrict right = out.right, * __restrict up = out.up, * __restrict down = out.down, * __restrict ahead = out.ahead;
    const float *b_up = underside - underside_stride, *b_down = underside + underside_stride;
    const float *t_up = top - top_stride, *t_down = top + top_stride, *t_up2 = t_up - top_stride,
                *t_down2 = t_down + top_stride, *o_up = open - stride, *o_down = open + stride;
    const float* o_ahead = (m.sy < 0 ? o_up : o_down) + m.sx;
    for (int x = 0; x < n; ++x) {
        // What lies where brushes may not work stays there.
        // (Read before it is chosen: loops without branches become vector instructions.)
        const float lying = total[x], w = open[x] > 0 ? lying : 0.0f, part = 1 / (w + kTiny);
        const Shares flows = flowing(r, w,
                                     {top[x], top[x - 1], top[x + 1], t_up[x], t_down[x], top[x - 2],
                                      top[x + 2], t_up2[x], t_down2[x]});
        // What the bristles push: along the motion, and to where they press less.
        const float above_film = std::max(w - r.film_mm, 0.0f);
        const float excess = std::min(std::max(top[x] - underside[x], 0.0f), above_film);
        const float rest = 1 - (flows.left + flows.right + flows.up + flows.down);
        const Squeezed out_of = squeezed(squeeze, x, underside[x], above_film, rest);
        const float pushed = push.part * excess * part * (rest - out_of.part * squeeze.both);
        const Shares shared =
            pushed_to(push, x, pushed, underside[x + 1] - underside[x - 1], b_down[x] - b_up[x]);
        const float l = flows.left + shared.left + std::max(-out_of.x, 0.0f);
        const float rr = flows.right + shared.right + std::max(out_of.x, 0.0f);
        const float u = flows.up + shared.up + std::max(-out_of.y, 0.0f);
        const float d = flows.down + shared.down + std::max(out_of.y, 0.0f);
        // Nothing leaves the canvas.
        left[x] = open[x - 1] > 0 ? l : 0.0f;
        right[x] = open[x + 1] > 0 ? rr : 0.0f;
        up[x] = o_up[x] > 0 ? u : 0.0f;
        down[x] = o_down[x] > 0 ? d : 0.0f;
        ahead[x] = o_ahead[x] > 0 ? shared.ahead : 0.0f;
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
