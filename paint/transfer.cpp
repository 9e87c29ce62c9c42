#include "paint/transfer.h"

#include <algorithm>
#include <cmath>

#include "paint/vector_clones.h"
#include "surface/parallel.h"

namespace tangi {

namespace {

constexpr int kParallelPixels = 128 * 128;  // smaller boxes are done before a second thread wakes up
constexpr float kTiny = 1e-9f;              // [mm] keeps 0 / 0 away

// Part of the load that is given, and part of the paint on the canvas that is taken.
TP_VECTOR_CLONES
void exchange_row(int n, const TransferRates& r, const float* __restrict underside,
                  const float* __restrict relief, const float* __restrict grain,
                  const float* __restrict total, const float* __restrict load, float* __restrict give,
                  float* __restrict take) {
    const float deposit = r.deposit, pickup = r.pickup, film = r.film_mm, reach0 = r.reach_mm,
                reach1 = r.load_reach, per_half = 2 / r.hold_mm;
    for (int x = 0; x < n; ++x) {
        const float reach = reach0 + reach1 * load[x];
        const float room = underside[x] - (relief[x] + total[x]);
        const float contact = std::min(std::max((reach - room) / reach, 0.0f), 1.0f) * grain[x];
        give[x] = deposit * contact;
        const float thirst = std::min(std::max(2 - per_half * load[x], 0.0f), 1.0f);
        take[x] = pickup * thirst * contact * std::max(total[x] - film, 0.0f) / (total[x] + kTiny);
    }
}

TP_VECTOR_CLONES
void apply_row(int n, const float* __restrict give, const float* __restrict take, float* __restrict paint,
               float* __restrict load, float* __restrict total, float* __restrict load_total) {
    for (int x = 0; x < n; ++x) {
        const float moved = give[x] * load[x] - take[x] * paint[x];
        paint[x] += moved;
        load[x] -= moved;
        total[x] += paint[x];
        load_total[x] += load[x];
    }
}

// Parts of a pixel's paint that leave it to the left, right, up, down, and to the diagonal neighbour ahead:
// at most all of it.
struct Outflow {
    float *left, *right, *up, *down, *ahead;
};

// The motion as shares of the neighbours ahead: a step of one pixel, bilinear, so equally fast in any
// direction.
struct Motion {
    int sx, sy;            // signs: the diagonal neighbour ahead is at (x + sx, y + sy)
    float x, y, diagonal;  // [1] shares
};

Motion motion_along(float dx, float dy) {
    const float ax = std::min(std::abs(dx), 1.0f), ay = std::min(std::abs(dy), 1.0f);
    return {dx < 0 ? -1 : 1, dy < 0 ? -1 : 1, ax * (1 - ay), ay * (1 - ax), ax * ay};
}

TP_VECTOR_CLONES
void outflow_row(int n, const TransferRates& r, const Motion& m, const float* __restrict underside,
                 std::size_t underside_stride, const float* __restrict relief, const float* __restrict total,
                 const float* __restrict grain, std::size_t stride, const Outflow& out) {
    const float film = r.film_mm, push = r.push, spread = r.spread, yield = r.yield_mm, flow = r.flow;
    float* __restrict left = out.left, * __restrict right = out.right, * __restrict up = out.up, * __restrict down = out.down, * __restrict ahead = out.ahead;
    const float *b_up = underside - underside_stride, *b_down = underside + underside_stride;
    const float *z_up = relief - stride, *z_down = relief + stride, *w_up = total - stride,
                *w_down = total + stride, *g_up = grain - stride, *g_down = grain + stride;
    const float* g_ahead = (m.sy < 0 ? g_up : g_down) + m.sx;
    const float to_left = m.sx < 0 ? m.x : 0, to_right = m.sx < 0 ? 0 : m.x, to_up = m.sy < 0 ? m.y : 0,
                to_down = m.sy < 0 ? 0 : m.y, diagonal = m.diagonal;
    for (int x = 0; x < n; ++x) {
        // What lies where brushes may not work stays there.
        const float w = grain[x] > 0 ? total[x] : 0.0f, top = relief[x] + total[x];
        // Steps that are too steep: paint flows down them.
        const float over = flow / (w + kTiny);
        float l = std::min(std::max(top - (relief[x - 1] + total[x - 1]) - yield, 0.0f), w) * over;
        float rr = std::min(std::max(top - (relief[x + 1] + total[x + 1]) - yield, 0.0f), w) * over;
        float u = std::min(std::max(top - (z_up[x] + w_up[x]) - yield, 0.0f), w) * over;
        float d = std::min(std::max(top - (z_down[x] + w_down[x]) - yield, 0.0f), w) * over;
        // What the bristles push: along the motion, and to where they press less.
        const float excess = std::min(std::max(top - underside[x], 0.0f), std::max(w - film, 0.0f));
        const float pushed = push * excess / (w + kTiny) * (1 - (l + rr + u + d));
        const float gx =
            spread * std::min(std::max((underside[x + 1] - underside[x - 1]) * 4.0f, -1.0f), 1.0f);
        const float gy = spread * std::min(std::max((b_down[x] - b_up[x]) * 4.0f, -1.0f), 1.0f);
        const float scale = pushed / (1 + std::abs(gx) + std::abs(gy));
        l += (to_left + std::max(-gx, 0.0f)) * scale;
        rr += (to_right + std::max(gx, 0.0f)) * scale;
        u += (to_up + std::max(-gy, 0.0f)) * scale;
        d += (to_down + std::max(gy, 0.0f)) * scale;
        // Nothing leaves the canvas.
        left[x] = grain[x - 1] > 0 ? l : 0.0f;
        right[x] = grain[x + 1] > 0 ? rr : 0.0f;
        up[x] = g_up[x] > 0 ? u : 0.0f;
        down[x] = g_down[x] > 0 ? d : 0.0f;
        ahead[x] = g_ahead[x] > 0 ? diagonal * scale : 0.0f;
    }
}

// One row of one ingredient after the flow; `old` is the row before, `above` and `below` those beside it
// before. `flow` is of this row, its planes' rows are `stride` apart.
TP_VECTOR_CLONES
void advect_row(int n, const Motion& m, const float* __restrict old, const float* __restrict above,
                const float* __restrict below, const Outflow& flow, std::size_t stride,
                float* __restrict paint) {
    const float *left = flow.left, *right = flow.right, *up = flow.up, *down = flow.down, *ahead = flow.ahead;
    const float *down_above = down - stride, *up_below = up + stride;
    const float* behind = (m.sy < 0 ? below : above) - m.sx;
    const float* from_behind = (m.sy < 0 ? ahead + stride : ahead - stride) - m.sx;
    for (int x = 0; x < n; ++x) {
        const float stays = old[x] - old[x] * (left[x] + right[x] + up[x] + down[x] + ahead[x]);
        paint[x] = stays + old[x - 1] * right[x - 1] + old[x + 1] * left[x + 1] + above[x] * down_above[x] +
                   below[x] * up_below[x] + behind[x] * from_behind[x];
    }
}

TP_VECTOR_CLONES
void add_row(int n, const float* __restrict paint, float* __restrict total) {
    for (int x = 0; x < n; ++x) total[x] += paint[x];
}

void for_rows(const StepBox& box, int begin, int end, const std::function<void(int, int)>& body) {
    if (box.width * box.height < kParallelPixels)
        body(begin, end);
    else
        parallel_for(begin, end, 32, body);
}

std::size_t at(int y, std::size_t stride) { return static_cast<std::size_t>(y) * stride; }

}  // namespace

void exchange(const StepBox& box, const TransferRates& rates, StepScratch& scratch) {
    const auto n = static_cast<std::size_t>(box.width);
    scratch.planes.resize(std::max(scratch.planes.size(), 2 * n * static_cast<std::size_t>(box.height)));
    for_rows(box, 0, box.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const RowSpan span = box.bristles[static_cast<std::size_t>(y)];
            const int count = span.end - span.begin;
            if (count <= 0) continue;
            float* give = scratch.planes.data() + at(y, 2 * n);
            float* take = give + n;
            const std::size_t canvas = at(y, box.canvas_stride) + static_cast<std::size_t>(span.begin);
            const std::size_t load = at(y, box.load_stride) + static_cast<std::size_t>(span.begin);
            float *total = box.total_mm + canvas, *load_total = box.load_total_mm + load;
            exchange_row(
                count, rates,
                box.underside_mm + at(y, box.underside_stride) + static_cast<std::size_t>(span.begin),
                box.relief_mm + canvas, box.grain + canvas, total, load_total, give, take);
            std::fill_n(total, count, 0.0f);
            std::fill_n(load_total, count, 0.0f);
            for (std::size_t i = 0; i < box.paint.size(); ++i)
                apply_row(count, give, take, box.paint[i] + canvas, box.load[i] + load, total, load_total);
        }
    });
}

