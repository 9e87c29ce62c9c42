// fit_verdict.h: what `fit` warns of, and what makes its result doubtful as a whole, in words.
#pragma once

#include <string>
#include <vector>

#include "capture/stack/open_screened.h"
#include "fit/pipeline/fit_painting.h"

namespace tangi {

// The report's own warnings, and those of the painting as a whole.
std::vector<std::string> fit_warnings(const FitReport& report);

// What makes the result doubtful as a whole; empty where nothing does. `axes`: as the user said that the
// lights' axes point.
std::vector<std::string> poor_reasons(const FitReport& report, const UsableStack& opened,
                                      const LightAxes& axes);

// What is asked for is a number that the result then does not have; empty where some photograph is still held
// out.
std::string says_none_is_held_out(std::size_t asked, const FitResult& fit);

}  // namespace tangi
