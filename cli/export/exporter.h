// exporter.h: the table of what `tangipaint export` writes for others: the command, its help and the window's
// menu are made of it.
//
// A further exporter is a source with its function, declared here, and one row in exporters.cpp
// (docs/developer/how-to.md).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "paint/canvas/canvas.h"
#include "surface/base/progress.h"
#include "surface/image_file/picture_notes.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_reader.h"
#include "surface/publish/mesh.h"
#include "viewer/web/web_page.h"

namespace tangi {

struct ExportArguments {
    std::string painting, out, to, photos, lights;
    int terms = 9, directions = 80;
    bool lrgb = false;
    std::string light = "-0.5,0.5,0.7", creator, url, annotations, maps_format = "exr";
    std::vector<std::string> states, origins;  // of a web page
    bool relief = false, paint_layers = false;
    MeshOptions mesh;
    WebWords words;
    WebOptions web;
    std::function<std::vector<std::string>()> typed;  // flags of the command
};

// What is to be written, and how that was asked for.
struct ExportJob {
    const ExportArguments& arguments;
    std::function<const Canvas&()> canvas;  // with its layers; read from the file when it is asked for
    const std::vector<PartToWrite>* tools;  // palette and brush of now; null: those in the painting's file
    const Progress& progress;
    // Those that go along (surface/publish/web_annotations.h). Throws Error naming the file.
    std::function<nlohmann::json()> annotations;

    std::shared_ptr<const Surface> seen() const;           // the painting as it looks
    std::shared_ptr<const Surface> seen_in_scale() const;  // and in millimetres, where a scale was given
    // The same by rectangles: one that was never painted on, and is large, is never in memory as a whole.
    std::shared_ptr<const PaintingReader> seen_by_parts() const;
    // What its pictures say of themselves: title, creator, credit, scale, and the hash of the painting's
    // file.
    PictureNotes notes(const std::string& description) const;
    PaintingHeader seen_header() const;  // with the scale that it was painted on with
    std::string program() const;         // "tangipaint 0.2.0"
};

struct Exporter {
    const char* name;       // as --to has it; no two rows share one
    const char* extension;  // of its file, with the point; empty: a folder, or a file of several kinds
    const char* in_menu;    // what the window calls it; empty: the window has another way to it
    const char* in_help;    // what it is, in a few words; may be empty
    // The result of the command, with "files". Throws Error, UsageError, Cancelled.
    nlohmann::json (*write)(const ExportJob& job);
};

// The table, in the order of the menu.
std::span<const Exporter> exporters();

const Exporter& exporter_named(const std::string& name);  // one of the table's

// Each in a source of its own.
nlohmann::json export_ora(const ExportJob& job);
nlohmann::json export_layers(const ExportJob& job);
nlohmann::json export_maps(const ExportJob& job);
nlohmann::json export_openlime(const ExportJob& job);
nlohmann::json export_web(const ExportJob& job);
nlohmann::json export_rti(const ExportJob& job);  // .ptm, too
nlohmann::json export_snapshot(const ExportJob& job);
nlohmann::json export_iiif(const ExportJob& job);
nlohmann::json export_deepzoom(const ExportJob& job);
nlohmann::json export_mesh(const ExportJob& job);  // .stl, .ply, .obj
nlohmann::json export_gltf(const ExportJob& job);
nlohmann::json export_relight(const ExportJob& job);
nlohmann::json export_painting(const ExportJob& job);
nlohmann::json export_painting_tiles(const ExportJob& job);

// For these: a folder that appears as a whole, of what `write` writes to the folder that it is given.
// `contents` is the file in it that lists the others (surface/file/atomic_folder.h).
nlohmann::json export_folder(const std::string& out, const char* contents,
                             const std::function<void(const std::filesystem::path&)>& write);

}  // namespace tangi
