// height_rows.h: rows of the height's equations (height_grid.h) in vectors: one row of a grid and those
// beside it, whose edges are weighted in floats or, on the finest grid, in their halves.
#pragma once

#include <algorithm>

#include "fit/pixel/fit_errors.h"
#include "surface/image/image.h"

namespace tangi {

// Row y of a grid of `width` pixels. At the top there is no edge upwards (`has_above` 0), at the bottom
// `down` holds zeros; the row that is not there may be any other.
template <class Weight>
struct HeightRow {
    int width = 0;
    const Weight *right = nullptr, *up = nullptr, *down = nullptr;  // weights; `up` is `down` of row y - 1
    const float *above = nullptr, *here = nullptr, *below = nullptr;
    float has_above = 1;
};

// Row y of u, with the weights of the edges to the right and downwards.
template <class Weight>
HeightRow<Weight> height_row(const Image<float>& u, int y, const Image<Weight>& right,
                             const Image<Weight>& down) {
    const int above = std::max(y - 1, 0), below = std::min(y + 1, u.height() - 1);
    return {u.width(),           right.row(y).data(), down.row(above).data(), down.row(y).data(),
            u.row(above).data(), u.row(y).data(),     u.row(below).data(),    y > 0 ? 1.0f : 0.0f};
}

// (A u)(x) of the row.
void apply_row(const HeightRow<float>& row, float* applied);
void apply_row(const HeightRow<HalfError>& row, float* applied);

// What each pixel of the row is to be for its equation to hold: (b + sum of weight * neighbour) / weights;
// as it is where it has no edge.
void solve_row(const HeightRow<float>& row, const float* b, float* solved);
void solve_row(const HeightRow<HalfError>& row, const float* b, float* solved);

// What a row gets from the next coarser grid: values of the nearest coarse pixel, of its neighbour along the
// row, and of those of both across it, for each pixel of the row.
struct CoarseAround {
    const float *own, *along, *across, *both;
};

// Interpolated bilinearly: centres of fine pixels lie a quarter coarse pixel off. The neighbours of the row's
// even pixels lie to their left, those of the odd ones to their right; `downwards`: across is below. One
// behind a weak edge has less of a say, so that nothing is smeared over the border of what was measured.
void interpolate_row(const HeightRow<float>& row, const CoarseAround& coarse, bool downwards, float* values);
void interpolate_row(const HeightRow<HalfError>& row, const CoarseAround& coarse, bool downwards,
                     float* values);

// Sums over rows of n floats, in doubles and in an order that no processor changes: of a b, of a (b - c) and
// of (a - b)^2.
double product(int n, const float* a, const float* b);
double product_of_rest(int n, const float* a, const float* b, const float* c);
double squared_difference(int n, const float* a, const float* b);

}  // namespace tangi
