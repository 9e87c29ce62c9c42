// export_command.cpp: tangipaint export PAINTING.exr --to FORMAT --out PATH
#include <optional>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/export/export_painting.h"
#include "cli/export/exporter.h"
#include "paint/files/canvas_file.h"
#include "surface/image_file/image_io.h"
#include "surface/publish/web_annotations.h"

namespace tangi {

namespace {

// Flags that this format has no use for.
void refuse_useless(const ExportArguments& a) {
    const auto refuse = [&](bool useless, std::initializer_list<std::string_view> flags, const char* reason) {
        if (useless) refuse_typed(a.typed(), flags, fmt::format("{}; --to {} is none", reason, a.to));
    };
    const bool ptm = a.to == "ptm", rti = a.to == "rti";
    const bool relight = a.to == "relight", iiif = a.to == "iiif", snapshot = a.to == "snapshot";
    const bool mesh = a.to == "stl" || a.to == "ply" || a.to == "obj", gltf = a.to == "gltf";
    refuse(!ptm && !rti && !relight, {"--photos", "--lights", "--directions"},
           "is of RTI files: ptm, rti, relight");
    refuse(!rti && !relight, {"--terms"}, "is of rti files and of relight");
    refuse(!snapshot && !iiif && a.to != "deepzoom", {"--light"}, "is of pictures: snapshot, iiif, deepzoom");
    refuse(!iiif, {"--url"}, "is of iiif");
    refuse(!iiif && a.to != "web" && a.to != "openlime", {"--annotations"}, "is of web, iiif and openlime");
    refuse(a.to != "maps", {"--maps-format"}, "is of maps");
    refuse(!gltf, {"--relief"}, "is of gltf");
    refuse(!mesh, {"--base-mm"}, "is of meshes to print: stl, ply, obj");
    refuse(!mesh && !(gltf && a.relief), {"--triangles"}, "is of meshes: stl, ply, obj, and gltf --relief");
    refuse(!snapshot && !iiif && a.to != "maps" && a.to != "web", {"--title", "--credit", "--creator"},
           "is of web, iiif, maps and snapshots");
    refuse(!ptm, {"--lrgb"}, "is a way to write ptm files");
    refuse(a.to != "web",
           {"--shadow-side", "--light-azimuth-deg", "--light-elevation-deg", "--largest-page-mb",
            "--lossy-psnr-db", "--state", "--layers", "--embed-origin"},
           "is of a web page");
    if (a.photos.empty())
        refuse_typed(a.typed(), {"--lights"}, "is of photographs: give their folder with --photos");
    else
        refuse_typed(a.typed(), {"--directions"},
                     "is of a painting that is relit, and with --photos the photographs are fitted");
    if (lower_extension(a.out) != ".html")
        refuse_typed(a.typed(), {"--largest-page-mb"}, "is of a page of one file: --out PAGE.html");
}

nlohmann::json run_export(const ExportArguments& a) {
    const Progress progress = console_progress();
    refuse_useless(a);
    std::optional<Canvas> canvas;
    const auto read = [&]() -> const Canvas& {
        if (!canvas) canvas.emplace(read_canvas(a.painting, progress));
        return *canvas;
    };
    const auto annotations = [&] {
        return read_annotations(a.annotations, "--annotations " + a.annotations);
    };
    return exporter_named(a.to).write({a, read, nullptr, progress, annotations});
}

std::vector<std::string> names_of_exporters() {
    std::vector<std::string> names;
    for (const Exporter& exporter : exporters()) names.emplace_back(exporter.name);
    return names;
}

std::string help_of_out() {
    std::string extensions;
    for (const Exporter& exporter : exporters())
        if (*exporter.extension) extensions += fmt::format("{}, ", exporter.extension);
    return fmt::format(
        "file to write ({}a picture for a snapshot), or folder for maps or a page of several files",
        extensions);
}

// "ora (OpenRaster, for Krita), ptm, …"
std::string help_of_exporters() {
    std::string help;
    for (const Exporter& exporter : exporters()) {
        help += fmt::format("{}{}", help.empty() ? "" : ", ", exporter.name);
        if (*exporter.in_help) help += fmt::format(" ({})", exporter.in_help);
    }
    return help;
}

}  // namespace

nlohmann::json export_canvas(const ShownPainting& shown, const std::string& format,
                             const std::filesystem::path& out, const Progress& progress) {
    ExportArguments a;
    a.painting = shown.file.string();
    a.to = format;
    a.out = out.string();
    const auto canvas = [&]() -> const Canvas& { return shown.canvas; };
    const auto annotations = [&] { return shown.annotations; };
    return exporter_named(format).write({a, canvas, &shown.tools, progress, annotations});
}

std::vector<ExportFormat> exports_of_window() {
    std::vector<ExportFormat> formats;
    for (const Exporter& exporter : exporters())
        if (*exporter.in_menu) formats.push_back({exporter.in_menu, exporter.name, exporter.extension});
    return formats;
}

Command export_command() {
    return {
        "export", "write a painting for others: a web page, RTI viewers, OpenLIME, OpenRaster, maps",
        [](Flags& flags) {
            auto a = std::make_shared<ExportArguments>();
            flags.option("PAINTING", a->painting, "painting (.exr, or .tangi, a folder)").required();
            flags.option("--to", a->to, help_of_exporters()).required().check(one_of(names_of_exporters()));
            flags.option("--out", a->out, help_of_out()).required();
            flags.option("--photos", a->photos,
                         "ptm, rti, relight: fit the photographs in this folder instead of the painting "
                         "relit; linear ones "
                         "are encoded as sRGB, as viewers show values as they are");
            flags.option("--lights", a->lights, "lights file of these photographs");
            flags.option("--light", a->light, "snapshot, iiif, deepzoom: direction to the light, X,Y,Z")
                .show_default();
            flags
                .option("--terms", a->terms,
                        "rti, relight: harmonics, 4, 9 or 16; relight: a polynomial where not given")
                .show_default();
            flags.flag("--lrgb", a->lrgb,
                       "ptm: one colour a pixel and the brightness by light, in half the size");
            flags.option("--directions", a->directions, "ptm, rti: lights to relight the painting from")
                .check(within(20, 1000))
                .show_default();
            flags.option("--title", a->words.title,
                         "web, iiif, maps, snapshot: the painting's name; that of its file where not given");
            flags.option("--credit", a->words.credit,
                         "web, iiif, maps, snapshot: year, owner, licence, in a line");
            flags.option("--creator", a->creator, "web, iiif, maps, snapshot: the artist");
            flags.option("--url", a->url, "iiif: the address at which the folder will be published");
            flags.option("--annotations", a->annotations,
                         "web, iiif, openlime: W3C Web Annotations to go along (.json)");
            flags
                .option("--state", a->states,
                        "web: an earlier state to compare with, NAME=PAINTING.exr, of the same pixels (fit "
                        "--align-to); "
                        "may be given several times, in their order in time")
                .one_value();
            flags.flag("--layers", a->paint_layers,
                       "web: the layers of paint as states: without paint, and with each");
            flags
                .option("--embed-origin", a->origins,
                        "web: a site whose pages may ask and tell this one by messages, "
                        "https://museum.example; * for all")
                .one_value();
            flags
                .option("--maps-format", a->maps_format,
                        "maps: exr, in their units; tif or png, 16 bits, with the scale in maps.json")
                .check(one_of({"exr", "tif", "png"}))
                .show_default();
            flags.flag("--relief", a->relief, "gltf: a mesh of the relief, not a plane with a normal map");
            flags.fields(a->mesh);
            flags.fields(a->web);
            a->typed = flags.typed();
            return [a] { return run_export(*a); };
        }};
}

}  // namespace tangi
