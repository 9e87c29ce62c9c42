// chart_order.h: whether 24 colours are those of the classic chart, in this order, whatever the camera and
// the light.
#pragma once

#include "capture/colour_chart/colour_chart.h"

namespace tangi {

using ChartColours = std::array<glm::dvec3, kChartPatches>;

// Medians over the middle of each patch; negative where a patch is not in the picture.
ChartColours sampled_patches(const Image<Rgb>& linear, const Homography& chart_to_picture);

// [1] Misfit of colours in this order: a 3x3 matrix and a plane of light's logarithm are fitted (least
// squares of relative errors, reweighted by Cauchy's function), and the median distance of the patches from
// the chart's in cube roots of linear Rec. 709 is taken, so that a few patches in shadow do not matter. 0.02
// is good; other orders of the same colours are above 0.15. Infinite with fewer than 12 patches in the
// picture.
double order_misfit(const ChartColours& colours);

}  // namespace tangi
