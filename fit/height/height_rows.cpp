#include "fit/height/height_rows.h"

#include <algorithm>

#include "surface/base/vector_clones.h"

namespace tangi {

namespace {

// Sum of weights and of weight * value over the neighbours of a pixel that has one on either side.
template <class Weight>
TP_INLINE void neighbours(const HeightRow<Weight>& row, int x, float l, float r, float left, float right,
                          float& weights, float& weighted) {
    const float t = row.has_above * float(row.up[x]), d = float(row.down[x]);
    weights = l + r + t + d;
    weighted = l * left + r * right + t * row.above[x] + d * row.below[x];
}

// Calls at(x, weights, weighted) for each pixel. The ends of the row apart from the rest, which becomes
// vectors.
template <class Weight, class At>
TP_INLINE void for_pixels(const HeightRow<Weight>& all, const At& at) {
    const HeightRow<Weight> row = all;  // a copy, which nothing that is written can change
    const int last = row.width - 1;
    float weights, weighted;
    neighbours(row, 0, 0, last > 0 ? float(row.right[0]) : 0.0f, 0, last > 0 ? row.here[1] : 0.0f, weights,
               weighted);
    at(0, weights, weighted);
    for (int x = 1; x < last; ++x) {
        float sum, of_values;
        neighbours(row, x, float(row.right[x - 1]), float(row.right[x]), row.here[x - 1], row.here[x + 1],
                   sum, of_values);
        at(x, sum, of_values);
    }
    if (last == 0) return;
    neighbours(row, last, float(row.right[last - 1]), 0, row.here[last - 1], 0, weights, weighted);
    at(last, weights, weighted);
}

template <class Weight>
TP_INLINE void apply(const HeightRow<Weight>& row, float* __restrict applied) {
    const float* __restrict here = row.here;
    for_pixels(
        row, [&](int x, float sum, float weighted)
                 __attribute__((always_inline)) { applied[x] = sum * here[x] - weighted; });
}

template <class Weight>
TP_INLINE void solve(const HeightRow<Weight>& row, const float* __restrict b, float* __restrict solved) {
    const float* __restrict here = row.here;
    for_pixels(
        row, [&](int x, float sum, float weighted) __attribute__((always_inline)) {
            const float value = (b[x] + weighted) / sum;
            solved[x] = sum > 0 ? value : here[x];
        });
}

template <class Weight>
TP_INLINE void interpolate(const HeightRow<Weight>& row, const CoarseAround& coarse, bool downwards,
                           float* __restrict values) {
    const float *__restrict own = coarse.own, * __restrict along = coarse.along, * __restrict across = coarse.across, * __restrict both = coarse.both;
    const float has_above = row.has_above, way_down = downwards ? 1.0f : 0.0f;
    const Weight* __restrict right = row.right, * __restrict up = row.up, * __restrict down = row.down;
    const auto at = [&](int x, float l, float r) __attribute__((always_inline)) {
        const float t = has_above * float(up[x]), d = float(down[x]);
        const float strongest = std::max(std::max(std::max(l, r), std::max(t, d)), 1e-20f);
        const float a = (x & 1 ? r : l) / strongest, b = (way_down > 0 ? d : t) / strongest;
        const float sum = 9 * own[x] + 3 * a * along[x] + 3 * b * across[x] + a * b * both[x];
        values[x] = sum / (9 + 3 * a + 3 * b + a * b);
    };
    const int last = row.width - 1;
    at(0, 0, last > 0 ? float(right[0]) : 0.0f);
    for (int x = 1; x < last; ++x) at(x, float(right[x - 1]), float(right[x]));
    if (last > 0) at(last, float(right[last - 1]), 0);
}

}  // namespace

TP_VECTOR_CLONES
void apply_row(const HeightRow<float>& row, float* applied) { apply(row, applied); }
TP_VECTOR_CLONES
void apply_row(const HeightRow<HalfError>& row, float* applied) { apply(row, applied); }
TP_VECTOR_CLONES
void solve_row(const HeightRow<float>& row, const float* b, float* solved) { solve(row, b, solved); }
TP_VECTOR_CLONES
void solve_row(const HeightRow<HalfError>& row, const float* b, float* solved) { solve(row, b, solved); }
TP_VECTOR_CLONES
void interpolate_row(const HeightRow<float>& row, const CoarseAround& coarse, bool downwards, float* values) {
    interpolate(row, coarse, downwards, values);
}
TP_VECTOR_CLONES
void interpolate_row(const HeightRow<HalfError>& row, const CoarseAround& coarse, bool downwards,
                     float* values) {
    interpolate(row, coarse, downwards, values);
}

namespace {

constexpr int kSums = 16;  // side by side

// Sum of term(i) over i < n.
template <class Term>
TP_INLINE double sum_of(int n, const Term& term) {
    double sums[kSums] = {};
    int i = 0;
    for (; i + kSums <= n; i += kSums)
        for (int k = 0; k < kSums; ++k) sums[k] += term(i + k);
    for (int k = 0; i + k < n; ++k) sums[k] += term(i + k);
    double all = 0;
    for (const double sum : sums) all += sum;
    return all;
}

}  // namespace

TP_VECTOR_CLONES
double product(int n, const float* a, const float* b) {
    return sum_of(n, [&](int i) TP_INLINE_LAMBDA { return double(a[i]) * double(b[i]); });
}

TP_VECTOR_CLONES
double product_of_rest(int n, const float* a, const float* b, const float* c) {
    return sum_of(n, [&](int i) TP_INLINE_LAMBDA { return double(a[i]) * double(b[i] - c[i]); });
}

TP_VECTOR_CLONES
double squared_difference(int n, const float* a, const float* b) {
    return sum_of(n, [&](int i) TP_INLINE_LAMBDA {
        const double off = a[i] - b[i];
        return off * off;
    });
}

}  // namespace tangi
