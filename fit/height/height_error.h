// height_error.h: standard errors of a height that was integrated from slopes.
#pragma once

#include "fit/height/slope_edges.h"
#include "surface/base/progress.h"

namespace tangi {

// [pixels] Side of the window whose mean a height error is relative to. Errors of slopes add up with the
// distance, and lights that are a little off bend a whole painting: what the height is across more than this
// is not said by any standard error.
constexpr int kHeightErrorWindow = 33;

// [mm] Of each pixel, 0 where it was not measured: standard error of its height less the mean height of the
// window around it. Four fields of errors as large as those of slopes and edges (which `height_mm`, as it
// comes of the edges, disagrees with) are integrated like the slopes (with the weights that `edges` has), so
// that errors spread as they do in the height; the squares of what is left of them after the window's mean is
// taken off are averaged over the fields, SlopeEdges::offset_mm() is added, and all is averaged over the 13 x
// 13 pixels around. The errors of slopes are taken for independent from pixel to pixel. Within about 15 % of
// what many fields would give. Does not depend on the number of threads. Memory: 19 bytes a pixel and the
// result.
Image<HalfError> height_errors(const SlopeEdges& edges, const Image<float>& height_mm,
                               const Progress& progress = {});

// Adds what two heights of one painting differ by, less its mean over the window, to the errors of either:
// the mean square over the 13 x 13 pixels around. Errors of 0 stay 0. `other` is overwritten.
void add_disagreement(const Image<float>& height_mm, Image<float>& other, Image<HalfError>& errors);

// The mean over (2 radius + 1)^2 pixels around each, of fewer at the borders. `to` has the size of `from`.
void box_mean(const Image<float>& from, int radius, Image<float>& to);

}  // namespace tangi
