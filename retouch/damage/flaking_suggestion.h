// flaking_suggestion.h: where plates of paint have come up at their edges; for sources of this module only.
//
// Cracks (suggest_craquelure()) are crossed where they are deepest. A crack counts as one between lifted
// edges where both of them rise above the plates behind them by more than paint curls along sound cracks, and
// the gap goes deeper than both plates lie. Ridges that brushes leave beside a dark stroke rise too, but the
// stroke lies no lower than what is around it; and they run beside each other, whereas plates have edges all
// round.
#pragma once

#include <string>
#include <vector>

#include "retouch/damage/area_features.h"
#include "retouch/damage/damage_suggestion.h"

namespace tangi {

struct FlakingArea {
    Area area;              // [blocks]
    double confidence = 0;  // [1]
    std::string cues;
};
// Areas at several thresholds, of which some lie within others; `block`: [pixels] along a side of one.
std::vector<FlakingArea> flaking_areas(const Surface& surface, double mm_per_pixel, double smallest_mm2,
                                       int& block, const Progress& progress = {});

}  // namespace tangi
