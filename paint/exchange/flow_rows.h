// flow_rows.h: what bristles push and what flows by itself, row by row, for push() and exchange_and_push()
// (transfer.h).
#pragma once

#include <cstddef>

#include "paint/exchange/transfer.h"

namespace tangi {

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

// What flows from the n pixels of a row, x = 0 at the first of them. `top`: of what is dry and wet. One pixel
// of `underside` and `open` and two of `top` around them are looked at.
void outflow_row(int n, const TransferRates& rates, const RowMotion& motion, const BrushSides& sides,
                 const float* underside, std::size_t underside_stride, const float* top,
                 std::size_t top_stride, const float* total, const float* open, std::size_t stride,
                 const Outflow& out);

// Clears flows of a row on either side of `span`, as far as they are looked at, and up to kBesideFlows - 1
// more.
void clear_beside(const RowSpan& span, const RowSpan& looked_at, const Outflow& out);
constexpr int kBesideFlows = 8;

void add_row(int n, const float* relief, const float* total, float* top);

// What a row's paint can come from: the flows of the row itself and of those beside it.
struct FlowsAround {
    Outflow above, here, below;
};

// One row of each of `count` ingredients and those beside it as they were, what becomes of it, and what
// became of that above.
struct AdvectedRow {
    std::size_t count;
    RowOfEach old, above, below, now, above_now;
};

constexpr int kLeastAdvected = 16;  // [pixels] of a row: with fewer, advect_row() is slow

// Columns `span` of all ingredients of a row after the flow, and of their sum. Thereafter columns `done` of
// the row above, at which nobody looks any more, become what they are now.
void advect_row(const RowSpan& span, const RowSpan& done, const Heading& heading, const AdvectedRow& row,
                const FlowsAround& flows, float* total);

}  // namespace tangi
