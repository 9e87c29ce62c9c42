// brush_steps.h: steps of a brush on the canvas.
#pragma once

#include <cstdint>
#include <span>

#include "paint/brush/brush.h"
#include "paint/canvas/canvas.h"
#include "paint/exchange/squeeze_out.h"
#include "paint/exchange/transfer.h"
#include "paint/stroke/paint_window.h"
#include "paint/stroke/upper_film.h"

namespace tangi {

// Memory that the steps of a stroke reuse.
struct DabMemory {
    StepScratch step;
    PaintWindow::Memory window;
    std::vector<float> underside, lanes;  // and cover
    Outwards outwards;
    StepBox box;
};

// The whole pixels that a step may change, not cut to the canvas.
Region box_of(const Brush& brush, const Dab& dab);

// Applies steps of a brush in order. What Stroke does with its dabs; for tests and benchmarks. `other` is
// that of the whole stroke. Returns the number of pixels under the brush, summed over the steps.
double paint_dabs(Canvas& canvas, Brush& brush, std::span<const Dab> dabs, std::uint64_t seed,
                  UpperFilm& other, DabMemory& memory);

}  // namespace tangi
