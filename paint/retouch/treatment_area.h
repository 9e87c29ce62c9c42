// treatment_area.h: areas as a treatment states them: in cm2 where the painting's scale is known, in pixels
// where it is not, which are no measure of anything.
#pragma once

#include <string>

#include "paint/retouch/treatment.h"

namespace tangi {

// {"area_cm2": 3.31} or, where the scale is unknown, {"area_px": 2168}. `mm2` is in the treatment's
// millimetres, of which a pixel counts as one where the scale is unknown.
nlohmann::json area_of_step(double mm2, double mm_per_pixel, bool scale_known);
nlohmann::json area_of_step(const Treatment& treatment, double mm2);

// "3.31 cm²" or "2168 pixels", of either.
std::string area_in_words(const nlohmann::json& stated);

}  // namespace tangi
