// export_command.cpp: tangipaint export PAINTING.exr --to FORMAT --out PATH
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/relight/export_painting.h"
#include "cli/relight/exporter.h"
#include "paint/files/canvas_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace {

// Flags that this format has no use for.
void refuse_useless(const ExportArguments& a) {
    const auto refuse = [&](bool useless, std::initializer_list<std::string_view> flags, const char* reason) {
        if (useless) refuse_typed(a.typed(), flags, fmt::format("{}; --to {} is none", reason, a.to));
    };
    const bool ptm = a.to == "ptm", rti = a.to == "rti";
    refuse(!ptm && !rti, {"--photos", "--lights", "--directions"}, "is of the RTI files ptm and rti");
    refuse(!rti, {"--terms"}, "is of an rti file");
    refuse(a.to != "snapshot", {"--light"}, "is of a snapshot");
    refuse(!ptm, {"--lrgb"}, "is a way to write ptm files");
    refuse(a.to != "web",
           {"--title", "--credit", "--shadow-side", "--light-azimuth-deg", "--light-elevation-deg",
            "--largest-page-mb"},
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
    const Canvas canvas = read_canvas(a.painting, progress);
    return exporter_named(a.to).write({a, canvas, nullptr, progress});
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

nlohmann::json export_canvas(const Canvas& canvas, const std::vector<PartToWrite>& tools,
                             const std::filesystem::path& painting, const std::string& format,
                             const std::filesystem::path& out, const Progress& progress) {
    ExportArguments a;
    a.painting = painting.string();
    a.to = format;
    a.out = out.string();
    return exporter_named(format).write({a, canvas, &tools, progress});
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
            flags.option("PAINTING", a->painting, "painting file (.exr)").required();
            flags.option("--to", a->to, help_of_exporters()).required().check(one_of(names_of_exporters()));
            flags.option("--out", a->out, help_of_out()).required();
            flags.option(
                "--photos", a->photos,
                "ptm, rti: fit the photographs in this folder instead of the painting relit; linear ones "
                "are encoded as sRGB, as viewers show values as they are");
            flags.option("--lights", a->lights, "lights file of these photographs");
            flags.option("--light", a->light, "snapshot: direction to its light, X,Y,Z").show_default();
            flags.option("--terms", a->terms, "rti: harmonics, 4, 9 or 16").show_default();
            flags.flag("--lrgb", a->lrgb,
                       "ptm: one colour a pixel and the brightness by light, in half the size");
            flags.option("--directions", a->directions, "ptm, rti: lights to relight the painting from")
                .check(within(20, 1000))
                .show_default();
            flags.option("--title", a->words.title,
                         "web: the painting's name; that of its file where not given");
            flags.option("--credit", a->words.credit,
                         "web: artist, year, owner, licence: a line below the name");
            flags.fields(a->web);
            a->typed = flags.typed();
            return [a] { return run_export(*a); };
        }};
}

}  // namespace tangi
