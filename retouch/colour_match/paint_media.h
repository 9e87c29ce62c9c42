// paint_media.h: which of a box's paints colour, and which only make others transparent.
#pragma once

#include <string>
#include <vector>

#include "paint/optics/palette.h"

namespace tangi {

// A medium: in a film of 0.1 mm, at which paints hide (kHidingThickness_mm), it changes the looks of white
// (0.8) and of black (0.01) by less than CIEDE2000 20. The built-in paints change one of them by 43 at least,
// thinned with 95 % of clear medium still by 21; varnishes and gels, somewhat yellow or cloudy, by up to 18.
// However thick paint is taken to lie, such a medium has a colour by its K/S, which nobody sees.
bool is_medium(const Pigment& paint);

// Takes the media out of a box that recipes are made from. Returns their names.
std::vector<std::string> take_out_media(Palette& box);

}  // namespace tangi
