// export_painting.h: what `export` does, for the window.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "paint/canvas/canvas.h"
#include "surface/base/progress.h"
#include "surface/painting_file/painting_parts.h"
#include "viewer/model/export_format.h"

namespace tangi {

// What `tangipaint export PAINTING --to FORMAT --out OUT` would write if the painting were saved as it is
// now: what is on the canvas, and the palette and brush (palette_part.h). The painting's file need not be
// there. Throws Error, UsageError, Cancelled.
nlohmann::json export_canvas(const Canvas& canvas, const std::vector<PartToWrite>& tools,
                             const std::filesystem::path& painting, const std::string& format,
                             const std::filesystem::path& out, const Progress& progress);

// Those of `tangipaint export` that the window offers, in the order of its menu.
std::vector<ExportFormat> exports_of_window();

}  // namespace tangi
