// compare_page.h: a comparison as a folder: compare.json for programs, compare.html with pictures for people.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "fit/evaluate/compare.h"

namespace tangi {

// Compares (see compare()) and writes into `folder`, which is made where it is missing:
//   compare.json    to_json(report); each photograph also has "pictures": {"photo", "relit", "error",
//   "delta_e"} compare.html    the page: needs nothing but the pictures, no network; opens from the disk
//   pictures/       per photograph, as sRGB: the photograph, the relit picture, the signed error, CIEDE2000;
//   the maps
// The page is written last, so that one that is there is complete. Errors as compare(), and Error where the
// folder cannot be written.
CompareReport write_comparison(const std::filesystem::path& folder, const Surface& surface,
                               const Stack& photos, const CompareOptions& options = {},
                               const Progress& progress = {}, const RelightingResidual& residual = {});

// The page for a report, given as the JSON that write_comparison() makes. Whatever the names contain, they
// stay text.
std::string comparison_page(const nlohmann::json& report);

}  // namespace tangi
