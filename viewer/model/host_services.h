// host_services.h: what the window has done for it by parts of the program that the viewer may not use; cli/
// fills it (docs/developer/architecture.md).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "paint/canvas/canvas.h"
#include "surface/maps/surface.h"
#include "surface/painting_file/painting_parts.h"
#include "viewer/model/export_format.h"
#include "viewer/model/photo_source.h"

namespace tangi {

// The painting in the window as it is now, saved or not.
struct ShownPainting {
    const Canvas& canvas;
    std::vector<PartToWrite> tools{};  // palette and brush (palette_part.h)
    // W3C Web Annotations (surface/publish/web_annotations.h).
    nlohmann::json annotations = nlohmann::json::array();
    std::filesystem::path file{};
};

// Called on threads of their own; where one is empty, the window does not offer it.
struct HostServices {
    // The photographs of a folder, to be held against the painting in `file`, whose dry layer is `dry`.
    // Throws Error, Cancelled.
    std::function<std::unique_ptr<PhotoBook>(const std::filesystem::path& folder,
                                             std::shared_ptr<const Surface> dry,
                                             const std::filesystem::path& file, const Progress& progress)>
        open_photos{};
    // Fits a painting to the photographs of a folder, or to those that a lights file lists, and writes it to
    // `out`; what is to be said about it, or nothing. Throws Error, Cancelled.
    std::function<std::string(const std::filesystem::path& photographs, const std::filesystem::path& out,
                              const Progress& progress)>
        fit{};
    // Writes it in a format of `tangipaint export --to` to `out`; what is to be said about it, or nothing.
    // Throws Error, Cancelled.
    std::function<std::string(const ShownPainting& shown, const std::string& format,
                              const std::filesystem::path& out, const Progress& progress)>
        export_canvas{};
    // The formats that export_canvas() writes, in the order of the menu.
    std::vector<ExportFormat> exports{};
    // Endings of the lights files that fit() takes, ".lp .dome".
    std::string lights_endings{};
};

}  // namespace tangi
