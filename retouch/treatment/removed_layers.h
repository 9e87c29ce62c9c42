// removed_layers.h: layers that a step takes off a treatment's painting, kept so that undo brings them back.
//
// A painting file of one pixel that has each layer as a part `removed.0`, `removed.1`, …, bottom up, with the
// channels and attributes of dried parts (canvas_file.h); the first has the attribute `ingredients`. The
// painting's maps are not in it: what is kept is little more than the paint itself.
#pragma once

#include <filesystem>
#include <vector>

#include "paint/canvas/canvas.h"
#include "surface/base/progress.h"
#include "surface/file/atomic_file.h"

namespace tangi {

// The layers by name, bottom up, as they lie on the canvas. Throws Error, saying which layers there are,
// where one is not among them.
std::vector<DriedLayer> layers_named(const Canvas& canvas, const std::vector<std::string>& names);

// `layers` are of the canvas's ingredients. Throws Error naming the file where it cannot be written.
void write_removed(AtomicFile& file, const Canvas& canvas, const std::vector<DriedLayer>& layers,
                   const Progress& progress = {});

// The layers, with every paint by its number on `canvas`, to which paints are added that it lacks. They are
// not put on it. Throws Error naming the file where it is damaged or of a painting of another size.
std::vector<DriedLayer> read_removed(const std::filesystem::path& path, Canvas& canvas,
                                     const Progress& progress = {});

}  // namespace tangi
