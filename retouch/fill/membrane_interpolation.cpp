// membrane_interpolation.cpp: values go on over an area as a membrane that is fixed at its border.
#include <algorithm>
#include <cmath>

#include "retouch/fill/fill.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

// Halves the picture: mean of what is known; a pixel is unknown where all four are.
void halve(const Image<float>& values, const Mask& unknown, Image<float>& less, Mask& less_unknown) {
    less = Image<float>((values.width() + 1) / 2, (values.height() + 1) / 2);
    less_unknown = Mask(less.width(), less.height());
    for (int y = 0; y < less.height(); ++y)
        for (int x = 0; x < less.width(); ++x) {
            float sum = 0, count = 0;
            for (int k = 0; k < 4; ++k) {
                const int px = 2 * x + k % 2, py = 2 * y + k / 2;
                if (px >= values.width() || py >= values.height() || unknown(px, py) > 0.5f) continue;
                sum += values(px, py);
                count += 1;
            }
            less(x, y) = count > 0 ? sum / count : 0;
            less_unknown(x, y) = count > 0 ? 0.0f : 1.0f;
        }
}

// Successive over-relaxation, rows in order; the picture's border reflects.
void relax(Image<float>& values, const Mask& unknown, int sweeps) {
    constexpr float omega = 1.7f;
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (int y = 0; y < values.height(); ++y)
            for (int x = 0; x < values.width(); ++x) {
                if (!(unknown(x, y) > 0.5f)) continue;
                float sum = 0, count = 0;
                const auto add = [&](int px, int py) {
                    if (px < 0 || py < 0 || px >= values.width() || py >= values.height()) return;
                    sum += values(px, py);
                    count += 1;
                };
                add(x - 1, y), add(x + 1, y), add(x, y - 1), add(x, y + 1);
                values(x, y) += omega * (sum / count - values(x, y));
            }
}

void solve(Image<float>& values, const Mask& unknown) {
    const auto left =
        std::count_if(unknown.pixels().begin(), unknown.pixels().end(), [](float u) { return u > 0.5f; });
    if (left == 0) return;
    if (std::min(values.width(), values.height()) > 4) {
        Image<float> less;
        Mask less_unknown;
        halve(values, unknown, less, less_unknown);
        solve(less, less_unknown);
        for (int y = 0; y < values.height(); ++y)  // the coarse solution, linear in between
            for (int x = 0; x < values.width(); ++x) {
                if (!(unknown(x, y) > 0.5f)) continue;
                const int bx = x / 2, by = y / 2, nx = bx + (x % 2 ? 1 : -1), ny = by + (y % 2 ? 1 : -1);
                values(x, y) = (9 * less(bx, by) + 3 * less.clamped(nx, by) + 3 * less.clamped(bx, ny) +
                                less.clamped(nx, ny)) /
                               16;
            }
        relax(values, unknown, 120);
    } else {
        relax(values, unknown, 100);
    }
}

}  // namespace

void solve_membrane(Image<float>& values, const Mask& unknown) {
    TP_REQUIRE(values.region() == unknown.region(), "an area has the size of the values");
    const bool any_known =
        std::any_of(unknown.pixels().begin(), unknown.pixels().end(), [](float u) { return !(u > 0.5f); });
    TP_REQUIRE(any_known, "a membrane is fixed somewhere");
    solve(values, unknown);
}

}  // namespace tangi
