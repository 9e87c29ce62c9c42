// fit_steps.h: `fit` in steps, each a command on files: --plan, --tiles, --finish.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/capture/fit_arguments.h"
#include "surface/base/progress.h"

namespace tangi {

enum class FitStep { plan, tiles, finish };

// None where the whole fit is asked for. Throws UsageError for flags that do not go together: what a plan was
// made with is not to be said again.
std::optional<FitStep> fit_step_of(const FitArguments& arguments, const std::vector<std::string>& typed);

nlohmann::json run_fit_step(FitStep step, FitArguments arguments, const Progress& progress);

// Of results that are no painting.
std::vector<std::string> fit_step_in_words(const nlohmann::json& result);

}  // namespace tangi
