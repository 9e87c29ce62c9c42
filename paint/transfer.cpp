#include "paint/transfer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "surface/parallel.h"
#include "surface/vector_clones.h"

namespace tangi {

namespace {

constexpr float kRounding =
    0.125f;  // [1] part of a bulge that flows to each side: a chequerboard is flat at once
constexpr float kMostSqueezed = 0.3f;  // [1] of a pixel's paint in one step, to each of two sides
// A slope is measured by an octagon: the larger component and this part [1] of the smaller one, at 45 degrees
// 1.08 times too large at most.
constexpr float kOctagon = 0.41421356f, kDiagonal = 0.70710678f;
constexpr int kBandRows = 32;
constexpr int kRing = 2;                                                   // [pixels] that give no paint
constexpr int kLanes = 16;                                                 // pixels at once
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));  // as many registers as it takes
using HalfLanes = float __attribute__((vector_size(kLanes / 2 * sizeof(float))));
constexpr float kTiny = 1e-9f;  // [mm] keeps 0 / 0 away

// Signs of the step: the diagonal neighbour ahead is at (x + sx, y + sy).
struct Heading {
    int sx, sy;
};

// Parts of a pixel's paint that leave it to the left, right, up, down, and to the diagonal neighbour ahead:
// at most all of it.
struct Outflow {
    float *left, *right, *up, *down, *ahead;
};

// The brush's motion over a row: as shares of the neighbours ahead, bilinear, so equally fast in any
// direction. Down the row it changes where the brush turns.
struct RowMotion {
    int sx, sy;      // Heading
    float vx;        // [pixels] along the row
    float vy, turn;  // [pixels] across it at its first pixel, and what is added from pixel to pixel
};

// [mm] What flows to a neighbour that is `drop` lower, `w` being what can flow at all. Paint flows down steps
// that are too steep; surface tension rounds off what bulges too much, and fills what lies below both
// neighbours, `beyond` being how much higher than here the pixel behind it is.
TP_INLINE float downhill(const TransferRates& r, float yield_mm, float w, float mobile, float bulge,
                         float drop, float beyond) {
    const float pit = std::min(drop, drop + beyond) - r.pit_mm;
    return std::max(r.flow * std::min(std::max(drop - yield_mm, 0.0f), w),
                    kRounding * std::max(std::min(bulge, drop), std::min(pit, mobile)));
}

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
        const float squeezed = std::min(squeeze * std::max(w - film, 0.0f), kMostSqueezed) * speed * rest;
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

TP_VECTOR_CLONES
void add_row(int n, const float* __restrict relief, const float* __restrict total, float* __restrict top) {
    for (int x = 0; x < n; ++x) top[x] = relief[x] + total[x];
}

// What a row's paint can come from: the flows of the row itself and of those beside it.
struct FlowsAround {
    Outflow above, here, below;
};

// One row of an ingredient: as it was, those beside it as they were, and what becomes of it.
struct AdvectedRow {
    const float *old, *above, *below;
    float* paint;
};

template <class T>
TP_INLINE void load(T& value, const float* from) {
    std::memcpy(&value, from, sizeof value);
}

// As many pixels of all ingredients as T holds, from x on: flows are read once for all of them.
template <class T>
TP_INLINE void advect_some(int x, const Heading& m, const std::vector<AdvectedRow>& rows,
                           const FlowsAround& flows, float* total) {
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
    load(from_behind, (m.sy < 0 ? flows.below.ahead : flows.above.ahead) + x - m.sx);
    const T out = left + right + up + down + ahead;
    T sum{};
    for (const AdvectedRow& row : rows) {
        T old, on_left, on_right, above, below, behind;
        load(old, row.old + x);
        load(on_left, row.old + x - 1);
        load(on_right, row.old + x + 1);
        load(above, row.above + x);
        load(below, row.below + x);
        load(behind, (m.sy < 0 ? row.below : row.above) + x - m.sx);
        const T now = old - old * out + on_left * from_left + on_right * from_right + above * from_above +
                      below * from_below + behind * from_behind;
        std::memcpy(row.paint + x, &now, sizeof now);
        sum += now;
    }
    std::memcpy(total + x, &sum, sizeof sum);
}

// All ingredients of one row after the flow, and their sum. The last pixels are done twice rather than one by
// one: nothing that is read is written.
TP_VECTOR_CLONES
void advect_row(int n, const Heading& m, const std::vector<AdvectedRow>& rows, const FlowsAround& flows,
                float* total) {
    if (n < kLanes) {
        for (int x = 0; x < n; ++x) advect_some<float>(x, m, rows, flows, total);
        return;
    }
    int x = 0;
    for (; x + kLanes <= n; x += kLanes) advect_some<Lanes>(x, m, rows, flows, total);
    if (n - x > kLanes / 2)
        advect_some<Lanes>(n - kLanes, m, rows, flows, total);
    else if (n > x)
        advect_some<HalfLanes>(n - kLanes / 2, m, rows, flows, total);
}

