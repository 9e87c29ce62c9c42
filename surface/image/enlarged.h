// enlarged.h: a picture enlarged by a whole number.
#pragma once

#include "surface/image/image.h"

namespace tangi {

// To this size, of a picture that has as many pixels as are needed for it: block (x / factor, y / factor) of
// the result is a pixel of the picture, interpolated between the blocks' middles. Linearly, or by Catmull and
// Rom's cubic (1974, "A class of local interpolating splines"; OpenCV's, with -0.75 for their -0.5).
Image<Vec3> enlarged_linearly(const Image<Vec3>& image, int factor, int width, int height);
Image<float> enlarged_smoothly(const Image<float>& image, int factor, int width, int height);

// A part of it alone, with the same bits.
Image<Vec3> enlarged_linearly(const Image<Vec3>& image, int factor, const Region& part);

}  // namespace tangi
