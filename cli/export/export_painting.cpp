// export_painting.cpp: a painting as a folder of tiles, and as one file.
#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/export/exporter.h"
#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

void require_name(const ExportArguments& a, const char* extension) {
    require_ending(a.out, {extension}, fmt::format("--to {} writes a {}", a.to, extension));
    refuse_to_overwrite(a.out, {a.painting});
}

// Calls `write` with the painting as it is now: the window's is written to a file first, which is gone then.
template <class Write>
void with_painting(const ExportJob& job, const Write& write) {
    const ExportArguments& a = job.arguments;
    if (!job.tools) return write(*open_painting(a.painting));
    fs::path beside = a.out;
    beside += ".now.exr";  // a name that no output has
    const AtomicFile file(beside);
    std::vector<PartToWrite> further;
    if (fs::exists(a.painting)) further = parts_beside_paint(a.painting, job.progress);
    fill_canvas(file, job.canvas(), job.progress, with_tools(std::move(further), *job.tools));
    write(*open_painting(file.temporary()));
}

}  // namespace

nlohmann::json export_painting_tiles(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    require_name(a, ".tangi");
    with_painting(job, [&](const PaintingReader& painting) { write_tiles(painting, a.out, job.progress); });
    const auto written = open_painting(a.out);
    nlohmann::json files = nlohmann::json::array();
    for (const auto& entry : fs::recursive_directory_iterator(a.out))
        if (entry.is_regular_file()) files.push_back(entry.path().string());
    return {{"files", files}, {"levels", written->levels()}, {"tiles", files.size() - 1}};
}

nlohmann::json export_painting(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    require_name(a, ".exr");
    with_painting(job, [&](const PaintingReader& painting) { write_file(painting, a.out, job.progress); });
    return {{"files", {a.out}}};
}

}  // namespace tangi
