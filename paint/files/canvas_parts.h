// canvas_parts.h: the paint of a canvas as parts of a painting file (canvas_file.h), wherever the file is.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "paint/canvas/canvas.h"
#include "paint/files/paint_parts.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

// `wet`, and `dried.0`, `dried.1`, …; none where there is no paint. The canvas must outlive what is written.
std::vector<PartToWrite> paint_parts_of(const Canvas& canvas);
bool is_paint_part(const std::string& name);

// The canvas of a dry surface with the paint of these parts, as read_canvas() has it; `path` is what errors
// name.
Canvas canvas_of_parts(const std::filesystem::path& path, std::shared_ptr<const Surface> dry,
                       const std::vector<PartInfo>& parts, const PartReader& read,
                       std::optional<double> mm_per_pixel = {});

}  // namespace tangi
