// exporters.cpp: the table of exporters, and what they share.
#include <algorithm>
#include <array>

#include "cli/relight/exporter.h"
#include "paint/canvas/appearance.h"
#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"

namespace tangi {

namespace {

constexpr std::array kExporters = {
    Exporter{"ora", ".ora", "OpenRaster: Krita, GIMP, MyPaint (.ora)", "OpenRaster, for Krita, GIMP, MyPaint",
             export_ora},
    Exporter{"layers", "", "Layers of paint, as maps (folder)", "maps of each layer of paint", export_layers},
    Exporter{"maps", "", "Maps of what is seen (folder, EXR)", "EXR", export_maps},
    Exporter{"web", ".html", "Web page (.html)", "a page", export_web},
    Exporter{"openlime", "", "OpenLIME's maps (folder)", "kd, ks, normals, gloss", export_openlime},
    Exporter{"ptm", ".ptm", "Polynomial texture map (.ptm)", "", export_rti},
    Exporter{"rti", ".rti", "Harmonics (.rti)", "harmonics", export_rti},
    Exporter{"snapshot", "", "", "a picture as lit", export_snapshot},
};

}  // namespace

std::span<const Exporter> exporters() { return kExporters; }

const Exporter& exporter_named(const std::string& name) {
    const auto exporter =
        std::ranges::find_if(kExporters, [&](const Exporter& known) { return known.name == name; });
    TP_REQUIRE(exporter != kExporters.end(), "an exporter is one of the table");
    return *exporter;
}

std::shared_ptr<const Surface> ExportJob::seen() const { return shown(canvas, {}, progress); }

std::shared_ptr<const Surface> ExportJob::seen_in_scale() const { return in_scale_of(canvas, seen()); }

nlohmann::json export_folder(const std::string& out, const char* contents,
                             const std::function<void(const std::filesystem::path&)>& write) {
    AtomicFolder folder(out, contents);
    told_of(folder.temporary(), out, [&] { write(folder.temporary()); });
    nlohmann::json files = nlohmann::json::array();
    for (const std::string& file : folder.commit())
        files.push_back((std::filesystem::path(out) / file).string());
    return {{"files", files}};
}

}  // namespace tangi
