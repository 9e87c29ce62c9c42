// export_layers.h: the paint of a canvas as a folder for each layer, and what its files are.
#pragma once

#include <filesystem>

#include "paint/canvas/canvas.h"
#include "surface/base/progress.h"

namespace tangi {

// NUMBER-NAME/ for each layer that holds paint, from the bottom up, with colour.png (16 bit, alpha),
// thickness_mm.exr and the volume of each ingredient [mm^3/mm^2 = mm], NNNNN-NAME_mm.exr, NNNNN its number;
// names as far as they can be those of files. layers.json says of each what it is
// (docs/reference/export-formats.md). Throws Error where the folder cannot be written.
void write_layers(const std::filesystem::path& folder, const Canvas& canvas, const Progress& progress);

}  // namespace tangi
