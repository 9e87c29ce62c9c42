// list_order.h: whether photographs fit the lights listed for others: a list that is shifted by some
// photographs, from the start or from one of them on, that runs the other way, or row by row where it should
// column by column (list_slips.h), and whether it fits them in any order.
//
// Where lights stand in rings, such a list is as good as one whose lights are all turned, but for the ends of
// the rings: slopes look turned (axis_check_slopes.h), and turning the lights makes them right for most
// photographs and wrong for the rest. Matt reflection tells which it is: it fits lights that are all turned
// or mirrored as well as the right ones, since the surface turns with them, and lights in another order
// worse.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/stack/stack.h"
#include "capture/stack/stack_calibration.h"
#include "capture/stack/survey.h"
#include "fit/light_checks/axis_check_shadows.h"
#include "fit/light_checks/list_slips.h"

namespace tangi {

struct ListOrder {
    // Another order of the list, which matt reflection fits better than that as listed.
    struct Other {
        std::vector<std::size_t> light_of;  // photograph i fits the light that is listed for light_of[i]
        ListSlip slip;                      // in the order of the photographs
        std::optional<std::size_t> from{};  // the photograph at slip.from, where that is not the first
        bool by_lines = false;   // photographs count by their lines in the list, not by their names
        LightTurn turn;          // what it does to all lights on the whole ...
        double alike = 0;        // ... and how much of what it does that is [1]
        double log_ratio = 0;    // ln of its deviations over those as listed, mean over parts of the picture
        double certainty = 0;    // [standard errors] by which that is below 0
        double scatter_deg = 0;  // as LightOutliers, of the lights that photographs show about these
        double explained = 0;    // [0..1] as below
    };
    // The one that fits best first; of those that fit as well, the simplest.
    std::vector<Other> better;
    double scatter_deg = 0;  // about the lights as listed; 0 where no other order is better
    // Orders that do to all lights what a turn, or a mirror image, does, as of lights in one even ring:
    // shading cannot tell them from it.
    std::vector<Other> as_turns;
    // [0..1] Of what changes from photograph to photograph (list_slips.h): what the list explains, what any
    // three lights could at most, and what random orders of the list do, on average and at most.
    double explained = 0, explainable = 0, by_chance = 0, most_by_chance = 0;

    // Whether shading is that of lights, and the listed ones explain no more of it than 99 random orders do.
    bool fits_no_order() const;
};

// `survey` has one photograph for each light; `lines`: each light's line in the list. Nothing of fewer than 8
// photographs. Deterministic for any number of threads.
ListOrder check_list_order(const Survey& survey, const Transfer& transfer, const std::vector<Light>& lights,
                           const std::vector<int>& lines, int width, int height);

// Of the photographs of a stack.
ListOrder check_list_order(const Survey& survey, const Transfer& transfer, const Stack& stack);

// What is to be done about it, for people; empty where the list is right, or lights that are turned or
// mirrored explain the photographs. `taken`: what was done to the lights already, as the user asked.
// `fits_as_listed`: a surface explains the photographs under these lights as well as honest ones; then only
// an order that explains nearly all is told.
std::string doubt_of(const ListOrder& order, const SignCheck& signs, const LightAxes& taken,
                     const std::vector<std::string>& names, bool fits_as_listed = false);

// That no order of the list that was tried fits; empty where fits_no_order() is false.
std::string doubt_of_any_order(const ListOrder& order);

// What has to be said beside the advice that slopes give, where an order is the same as that turn, with a
// separator before it; empty where none is.
std::string or_order(const ListOrder& order, const SignCheck& signs, const std::vector<std::string>& names);

nlohmann::json to_json(const ListOrder& order);

}  // namespace tangi
