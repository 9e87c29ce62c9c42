// fit_result.h: the result of a fit as JSON, as `fit` prints it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capture/stack/open_screened.h"
#include "fit/pipeline/fit_painting.h"

namespace tangi {

// All of it but "residual", "development", "warnings" and "poor". `out`: the painting, as it was asked for.
nlohmann::json fit_result(const FitResult& fit, const std::vector<RejectedPhoto>& rejected,
                          const std::string& out);

}  // namespace tangi
