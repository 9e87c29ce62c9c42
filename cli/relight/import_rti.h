// import_rti.h: paintings of RTI files: polynomial texture maps, harmonics, folders of Relight.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "surface/base/progress.h"

namespace tangi {

// Whether a path is one: .ptm, .rti, or a folder with the info.json of Relight.
bool is_rti(const std::filesystem::path& path);

// Relights the file from directions that it was made of with some certainty, and fits these pictures like
// photographs. The result is that of `fit`, with "from" and its doubts in "poor". Throws Error, Cancelled.
nlohmann::json import_rti(const std::filesystem::path& from, const std::filesystem::path& out,
                          const std::optional<double>& mm_per_pixel, const Progress& progress);

}  // namespace tangi
