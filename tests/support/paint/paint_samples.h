// paint_samples.h: maps of painted thickness between their pixels, for tests that look along and across
// strokes.
#pragma once

#include <cmath>

#include "surface/image/image.h"

namespace tangi {

// Bilinear; (x, y) [pixels] lies within the image.
inline double sampled(const Image<float>& image, double x, double y) {
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const double fx = x - ix, fy = y - iy;
    return (image(ix, iy) * (1 - fx) + image(ix + 1, iy) * fx) * (1 - fy) +
           (image(ix, iy + 1) * (1 - fx) + image(ix + 1, iy + 1) * fx) * fy;
}

}  // namespace tangi
