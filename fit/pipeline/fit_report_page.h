// fit_report_page.h: how a fit understood its photographs, for people: lights, strengths, drift, transfer
// curve, misfit, each with its uncertainty, and the maps.
#pragma once

#include <filesystem>
#include <string>

#include "fit/pipeline/fit_painting.h"

namespace tangi {

// Whole page, one file. `scratch` as for picture_url(). Whatever names contain, they stay text.
std::string fit_page(const FitResult& fit, const std::string& title, const std::filesystem::path& scratch);

}  // namespace tangi
