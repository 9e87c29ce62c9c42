// local_contrast.h: pictures in which the strength of the light drops out, and their values between pixels.
#pragma once

#include <glm/vec2.hpp>

#include "surface/image/image.h"

namespace tangi {

// (value - local mean) / (local mean + floor), slightly smoothed: the same under lights of any strength, and
// where the surface is flat, under lights from anywhere. Between -1 and 1; NaN where the brightness is, which
// its neighbours do not notice.
Image<float> local_contrast(const Image<float>& brightness, double floor);

// Value and gradient at a point, by cubic convolution (Keys 1981); false within a pixel of the border,
// outside, and where one of the 16 pixels around it is NaN.
bool sample_at(const Image<float>& image, const glm::dvec2& p, float& value, float& dx, float& dy);

}  // namespace tangi
