// fit_warnings.h: what a user has to know of the photographs of a fit.
#pragma once

#include "fit/pipeline/fit_passes.h"

namespace tangi {

// Photographs so dark that what is said of their noise and colours may not hold; empty where they are not.
std::string says_too_dark(const Stack& stack, const Survey& surveyed, const Transfer& transfer,
                          const NoiseModel& noise);

// What the model does not explain: by how much, in which photographs and pixels, and what is known of the
// cause. Added to the stack's warnings, as those below.
void warn_of_misfit(Stack& stack, const FitReport& report);

// So much is clipped that what paint reflects is open; or many pixels reflect more than `diffuse_max` [1],
// where it is not, as the white level is too low.
void warn_of_exposure(Stack& stack, const Survey& surveyed, const FitReport& report, double diffuse_max,
                      double white_level);

// Of a fit in steps, whose first pass is over reduced photographs, where these do not suffice.
std::string says_reduced_do_not_suffice(const Stack& stack, const ReducedLook& look);

// Many pixels whose slope the photographs hardly tell.
void warn_of_unsure_pixels(Stack& stack, const FitReport& report);

}  // namespace tangi
