// list_order.h: whether photographs fit the lights listed for others: a list that is shifted by some
// photographs, from the start or from one of them on, or that runs the other way.
//
// Where lamps stand in rings, such a list is as good as one whose lights are all turned, but for the ends of
// the rings: slopes look turned (light_signs.h), and turning the lights makes them right for most photographs
// and wrong for the rest. Matt reflection tells which it is: it fits lights that are all turned or mirrored
// as well as the right ones, since the surface turns with them, and lights in another order worse.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/stack_calibration.h"
#include "capture/survey.h"
#include "fit/shadow_signs.h"

namespace tangi {

struct ListOrder {
    // Another order of the list, which matt reflection fits better than that as listed.
    struct Other {
        std::vector<std::size_t> light_of;  // photograph i fits the light that is listed for light_of[i]
        int shift = 0;                      // in the order of the photographs
        std::optional<std::size_t> from{};  // ... from this photograph on, where not from the first
        bool reversed = false;
        bool by_lines = false;   // photographs count by their lines in the list, not by their names
        LightTurn turn;          // what it does to all lights on the whole ...
        double alike = 0;        // ... and how much of what it does that is [1]
        double log_ratio = 0;    // ln of its deviations over those as listed, mean over parts of the picture
        double certainty = 0;    // [standard errors] by which that is below 0
        double scatter_deg = 0;  // as LightOutliers, of the lights that photographs show about these
    };
    std::vector<Other> better;  // the one that fits best first
    double scatter_deg = 0;     // about the lights as listed; 0 where no other order is better
};

// `survey` has one photograph for each light; `lines`: each light's line in the list. Nothing of fewer than 8
// photographs. Deterministic for any number of threads.
ListOrder check_list_order(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights,
                           const std::vector<int>& lines, int width, int height);

// What is to be done about it, for people; empty where the list is right, or lights that are turned or
// mirrored explain the photographs. `taken`: what was done to the lights already, as the user asked.
std::string doubt_of(const ListOrder& order, const SignCheck& signs, const LightFlips& taken,
                     const std::vector<std::string>& names);

nlohmann::json to_json(const ListOrder& order);

}  // namespace tangi
