// canvas_file.h: a painted canvas as a painting file: part `dry` as it was, `wet`, and `dried.0`, `dried.1`,
// …
//
// Paint parts have a channel `volume.NNNNN` [mm^3/mm^2 = mm] for each ingredient that occurs in them, NNNNN
// its number in the attribute `ingredients` of part `wet`: a JSON list of name, k, s (12 bands, 1/mm),
// specular, roughness. Dried parts have their layer's name in the attribute `layer`, and `levels` where it
// does (canvas.h); they lie on each other in the order of their numbers.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "paint/canvas/appearance.h"
#include "paint/canvas/canvas.h"
#include "surface/base/progress.h"
#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_output.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_reader.h"

namespace tangi {

// Whole or not at all; `further` parts, of other modules, come after those of the paint. Throws Error naming
// the file where it cannot be written.
void write_canvas(AtomicFile& file, const Canvas& canvas, const Progress& progress = {},
                  std::span<const PartToWrite> further = {});
// The same, but not put in place: what fills the temporary file becomes a part of another file.
void fill_canvas(const AtomicFile& file, const Canvas& canvas, const Progress& progress,
                 std::span<const PartToWrite> further);
void fill_canvas(PaintingOutput& output, const Canvas& canvas, const Progress& progress,
                 std::span<const PartToWrite> further);
void write_canvas(const std::filesystem::path& path, const Canvas& canvas, const Progress& progress = {});

// What a painting file holds beside dry surface and paint (parts of other modules: standard errors, the
// residual of the relighting residual), read into memory, to be written again with the canvas. Throws Error
// as read_painting_part().
std::vector<PartToWrite> parts_beside_paint(const std::filesystem::path& path, const Progress& progress = {});

// The canvas with all its paint, bit for bit (`mm_per_pixel`: the scale where the painting's is unknown,
// canvas.h; kept in the attribute `paint_mm_per_pixel`); one that was never painted on has none. Throws Error
// naming the file, the part and the place: not a painting, damaged, volumes that are negative or not finite,
// unknown ingredients.
Canvas read_canvas(const std::filesystem::path& path, const Progress& progress = {},
                   std::optional<double> mm_per_pixel = {});

// What the painting looks like with its paint (appearance.h); one that was never painted on as
// read_painting().
Surface read_painted(const std::filesystem::path& path, const Progress& progress = {});

// The same, read as it is needed, where it was never painted on and its file or folder is large; else it is
// in memory. `look` as shown() has it.
std::shared_ptr<const PaintingReader> open_painted(const std::filesystem::path& path,
                                                   const AppearanceOptions& look = {},
                                                   const Progress& progress = {});
bool is_painted(const PaintingHeader& header);  // whether paint lies on it

}  // namespace tangi
