// subpixel_slopes.h: the mean slope of the relief that a pixel mixes, which is steeper than the slope of its
// normal.
//
// What photometric stereo shows of a pixel is the mean of the normals in it, and the steeper a normal is the
// shorter is its part along z: to second order in how much slopes s vary within the pixel (variance v along
// the slope), the mean slope is
//   s (1 + v / (1 + s^2))
// with s the slope of the mean normal. Integrated as they are, slopes give ridges that are too low, and
// shadows that are too short.
#pragma once

#include "fit/pixel/fit_errors.h"
#include "surface/maps/surface.h"

namespace tangi {

// Normals whose slopes are those means. v is unknown, and taken for `mixing` [1] times the square of what
// slopes differ by between the pixel and its neighbours (slope_spread() of slope_edges.h): 1/12 where they
// change evenly, more where relief is finer than a pixel. Less a twelfth of the second difference along its
// own axis, so that the mean of two neighbours is their integral to the fourth order (Simpson's correction of
// the trapezoid that integrate_normals() takes). Pixels of confidence 0 stay as they are, and have no say in
// others.
Image<Vec3> steepened_normals(const Image<Vec3>& normal, const Image<float>& confidence, double mixing);

// Adds to the standard errors of slopes what a pixel's mixing leaves unknown: brighter parts of it have more
// of a say in its normal, and which these are does not show. In quadrature, a part of slope_spread().
void add_mixing_error(const Image<Vec3>& normal, const Image<float>& confidence,
                      Image<HalfError>& slope_error);

}  // namespace tangi