namespace {

// Where paint may flow: beside the bristles of the rows around, within the ring.
void find_flowing(const StepBox& box, std::vector<RowSpan>& flowing) {
    flowing.assign(static_cast<std::size_t>(box.height), {0, 0});
    for (int y = 1; y < box.height - 1; ++y) {
        RowSpan all{box.width, 0};
        for (int k = std::max(y - kFlowMargin, 0); k <= std::min(y + kFlowMargin, box.height - 1); ++k) {
            const RowSpan span = box.bristles[static_cast<std::size_t>(k)];
            if (span.end <= span.begin) continue;
            all.begin = std::min(all.begin, span.begin);
            all.end = std::max(all.end, span.end);
        }
        if (all.end > all.begin)
            flowing[static_cast<std::size_t>(y)] = {std::max(all.begin - kFlowMargin, 1),
                                                    std::min(all.end + kFlowMargin, box.width - 1)};
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

}  // namespace

void push(const StepBox& box, const TransferRates& rates, float dx, float dy, StepScratch& scratch) {
    if (box.width < 3 || box.height < 3) return;
    const std::size_t stride = static_cast<std::size_t>(box.width) + 2;  // a column of zeros on either side
    const std::size_t plane = stride * static_cast<std::size_t>(box.height + 2);
    scratch.planes.resize(std::max(scratch.planes.size(), 5 * plane));
    float* base = scratch.planes.data();
    const auto flow_from = [&](int y, std::size_t x) {
        float* first = base + at(y + 1, stride) + 1 + x;
        return Outflow{first, first + plane, first + 2 * plane, first + 3 * plane, first + 4 * plane};
    };
    const Motion motion = motion_along(dx, dy);
    find_flowing(box, scratch.flowing);
    std::vector<RowSpan>& touched = scratch.touched;
    touched.resize(static_cast<std::size_t>(box.height));
    for (int y = 0; y < box.height; ++y)
        touched[static_cast<std::size_t>(y)] = touched_by(scratch.flowing, y);
    // Where nothing flows but neighbours look: flows are 0 there.
    const auto clear_around = [&](int y, RowSpan flowing) {
        const RowSpan looked_at = touched_by(touched, y);
        if (looked_at.end <= looked_at.begin) return;
        if (flowing.end <= flowing.begin) flowing = {looked_at.begin, looked_at.begin};
        float* first = base + at(y + 1, stride) + 1;
        for (int k = 0; k < 5; ++k, first += plane) {
            std::fill(first + looked_at.begin, first + flowing.begin, 0.0f);
            std::fill(first + flowing.end, first + looked_at.end, 0.0f);
        }
    };
    for_rows(box, -1, box.height + 1, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const bool inside = y >= 0 && y < box.height;
            const RowSpan span = inside ? scratch.flowing[static_cast<std::size_t>(y)] : RowSpan{0, 0};
            clear_around(y, span);
            if (span.end <= span.begin) continue;
            const auto first = static_cast<std::size_t>(span.begin);
            const std::size_t canvas = at(y, box.canvas_stride) + first;
            outflow_row(span.end - span.begin, rates, motion,
                        box.underside_mm + at(y, box.underside_stride) + first, box.underside_stride,
                        box.relief_mm + canvas, box.total_mm + canvas, box.grain + canvas, box.canvas_stride,
                        flow_from(y, first));
        }
    });
    // Ingredients do not depend on each other. Rows are replaced from top to bottom; what they were is kept
    // until the next row is done.
    const std::size_t line = stride;
    scratch.rows.assign(3 * line * std::max<std::size_t>(box.paint.size(), 1), 0.0f);
    const auto move_ingredient = [&](std::size_t i) {
        float* above = scratch.rows.data() + 3 * line * i + 1;
        float *old = above + line, *last = above + 2 * line;
        for (int y = 0; y < box.height; ++y) {
            const RowSpan span = touched[static_cast<std::size_t>(y)];
            float* paint = box.paint[i] + at(y, box.canvas_stride);
            std::copy_n(paint, box.width, old);
            if (span.end > span.begin) {
                const auto first = static_cast<std::size_t>(span.begin);
                // A row beside it is looked at one pixel beyond its ends, where nothing flows: the last one,
                // which may end with its plane, needs a copy, and the one after that is not there.
                const float* below = y + 1 < box.height ? paint + box.canvas_stride : old;
                if (y + 2 == box.height) below = std::copy_n(below, box.width, last) - box.width;
                advect_row(span.end - span.begin, motion, old + first, above + first, below + first,
                           flow_from(y, first), stride, paint + first);
            }
            std::swap(above, old);
        }
    };
    if (box.width * box.height < kParallelPixels)
        for (std::size_t i = 0; i < box.paint.size(); ++i) move_ingredient(i);
    else
        parallel_for(0, static_cast<int>(box.paint.size()), 1, [&](int begin, int end) {
            for (int i = begin; i < end; ++i) move_ingredient(static_cast<std::size_t>(i));
        });
    for_rows(box, 0, box.height, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const RowSpan span = touched[static_cast<std::size_t>(y)];
            if (span.end <= span.begin) continue;
            const std::size_t canvas = at(y, box.canvas_stride) + static_cast<std::size_t>(span.begin);
            float* total = box.total_mm + canvas;
            std::fill_n(total, span.end - span.begin, 0.0f);
            for (const float* paint : box.paint) add_row(span.end - span.begin, paint + canvas, total);
        }
    });
}

}  // namespace tangi
