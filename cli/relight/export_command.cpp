// export_command.cpp: tangipaint export PAINTING.exr --to FORMAT --out PATH
#include <array>
#include <filesystem>
#include <set>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/relight/export_layers.h"
#include "cli/relight/export_painting.h"
#include "fit/exchange/export_maps.h"
#include "fit/exchange/ptm_rti_file.h"
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "paint/files/ora_file.h"
#include "paint/files/palette_part.h"
#include "surface/base/error.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/overview.h"
#include "surface/render/relight.h"
#include "surface/render/viewing_exposure.h"
#include "viewer/web/web_page.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct ExportArguments {
    std::string painting, out, to, photos, lights;
    int terms = 9, directions = 80;
    bool lrgb = false;
    std::string light = "-0.5,0.5,0.7";
    WebWords words;
    WebOptions web;
    std::function<std::vector<std::string>()> typed;  // flags of the command
};

RtiBasis basis_of(const ExportArguments& a) {
    if (a.to == "ptm") return RtiBasis::ptm;
    for (const RtiBasis basis : {RtiBasis::hsh4, RtiBasis::hsh9, RtiBasis::hsh16})
        if (terms_of(basis) == a.terms) return basis;
    throw UsageError(fmt::format("--terms {}: .rti files have 4, 9 or 16 terms", a.terms));
}

nlohmann::json export_rti(const ExportArguments& a, const Surface& surface, const Progress& progress) {
    const RtiBasis basis = basis_of(a);
    if (lower_extension(a.out) != "." + a.to) fail("--out {}: --to {} writes a .{} file", a.out, a.to, a.to);
    std::vector<fs::path> inputs = {a.painting};
    std::optional<Stack> stack;
    if (!a.photos.empty()) {
        StackOptions options;
        if (!a.lights.empty()) options.lights_file = a.lights;
        stack = open_stack(a.photos, options);
        for (const StackPhoto& photo : stack->photos) inputs.push_back(photo.path);
        if (stack->is_raw) fail("{}: camera raw cannot be exported; leave out --photos", a.photos);
        // As the fit registered them; those that it did not see have no part.
        std::erase_if(stack->photos, [&](StackPhoto& photo) {
            const Photography::Photo* known = find_photo(surface.photography, photo.light);
            if (known) photo.homography = known->homography;
            return !known || !known->fitted;
        });
    }
    refuse_to_overwrite(a.out, inputs);
    AtomicFile file(a.out);
    const bool linear = surface.photography.transfer.kind == Transfer::Kind::linear;
    const RtiImage image = stack ? fit_rti(*stack, basis, a.lrgb, progress, linear)
                                 : rti_of(surface, basis, a.lrgb, {Transfer::Kind::srgb},
                                          {.directions = a.directions}, progress);
    write_rti_file(file, image, progress);
    return {{"files", {a.out}},
            {"basis", name_of(basis)},
            {"lrgb", a.lrgb},
            {"from", stack ? "photographs" : "painting"},
            {"encoding", stack && !linear ? "as stored" : "srgb"},
            {"lights", stack ? static_cast<int>(stack->photos.size()) : a.directions}};
}

// A folder that appears as a whole: what `write` writes to the folder that it is given.
nlohmann::json export_folder(const ExportArguments& a, const char* contents,
                             const std::function<void(const fs::path&)>& write) {
    AtomicFolder folder(a.out, contents);
    told_of(folder.temporary(), a.out, [&] { write(folder.temporary()); });
    nlohmann::json files = nlohmann::json::array();
    for (const std::string& file : folder.commit()) files.push_back((fs::path(a.out) / file).string());
    return {{"files", files}};
}

// A folder with the dry surface's maps, each layer of paint, and the maps of it all.
nlohmann::json export_layers(const ExportArguments& a, const Canvas& canvas, const Progress& progress) {
    return export_folder(a, "layers.json", [&](const fs::path& folder) {
        write_maps(folder / "dry", *in_scale_of(canvas, canvas.dry_shared()), progress);
        write_layers(folder, canvas, progress);
        write_maps(folder / "painted", *in_scale_of(canvas, shown(canvas, {}, progress)), progress);
    });
}

std::vector<std::string> lost_to_openlime(const std::string& painting, const Surface& surface) {
    std::vector<std::string> lost;
    if (!surface.lobe_axes.empty())
        lost.push_back(fmt::format(
            "{}: its gloss is anisotropic in one direction in places (brushed metal, a weave), which "
            "OpenLIME's maps cannot hold: they are written as round ones of the same mean "
            "roughness; --to maps keeps them",
            painting));
    if (surface.reflectance_model.second_lobe_weight > 0)
        lost.push_back(fmt::format(
            "{}: a part of its gloss, {:.2g}, is a second lobe of twice the roughness, which OpenLIME's maps "
            "cannot hold: highlights are shown narrower than they are; --to maps keeps it",
            painting, surface.reflectance_model.second_lobe_weight));
    if (surface.reflectance_model.diffuse_roughness > 0)
        lost.push_back(fmt::format(
            "{}: its matt paint reflects as rough surfaces do (diffuse roughness {:.2g}), which OpenLIME's "
            "maps cannot hold: slopes are shown after Lambert's law; --to maps keeps it",
            painting, surface.reflectance_model.diffuse_roughness));
    return lost;
}

nlohmann::json export_maps(const ExportArguments& a, const Surface& surface, const Progress& progress) {
    if (a.to == "openlime") {
        nlohmann::json result = export_folder(
            a, "brdf.json", [&](const fs::path& folder) { write_openlime(folder, surface, progress); });
        if (const auto lost = lost_to_openlime(a.painting, surface); !lost.empty())
            result["warnings"] = told(lost);
        return result;
    }
    return export_folder(a, "maps.json",
                         [&](const fs::path& folder) { write_maps(folder, surface, progress); });
}

