// export_ora.cpp: the layers of a painting as OpenRaster, with its palette and brush.
#include "cli/arguments.h"
#include "cli/export/exporter.h"
#include "paint/files/canvas_file.h"
#include "paint/files/ora_file.h"
#include "paint/files/palette_part.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/overview.h"

namespace tangi {

namespace fs = std::filesystem;

nlohmann::json export_ora(const ExportJob& job) {
    const ExportArguments& a = job.arguments;
    require_ending(a.out, {".ora"}, "--to ora writes an .ora file");
    refuse_to_overwrite(a.out, {a.painting});
    AtomicFile file(a.out);
    std::vector<PartToWrite> further;
    if (fs::exists(a.painting)) further = parts_beside_paint(a.painting, job.progress);
    if (job.tools) {
        std::erase_if(further, is_overview);  // of what was saved
        further = with_tools(std::move(further), *job.tools);
    }
    write_ora(file, job.canvas(), job.progress, further);
    return {{"files", {a.out}}};
}

}  // namespace tangi
