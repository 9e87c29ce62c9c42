// ambient_light_tracking.h: the light of the room as a camera at the screen sees it (thesis 5.2.2): its
// brightest direction.
#pragma once

#include <optional>

#include "viewer/devices/head_tracking.h"

namespace tangi {

// The brightest direction in a camera's picture [luminance, linear, any scale; some 64 pixels wide will do],
// blurred by a tenth of its width: the middle of what is within 5 % of the maximum, since a window or light
// is clipped as a whole. Nothing where the picture is dark, or evenly bright: then no direction stands out.
std::optional<Vec3> brightest_direction(const Image<float>& luminance,
                                        double camera_width_deg = kCameraWidth_deg);

}  // namespace tangi
