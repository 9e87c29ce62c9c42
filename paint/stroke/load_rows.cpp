#include "paint/stroke/load_rows.h"

#include <algorithm>
#include <cmath>

namespace tangi {

namespace {

constexpr double kHalfWay = 0.41421356;  // tangent of half of the angle to the diagonal
constexpr double kTie = 1e-4;            // halves go along the motion, whichever way that is
constexpr double kFurther = 0.25;        // [1] of a step, by which it may be longer than wanted
constexpr double kLittle = 0.1;          // [rows] beside a row within which the brush is on it

}  // namespace

LoadRows rows_across(double dx, double dy) {
    const double x = std::abs(dx), y = std::abs(dy);
    const int sx = dx < 0 ? -1 : 1, sy = dy < 0 ? -1 : 1;
    if (y <= kHalfWay * x) return {sx, 0, x > 0 ? x : 1};
    if (x <= kHalfWay * y) return {0, sy, y};
    return {sx, sy, x + y};
}

LoadPixel pixel_of_row(double x, double y, double dx, double dy, double shift, bool passes) {
    const LoadRows rows = rows_across(dx, dy);
    // Along a row another number counts, of twos on diagonals.
    const LoadRows beside{-rows.ay, rows.ax, 0};
    const int each = rows.ax * rows.ay != 0 ? 2 : 1;
    const double at = rows.at(x, y), slope = beside.at(dx, dy) / rows.per_px;
    const auto row = std::lround(passes ? std::ceil(at - kLittle) : at + kTie);
    const auto first = std::abs(row) % each;
    const double crossing = beside.at(x, y) + slope * (static_cast<double>(row) - at);
    const auto pixel = first + each * std::lround((crossing - static_cast<double>(first)) / each + shift +
                                                  kTie * slope / each);
    return {static_cast<int>((rows.ax * row + beside.ax * pixel) / each),
            static_cast<int>((rows.ay * row + beside.ay * pixel) / each)};
}

double way_to_row_px(const LoadRows& rows, double at, double wanted_px) {
    // What is left of the way to the end of a row, in as many steps as it takes: so each row is passed once.
    double left = std::ceil(at) - at;
    if (left < kLittle) left += 1;
    const double steps = std::max(std::ceil(left / (wanted_px * rows.per_px) - kFurther), 1.0);
    return left / steps / rows.per_px;
}

}  // namespace tangi
