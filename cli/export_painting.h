// export_painting.h: what `export` does, for the window.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "paint/canvas.h"
#include "surface/progress.h"

namespace tangi {

// As `tangipaint export PAINTING --to FORMAT --out OUT` of what is on the canvas, which is that of the
// painting with what was not saved yet; the painting's file need not be there. Throws Error, UsageError,
// Cancelled.
nlohmann::json export_canvas(const Canvas& canvas, const std::filesystem::path& painting,
                             const std::string& format, const std::filesystem::path& out,
                             const Progress& progress);

}  // namespace tangi