std::size_t at(int y, std::size_t stride) { return static_cast<std::size_t>(y) * stride; }

// Where paint may flow: beside the bristles of the rows around, within the ring.
void find_flowing(const StepBox& box, std::vector<RowSpan>& flowing) {
    flowing.assign(static_cast<std::size_t>(box.height), {0, 0});
    for (int y = kRing; y < box.height - kRing; ++y) {
        RowSpan all{box.width, 0};
        for (int k = std::max(y - kFlowMargin, 0); k <= std::min(y + kFlowMargin, box.height - 1); ++k) {
            const RowSpan span = box.bristles[static_cast<std::size_t>(k)];
            if (span.end <= span.begin) continue;
            all.begin = std::min(all.begin, span.begin);
            all.end = std::max(all.end, span.end);
        }
        if (all.end > all.begin)
            flowing[static_cast<std::size_t>(y)] = {std::max(all.begin - kFlowMargin, kRing),
                                                    std::min(all.end + kFlowMargin, box.width - kRing)};
    }
}

// What a row's paint can come from and go to: its own flow and that of the rows beside it.
RowSpan touched_by(const std::vector<RowSpan>& flowing, int y) {
    RowSpan all{1 << 30, 0};
    for (int k = std::max(y - 1, 0); k <= std::min(y + 1, static_cast<int>(flowing.size()) - 1); ++k) {
        const RowSpan span = flowing[static_cast<std::size_t>(k)];
        if (span.end <= span.begin) continue;
        all.begin = std::min(all.begin, span.begin - 1);
        all.end = std::max(all.end, span.end + 1);
    }
    return all;
}

// Rows of a box that one thread moves, from top to bottom: flows of three rows at a time, which stay in the
// nearest cache. Bands are independent: what a band needs of the rows beside it is kept before any begins.
class Band {
public:
    Band(const StepBox& box, const TransferRates& rates, const BrushMotion& motion, const StepScratch& spans,
         float* memory)
        : box_(box),
          rates_(rates),
          motion_(motion),
          heading_{motion.dx < 0 ? -1 : 1, motion.dy < 0 ? -1 : 1},
          spans_(spans),
          line_(line_of(box)),
          memory_(memory),
          rows_(box.paint.size()) {}

    // Floats of memory.
    static std::size_t line_of(const StepBox& box) { return static_cast<std::size_t>(box.width) + 2; }
    static std::size_t floats(const StepBox& box) {
        return line_of(box) * (kFlows * kPlanes + 3 * box.paint.size());
    }

    // Keeps what other bands may change before it is needed here.
    void prepare(int begin, int end) {
        begin_ = begin;
        end_ = end;
        find_flow(begin - 1, 0);
        find_flow(begin, 1);
        find_flow(end - 1, 3);
        find_flow(end, 4);
        for (std::size_t i = 0; i < box_.paint.size(); ++i) {
            std::fill_n(kept(i, 0) - 1, 3 * line_, 0.0f);
            if (begin > 0) std::copy_n(row(i, begin - 1), box_.width, kept(i, 0));
            // A row beside the last one is looked at one pixel beyond its ends, where nothing flows.
            std::copy_n(row(i, std::min(end, box_.height - 1)), box_.width, kept(i, 2));
        }
    }

    void run() {
        int above = 0, here = 1, free = 2;  // flows
        int old_above = 0, old = 1;         // kept rows
        for (int y = begin_; y < end_; ++y) {
            const int below = y + 1 == end_ ? 4 : y + 2 == end_ ? 3 : free;
            if (below == free) find_flow(y + 1, below);
            const bool below_is_kept = y + 1 >= std::min(end_, box_.height - 1);
            move_row(y, {flow(above), flow(here), flow(below)}, old_above, old, below_is_kept);
            std::swap(old_above, old);
            free = above;
            above = here, here = below;
        }
    }

private:
    static constexpr std::size_t kPlanes = 5, kFlows = 5;  // three that go round, the last two of the band

    float* row(std::size_t ingredient, int y) const {
        return box_.paint[ingredient] + at(y, box_.canvas_stride);
    }
    // Copies of rows of an ingredient: two that go round, and that below the band; one pixel more on either
    // side.
    float* kept(std::size_t ingredient, int which) const {
        return memory_ + line_ * (kFlows * kPlanes + 3 * ingredient + static_cast<std::size_t>(which)) + 1;
    }
    Outflow flow(int which) const {
        float* first = memory_ + line_ * kPlanes * static_cast<std::size_t>(which) + 1;
        return {first, first + line_, first + 2 * line_, first + 3 * line_, first + 4 * line_};
    }

