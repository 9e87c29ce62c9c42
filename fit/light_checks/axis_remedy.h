// axis_remedy.h: the flags --light-axes and --light-rotation-deg that mend a lights file whose axes are
// wrong.
#pragma once

#include <string>

#include "capture/stack/stack_calibration.h"
#include "fit/light_checks/axis_check_slopes.h"

namespace tangi {

// What the flags do to x and y of all lights.
LightTurn light_turn_of(const LightAxes& axes);

// The flags that do so: axes alone where these can say it, a rotation alone where nothing is mirrored.
LightAxes light_axes_of(const LightTurn& turn);

// [deg] In (-180, 180] instead of [0, 360): a small turn looks small.
double signed_deg(double deg);

// "give --light-axes x,-y,z and leave out --light-rotation-deg". `taken`: what was done to the lights
// already, as the user asked; `turn`: what mends the lights as they were taken. What is given is all that is
// wanted, in place of all that was given.
std::string axes_remedy(const LightAxes& taken, const LightTurn& turn);

// The flags that were given, each with a space before it.
std::string flags_given(const LightAxes& taken);

}  // namespace tangi
