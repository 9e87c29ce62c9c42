// enlarged.h: a picture enlarged by a whole number.
#pragma once

#include "surface/image/image.h"

namespace tangi {

// Pixel (x, y) of the result is pixel (x / factor, y / factor) of the picture, which has as many as are
// needed for a result of this size.
template <class T>
Image<T> enlarged_blocks(const Image<T>& image, int factor, int width, int height) {
    Image<T> result(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) result(x, y) = image(x / factor, y / factor);
    return result;
}

// The same, interpolated between the middles of these blocks: linearly, and by Catmull and Rom's cubic (1974,
// "A class of local interpolating splines"; OpenCV's, with -0.75 for their -0.5).
Image<Vec3> enlarged_linearly(const Image<Vec3>& image, int factor, int width, int height);
Image<float> enlarged_smoothly(const Image<float>& image, int factor, int width, int height);

}  // namespace tangi