    void find_flow(int y, int which) const {
        // Where nothing flows but neighbours look, flows are 0.
        const RowSpan looked_at = touched_by(spans_.touched, y);
        if (looked_at.end <= looked_at.begin) return;
        const bool inside = y >= 0 && y < box_.height;
        RowSpan span = inside ? spans_.flowing[static_cast<std::size_t>(y)] : RowSpan{0, 0};
        if (span.end <= span.begin) span = {looked_at.begin, looked_at.begin};
        const Outflow out = flow(which);
        if (span.end > span.begin) {
            const RowSpan whole = widened(span, {kRing, box_.width - kRing});
            const auto first = static_cast<std::size_t>(whole.begin);
            const std::size_t canvas = at(y, box_.canvas_stride) + first,
                              top_stride = static_cast<std::size_t>(box_.width);
            const RowMotion motion{
                heading_.sx, heading_.sy, motion_.dx - motion_.turn_rad * (static_cast<float>(y) - motion_.y),
                motion_.dy + motion_.turn_rad * (static_cast<float>(whole.begin) - motion_.x),
                motion_.turn_rad};
            outflow_row(whole.end - whole.begin, rates_, motion, box_.sides.row_from(whole.begin, y),
                        box_.underside_mm + at(y, box_.underside_stride) + first, box_.underside_stride,
                        spans_.top.data() + at(y, top_stride) + first, top_stride, box_.total_mm + canvas,
                        box_.open + canvas, box_.canvas_stride, from(out, first));
        }
        for (float* plane : {out.left, out.right, out.up, out.down, out.ahead}) {
            std::fill(plane + looked_at.begin, plane + span.begin, 0.0f);
            std::fill(plane + span.end, plane + looked_at.end, 0.0f);
        }
    }

    static Outflow from(const Outflow& flow, std::size_t x) {
        return {flow.left + x, flow.right + x, flow.up + x, flow.down + x, flow.ahead + x};
    }

    void move_row(int y, const FlowsAround& flows, int old_above, int old, bool below_is_kept) {
        const RowSpan span = spans_.touched[static_cast<std::size_t>(y)];
        const int n = span.end - span.begin;
        const std::size_t first = n > 0 ? static_cast<std::size_t>(span.begin) : 0;
        const FlowsAround here{from(flows.above, first), from(flows.here, first), from(flows.below, first)};
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            float* paint = row(i, y);
            std::copy_n(paint, box_.width, kept(i, old));
            rows_[i] = {kept(i, old) + first, kept(i, old_above) + first,
                        (below_is_kept ? kept(i, 2) : paint + box_.canvas_stride) + first, paint + first};
        }
        if (n > 0) advect_row(n, heading_, rows_, here, box_.total_mm + at(y, box_.canvas_stride) + first);
    }

    const StepBox& box_;
    const TransferRates& rates_;
    const BrushMotion& motion_;
    Heading heading_;
    const StepScratch& spans_;
    std::size_t line_;
    float* memory_;
    int begin_ = 0, end_ = 0;
    std::vector<AdvectedRow> rows_;
};

}  // namespace

void push(const StepBox& box, const TransferRates& rates, const BrushMotion& motion, StepScratch& scratch) {
    if (box.width <= 2 * kRing || box.height <= 2 * kRing) return;
    find_flowing(box, scratch.flowing);
    scratch.top.resize(static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height));
    for_rows_of_step(box.width, box.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y)
            add_row(box.width, box.relief_mm + at(y, box.canvas_stride),
                    box.total_mm + at(y, box.canvas_stride),
                    scratch.top.data() + at(y, static_cast<std::size_t>(box.width)));
    });
    scratch.touched.resize(static_cast<std::size_t>(box.height));
    for (int y = 0; y < box.height; ++y)
        if (RowSpan& span = scratch.touched[static_cast<std::size_t>(y)] = touched_by(scratch.flowing, y);
            span.end > span.begin && span.end - span.begin < kLanes)  // one vector at least
            span = {std::max(std::min(span.begin, box.width - kLanes), 0),
                    std::min(std::max(span.end, std::max(span.begin, 0) + kLanes), box.width)};
    const int bands = box.width * box.height < kParallelPixels ? 1 : std::max(box.height / kBandRows, 1);
    const std::size_t floats = Band::floats(box);
    scratch.planes.resize(std::max(scratch.planes.size(), floats * static_cast<std::size_t>(bands)));
    std::vector<Band> all;
    all.reserve(static_cast<std::size_t>(bands));
    for (int i = 0; i < bands; ++i)
        all.emplace_back(box, rates, motion, scratch,
                         scratch.planes.data() + floats * static_cast<std::size_t>(i));
    const auto for_bands = [&](const std::function<void(int)>& body) {
        if (bands == 1) return body(0);
        parallel_for(0, bands, 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) body(i);
        });
    };
    for_bands([&](int i) {
        all[static_cast<std::size_t>(i)].prepare(box.height * i / bands, box.height * (i + 1) / bands);
    });
    for_bands([&](int i) { all[static_cast<std::size_t>(i)].run(); });
}

}  // namespace tangi
