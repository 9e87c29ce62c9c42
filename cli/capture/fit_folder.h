// fit_folder.h: what `fit` does, for the window.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "surface/base/progress.h"

namespace tangi {

// As `tangipaint fit FOLDER --out OUT`, or of a lights file `fit ITS_FOLDER --lights FILE --out OUT`: its
// result. Throws Error, Cancelled.
nlohmann::json fit_folder(const std::filesystem::path& photographs, const std::filesystem::path& out,
                          const Progress& progress);

}  // namespace tangi
