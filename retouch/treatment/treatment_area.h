// treatment_area.h: areas and lengths as a treatment states them: in cm2 and mm where the painting's scale is
// known, in pixels where it is not, which are no measure of anything.
#pragma once

#include <string>
#include <string_view>

#include "retouch/damage/damage_suggestion.h"
#include "retouch/treatment/treatment.h"

namespace tangi {

// {"area_cm2": 3.31} or, where the scale is unknown, {"area_px": 2168}. `mm2` is in the treatment's
// millimetres, of which a pixel counts as one where the scale is unknown.
nlohmann::json area_of_step(double mm2, double mm_per_pixel, bool scale_known);
nlohmann::json area_of_step(const Treatment& treatment, double mm2);

// "3.31 cm²" or "2168 pixels", of either.
std::string area_in_words(const nlohmann::json& stated);

// Results with every "…_mm", "…_mm2" and "…_mm3" (of which a pixel counts as `mm_per_pixel`) as it is where
// the scale is known; else named and told in pixels: "deepest_px", "area_px", "volume_px3".
nlohmann::json in_known_units(const nlohmann::json& results, double mm_per_pixel, bool scale_known);
nlohmann::json in_known_units(const nlohmann::json& results, const Treatment& treatment);

// Craquelure as it was measured; how dense it is only where the scale is known.
nlohmann::json as_stated(const CraquelureMeasure& measure, double mm_per_pixel, bool scale_known);
// "120.3 cm long in all, 0.21 mm wide on average, 1.02 cm on each cm²"
std::string in_words(const CraquelureMeasure& measure, double mm_per_pixel, bool scale_known);

// What in_known_units() made of "height_mm", "area_mm2" and the like: its value, and how its unit is written:
// " mm", " px".
struct StatedLength {
    const nlohmann::json& value;
    std::string_view unit;
};
StatedLength stated_length(const nlohmann::json& results, const std::string& name,
                           const std::string& ending = "_mm");

}  // namespace tangi
