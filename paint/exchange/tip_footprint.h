// tip_footprint.h: which columns of a row of pixels a turned tip meets at most.
#pragma once

#include <algorithm>
#include <cmath>

#include "paint/exchange/transfer.h"

namespace tangi {

// The turned rectangle or ellipse around the bristles, as rows cut it.
class TipOutline {
public:
    // [pixels] half extents; cosine and sine of the rotation.
    TipOutline(double a, double b, double c, double s, bool ellipse)
        : a_(a), b_(b), c_(c), s_(s), ellipse_(ellipse) {
        const double aa = 1 / (a * a), bb = 1 / (b * b);
        per_x2_ = 1 / (c * c * aa + s * s * bb);
        xy_ = c * s * (aa - bb) * per_x2_;
        y2_ = (s * s * aa + c * c * bb) * per_x2_;
    }

    // Columns of a row `py` pixels below the middle that begins at `px` from it.
    RowSpan across(double py, double px, int width) const {
        double low = -1e9, high = 1e9;
        if (ellipse_) {
            const double middle = -py * xy_, root2 = middle * middle - (py * py * y2_ - per_x2_);
            if (!(root2 >= 0)) return {0, 0};
            const double root = std::sqrt(root2);
            low = middle - root;
            high = middle + root;
        } else {
            const auto cut = [&](double slope, double offset, double half) {  // |slope x + offset| <= half
                if (std::abs(slope) < 1e-9) {
                    if (std::abs(offset) > half) high = -1e9;
                    return;
                }
                const double one = (-half - offset) / slope, other = (half - offset) / slope;
                low = std::max(low, std::min(one, other));
                high = std::min(high, std::max(one, other));
            };
            cut(c_, py * s_, a_);
            cut(-s_, py * c_, b_);
        }
        if (!(high >= low)) return {0, 0};
        const double begin = std::clamp(std::floor(low - px), 0.0, static_cast<double>(width));
        const double end = std::clamp(std::ceil(high - px) + 1, 0.0, static_cast<double>(width));
        return {static_cast<int>(begin), static_cast<int>(end)};
    }

private:
    double a_, b_, c_, s_;
    bool ellipse_;
    // (x c + y s)^2 / a^2 + (y c - x s)^2 / b^2 = 1 as a quadratic in x: over the factor of x^2, those of x y
    // (halved) and of y^2, and 1.
    double per_x2_, xy_, y2_;
};

}  // namespace tangi
