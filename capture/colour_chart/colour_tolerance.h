// colour_tolerance.h: which level of the digitisation guidelines a colour correction reaches.
//
// Only limits on colour that could be looked up are here; guidelines limit much else (resolution, noise,
// tone). They are stated for certain targets and for all light on the picture being even: a level reached on
// the classic chart says that colour is no obstacle, not that a capture complies.
#pragma once

#include <nlohmann/json.hpp>

#include "capture/colour_chart/chart_colour.h"

namespace tangi {

// One limit of one level.
struct ToleranceCheck {
    std::string quantity;  // "mean", "maximum", "90th percentile", "neutral"
    double limit = 0;      // CIEDE2000
    double value = 0;
    bool inclusive = true;  // the limit itself is within
    bool kept() const { return inclusive ? value <= limit : value < limit; }
};

struct ToleranceResult {
    std::string standard;                // with its edition
    std::string source;                  // where the limits were looked up
    std::string level;                   // the best level of which all limits are kept; empty: none
    std::vector<ToleranceCheck> checks;  // of that level, or of the lowest where none is reached
    std::string next_level;              // the one above, and
    std::vector<ToleranceCheck> missed;  // what it takes; empty at the top
};

std::vector<ToleranceResult> judge_colours(const ColourCorrection& correction);

nlohmann::json to_json(const std::vector<ToleranceResult>& results);

}  // namespace tangi
