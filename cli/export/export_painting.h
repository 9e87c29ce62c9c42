// export_painting.h: what `export` does, for the window.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "surface/base/progress.h"
#include "viewer/model/export_format.h"
#include "viewer/model/host_services.h"

namespace tangi {

// What `tangipaint export PAINTING --to FORMAT --out OUT` would write if the painting were saved as it is
// now, with its annotations where the format takes them. The painting's file need not be there. Throws Error,
// UsageError, Cancelled.
nlohmann::json export_canvas(const ShownPainting& shown, const std::string& format,
                             const std::filesystem::path& out, const Progress& progress);

// Those of `tangipaint export` that the window offers, in the order of its menu.
std::vector<ExportFormat> exports_of_window();

}  // namespace tangi