// `tools`: instead of those in the file, with the canvas, on which more has been painted since.
nlohmann::json export_ora(const ExportArguments& a, const Canvas& canvas,
                          const std::vector<PartToWrite>* tools, const Progress& progress) {
    if (lower_extension(a.out) != ".ora") fail("--out {}: --to ora writes an .ora file", a.out);
    refuse_to_overwrite(a.out, {a.painting});
    AtomicFile file(a.out);
    std::vector<PartToWrite> further;
    if (fs::exists(a.painting)) further = parts_beside_paint(a.painting, progress);
    if (tools) {
        std::erase_if(further, is_overview);  // of what was saved
        further = with_tools(std::move(further), *tools);
    }
    write_ora(file, canvas, progress, further);
    return {{"files", {a.out}}};
}

nlohmann::json export_web(const ExportArguments& a, const Surface& surface, const Progress& progress) {
    const fs::path page =
        lower_extension(a.out) == ".html" ? fs::path(a.out) : fs::path(a.out) / "index.html";
    if (page != fs::path(a.out) && fs::exists(a.out) && !fs::is_directory(a.out))
        fail("--out {}: is a file; give a folder, or a page of one file, .html", a.out);
    refuse_to_overwrite(page, {a.painting});
    WebWords words = a.words;
    if (words.title.empty()) words.title = fs::path(a.painting).stem().string();
    const WebReport report = write_web_page(a.out, surface, words, a.web, progress);
    nlohmann::json files = nlohmann::json::array();
    for (const fs::path& path : report.files) files.push_back(path.string());
    return {{"files", files},
            {"levels", report.levels},
            {"tiles", report.tiles},
            {"bytes", report.bytes},
            {"first_picture_bytes", report.first_bytes}};
}

// As under one light, with shadows: for people, so sRGB, as bright as the photographs were. `relight` has
// more lights.
nlohmann::json export_snapshot(const ExportArguments& a, const Surface& surface, const Progress& progress) {
    require_picture_format(a.out);
    refuse_to_overwrite(a.out, {a.painting});
    const Vec3 direction = parse_direction_in_front(a.light, "--light");
    Image<Rgb> picture =
        relight(surface, std::array{distant_light(direction)}, {.cast_shadows = true}, progress);
    const bool any_unit = lower_extension(a.out) == ".exr";  // only files of floats hold any
    const double white = surface.photography.white_level;
    for (Rgb& pixel : picture.pixels())
        pixel *= static_cast<float>(any_unit ? white : viewing_exposure(white));
    write_picture(a.out, picture,
                  lower_extension(a.out) == ".exr" ? Transfer{} : Transfer{Transfer::Kind::srgb});
    return {{"files", {a.out}}};
}

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

nlohmann::json export_canvas(const ExportArguments& a, const Canvas& canvas,
                             const std::vector<PartToWrite>* tools, const Progress& progress) {
    return a.to == "ora" ? export_ora(a, canvas, tools, progress) : export_layers(a, canvas, progress);
}

// What is written of a painting as it looks, and for maps also in millimetres where a scale was given.
std::shared_ptr<const Surface> seen(const ExportArguments& a, const Canvas& canvas,
                                    const Progress& progress) {
    const bool maps = a.to == "maps" || a.to == "openlime";
    return maps ? in_scale_of(canvas, shown(canvas, {}, progress)) : shown(canvas, {}, progress);
}

nlohmann::json export_surface(const ExportArguments& a, const Surface& surface, const Progress& progress) {
    if (a.to == "ptm" || a.to == "rti") return export_rti(a, surface, progress);
    if (a.to == "web") return export_web(a, surface, progress);
    if (a.to == "snapshot") return export_snapshot(a, surface, progress);
    return export_maps(a, surface, progress);
}

bool is_of_layers(const ExportArguments& a) { return a.to == "ora" || a.to == "layers"; }

nlohmann::json run_export(const ExportArguments& a) {
    const Progress progress = console_progress();
    refuse_useless(a);
    if (is_of_layers(a)) return export_canvas(a, read_canvas(a.painting, progress), nullptr, progress);
    return export_surface(a, *seen(a, read_canvas(a.painting, progress), progress), progress);
}

}  // namespace

nlohmann::json export_canvas(const Canvas& canvas, const std::vector<PartToWrite>& tools,
                             const fs::path& painting, const std::string& format, const fs::path& out,
                             const Progress& progress) {
    ExportArguments a;
    a.painting = painting.string();
    a.to = format;
    a.out = out.string();
    if (is_of_layers(a)) return export_canvas(a, canvas, &tools, progress);
    return export_surface(a, *seen(a, canvas, progress), progress);
}

Command export_command() {
    return {"export", "write a painting for others: a web page, RTI viewers, OpenLIME, OpenRaster, maps",
            [](Flags& flags) {
                auto a = std::make_shared<ExportArguments>();
                flags.option("PAINTING", a->painting, "painting file (.exr)").required();
                flags
                    .option(
                        "--to", a->to,
                        "web (a page), ptm, rti (harmonics), maps (EXR), openlime (kd, ks, normals, gloss), "
                        "layers (maps of each layer of paint), ora (OpenRaster, for Krita, GIMP, MyPaint), "
                        "snapshot (a picture as lit)")
                    .required()
                    .check(one_of({"web", "ptm", "rti", "maps", "openlime", "layers", "ora", "snapshot"}));
                flags
                    .option("--out", a->out,
                            "file to write (.ptm, .rti, .ora; .html for a page of one file; a picture for a "
                            "snapshot), or folder for maps or a page")
                    .required();
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
