// transfer.h: how paint goes between bristles and canvas, and how bristles push it, for one step of a brush.
//
// Thicknesses [mm] are volumes over a pixel's area, here on the canvas (W) and on the brush (L) alike. For
// each pixel one function gives how much goes each way; both sides are changed by that same amount, so each
// ingredient's volume is conserved to rounding (thesis algorithm 3, corrected as DESIGN section 5 says; both
// ways at once as in Baxter, Wendt, Lin 2004, "IMPaSTo: a realistic, interactive model for paint",
// section 5.2). Pushing is a conservative upwind advection: paint above the bristles' underside moves to the
// four neighbours, never more than there is, which is stable for any step (ibid., section 4).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "paint/exchange/bristle_lanes.h"
#include "paint/exchange/edge_pressure.h"
#include "surface/image/row_span.h"

namespace tangi {

// Rates for one step of the brush, from one row of pixels to the next at most.
struct TransferRates {
    float deposit = 0;     // [1] part of a bristle's load that goes to the canvas in full contact, 0..0.5
    float pickup = 0;      // [1] part of the canvas's paint above the film that goes to the bristle, 0..0.5
    float push = 0;        // [1] part of the paint above the underside that moves on, 0..1
    float hold_mm = 1e9f;  // [mm] > 0: load of which bristles take no more; the fuller, the less they take
    float film_mm = 0;     // [mm] paint that always stays on the canvas
    float stir = 0;        // [1] part of the upper film that mixes with what it lies on, 0..0.5
    float swap = 0;        // [1] part of what it lies on that changes places with paint of the bristles, 0..1
    float reach_mm = 0;    // [mm] > 0: gap that a bristle without paint still bridges
    float load_reach = 0;  // [1] further gap for each mm of load: wet paint bridges what is dry
    float ride_mm = 0;     // [mm] >= 0: mean height of the bristles over what they touch, on paint enough
    float tip_mm = 1e9f;   // [mm] > 0: load at the tips, which gives and bridges; what is more waits above
    float press = 0;       // [1] by how much more bristles give at the sides
    // [1/mm] Part of the paint under the sides that is squeezed out to one pixel further, for each mm of it.
    float squeeze_per_mm = 0;
    float spread = 0;    // [1] how much of the pushing goes towards where the brush presses less, 0..1
    float yield_mm = 0;  // [mm] step between neighbours that paint holds; more of it flows down
    float flow = 0;      // [1] part of what is more that flows in one step, 0..0.2
    // What surface tension leaves: depth [mm] below the neighbours of either side, and half of the sum of the
    // steps down to the four neighbours.
    float pit_mm = 1e9f, bulge_mm = 1e9f;
    float still_mm = 0;  // [mm] thickness of which paint does not flow into pits while a brush passes
    float stay_mm = 0;   // [mm] thickness of which paint does not flow at all, however steep it lies
};

// A row of each ingredient: `offset` floats from the beginning of its plane.
struct RowOfEach {
    float* const* planes;
    std::ptrdiff_t offset;
    float* operator[](std::size_t i) const { return planes[i] + offset; }
};

// The columns of whole vectors around those of `span`, which is not empty, as far as there is room: loops
// over them need no remainder. Nothing must happen in those that come in addition.
RowSpan widened(const RowSpan& span, const RowSpan& room);

// The box of pixels that one step changes. Rows of `width` floats; row y of a plane begins at plane + y *
// stride. The two outermost rings receive paint but give none.
struct StepBox {
    int width = 0, height = 0;
    const float* underside_mm =
        nullptr;                   // of the bristles above the relief's mean; kOutside where there is none
    const float* cover = nullptr;  // [1] part of the pixel that bristles cover, 0..1, strided as underside_mm
    std::size_t underside_stride = 0;
    std::vector<RowSpan> bristles;     // of each row: outside of it underside_mm is kOutside
    const float* relief_mm = nullptr;  // of what is dry, above its local mean
    const float* open = nullptr;       // [1] factor of the transfer that the canvas allows; 0: no brush works
    float* total_mm = nullptr;         // W, sum of `paint`
    std::size_t canvas_stride = 0;
    // W of each ingredient; where there is an upper film, each followed by what of it is in that.
    std::vector<float*> paint;
    bool laid_above = false;         // what is laid goes into the upper film, which there is
    float* load_total_mm = nullptr;  // L, sum of `load`
    std::size_t load_stride = 0;
    std::vector<float*> load;  // L of each ingredient, in the same order
    BrushSides sides;
    BristleLanes lanes;
};

constexpr int kFlowMargin = 3;              // [pixels]
constexpr int kParallelPixels = 128 * 128;  // smaller boxes are done before a second thread wakes up
constexpr float kOutside = 1e3f;            // [mm] underside where no bristle is

// Memory that steps reuse.
struct StepScratch {
    std::vector<float> planes, top;
    std::vector<RowSpan> flowing, touched, looked_at;
};

// How bristles move in one step, in pixels, y down. Paint goes one pixel along each axis at most.
struct BrushMotion {
    float dx = 0, dy = 0;  // of the place (x, y) of the box
    float turn_rad = 0;    // from x towards y, about it
    float x = 0, y = 0;
};

// Calls body(begin, end) over rows, on all threads.
void for_rows_in_parallel(int height, const std::function<void(int begin, int end)>& body);

// The same over the rows of a box, where it has so many pixels that waking the threads pays; else at once.
template <class Body>
void for_rows_of_step(int width, int height, const Body& body) {
    if (width * height < kParallelPixels)
        body(0, height);
    else
        for_rows_in_parallel(height, body);
}

// Both ways at once between bristles and canvas. Paint that is laid on other paint stays on it: up to
// kUpper_mm of it, of which what comes last is most, as an upper film that is taken first, and that bristles
// which dip into the paint stir into what it lies on. Where they lay more than that, what was there before is
// mixed in.
void exchange(const StepBox& box, const TransferRates& rates, StepScratch& scratch);

// Moves what is above the underside as the bristles move, and sideways, and lets steps steeper than the yield
// flow down.
void push(const StepBox& box, const TransferRates& rates, const BrushMotion& motion, StepScratch& scratch);

// Both, in this order, to the same bits, while a row is at hand.
void exchange_and_push(const StepBox& box, const TransferRates& rates, const BrushMotion& motion,
                       StepScratch& scratch);

}  // namespace tangi
