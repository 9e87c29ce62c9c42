// tip_outline.h: which columns of a row of pixels a turned tip meets at most.
#pragma once

#include <algorithm>
#include <cmath>

#include "paint/transfer.h"

namespace tangi {

// The turned rectangle or ellipse around the bristles, as rows cut it.
struct TipOutline {
    double a, b;  // [pixels] half extents
    double c, s;  // cosine and sine of the rotation
    bool ellipse;

    // Columns of a row `py` pixels below the middle that begins at `px` from it.
    RowSpan across(double py, double px, int width) const {
        double low = -1e9, high = 1e9;
        if (ellipse) {
            // (x c + y s)^2 / a^2 + (y c - x s)^2 / b^2 = 1 as a quadratic in x.
            const double p = c * c / (a * a) + s * s / (b * b), q = py * c * s * (1 / (a * a) - 1 / (b * b));
            const double r = py * py * (s * s / (a * a) + c * c / (b * b)) - 1, root2 = q * q - p * r;
            if (!(root2 >= 0)) return {0, 0};
            low = (-q - std::sqrt(root2)) / p;
            high = (-q + std::sqrt(root2)) / p;
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
            cut(c, py * s, a);
            cut(-s, py * c, b);
        }
        if (!(high >= low)) return {0, 0};
        const double begin = std::clamp(std::floor(low - px), 0.0, static_cast<double>(width));
        const double end = std::clamp(std::ceil(high - px) + 1, 0.0, static_cast<double>(width));
        return {static_cast<int>(begin), static_cast<int>(end)};
    }
};

}  // namespace tangi
