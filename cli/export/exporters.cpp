// exporters.cpp: the table of exporters, and what they share.
#include <algorithm>
#include <array>

#include "cli/export/exporter.h"
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/version.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace {

constexpr std::array kExporters = {
    Exporter{"ora", ".ora", "OpenRaster: Krita, GIMP, MyPaint (.ora)", "OpenRaster, for Krita, GIMP, MyPaint",
             export_ora},
    Exporter{"layers", "", "Layers of paint, as maps (folder)", "maps of each layer of paint", export_layers},
    Exporter{"maps", "", "Maps of what is seen (folder, EXR)", "EXR, TIFF or PNG", export_maps},
    Exporter{"web", ".html", "Web page (.html)", "a page", export_web},
    Exporter{"openlime", "", "OpenLIME's maps and page (folder)", "kd, ks, normals, gloss", export_openlime},
    Exporter{"ptm", ".ptm", "Polynomial texture map (.ptm)", "", export_rti},
    Exporter{"rti", ".rti", "Harmonics (.rti)", "harmonics", export_rti},
    Exporter{"relight", "", "Planes for Relight and OpenLIME (folder)", "planes of an RTI file",
             export_relight},
    Exporter{"iiif", "", "IIIF manifest and tiles (folder)", "tiles and a manifest", export_iiif},
    Exporter{"deepzoom", "", "Deep Zoom tiles (folder)", "tiles", export_deepzoom},
    Exporter{"gltf", ".glb", "glTF (.glb)", "binary", export_gltf},
    Exporter{"stl", ".stl", "Mesh to print (.stl)", "a mesh to print", export_mesh},
    Exporter{"ply", ".ply", "Mesh with colours (.ply)", "", export_mesh},
    Exporter{"obj", ".obj", "Mesh (.obj)", "", export_mesh},
    Exporter{"tiles", ".tangi", "Painting in tiles (folder .tangi)", "a folder for what no memory holds",
             export_painting_tiles},
    Exporter{"painting", ".exr", "Painting in one file (.exr)", "of a folder of tiles", export_painting},
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

std::shared_ptr<const Surface> ExportJob::seen() const { return shown(canvas(), {}, progress); }

std::shared_ptr<const Surface> ExportJob::seen_in_scale() const { return in_scale_of(canvas(), seen()); }

std::shared_ptr<const PaintingReader> ExportJob::seen_by_parts() const {
    // The window's painting is in memory, and may be another than its file.
    if (tools || is_painted(open_painting(arguments.painting)->header()))
        return reader_of(seen_in_scale(), arguments.painting);
    return open_painted(arguments.painting, {}, progress);
}

PictureNotes ExportJob::notes(const std::string& description) const {
    const std::filesystem::path file = arguments.painting;
    PictureNotes notes;
    notes.title = arguments.words.title.empty() ? file.stem().string() : arguments.words.title;
    notes.creator = arguments.creator;
    notes.credit = arguments.words.credit;
    notes.description = description;
    if (std::filesystem::exists(file)) notes.source = "sha256:" + sha256_of_painting(file);
    if (const PaintingHeader seen = seen_header(); seen.scale_known) notes.mm_per_pixel = seen.mm_per_pixel;
    return notes;
}

PaintingHeader ExportJob::seen_header() const {
    if (!tools)
        if (PaintingHeader file = open_painting(arguments.painting)->header(); !is_painted(file)) return file;
    PaintingHeader header = header_of(canvas().dry());
    header.scale_known = canvas().scale_known();
    header.mm_per_pixel = canvas().mm_per_pixel();
    return header;
}

std::string ExportJob::program() const { return program_name(); }

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
