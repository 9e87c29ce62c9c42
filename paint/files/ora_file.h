// ora_file.h: a painted canvas as an OpenRaster file (.ora), which Krita, GIMP, MyPaint and others open as a
// picture with layers (openraster.org, version 0.0.5).
//
// Colours are the paints' (rho_d), without light. Further members, which those programs leave alone:
// tangipaint/height.png (16 bit, 0..1 between the heights that painting.json says), tangipaint/painting.json
// (scale, heights, and the paints of each layer as paint_metadata.h has them), and tangipaint/painting.exr,
// the painting file itself with every recipe.
#pragma once

#include <span>

#include "paint/canvas/canvas.h"
#include "surface/base/progress.h"
#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

// Whole or not at all; `further` parts of the painting file, as write_canvas() takes them. Throws Error
// naming the file where it cannot be written.
void write_ora(AtomicFile& file, const Canvas& canvas, const Progress& progress = {},
               std::span<const PartToWrite> further = {});

}  // namespace tangi
