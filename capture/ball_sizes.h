// ball_sizes.h: balls are taken to be of one size, in one plane: what else shows lamps is none.
//
// A glossy bump of a painting is a small convex mirror, too, and shows where the lamps are about as well as a
// ball does; its size gives it away.
#pragma once

#include "capture/ball_calibration.h"

namespace tangi {

// Whether two radii differ by less than lengths that were measured, or outlines, may be off: a factor of 1.3.
bool is_of_size(double radius_px, double expected_px);

// [px] Radius that balls must be seen with as the user's numbers say: focal length · radius / depth, or
// radius / (size of a pixel on the painting). Nothing where these are not all given. Photographs are
// width x height pixels.
std::optional<double> expected_radius_px(const BallCalibrationOptions& options, int width, int height);

// Of balls that nobody spoke of, keeps those of the expected size where there are any; else those of the size
// that most speaks for: highlights found and outline seen, summed over all balls of that size. Others are
// left out, each with a warning.
void keep_one_size(BallSearch& search, const std::optional<double>& expected_px);

}  // namespace tangi
