// import_command.cpp: tangipaint import [FOLDER] --out PAINTING.exr
#include <array>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/relight/import_rti.h"
#include "fit/exchange/import_maps.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/provenance/provenance.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct ImportArguments {
    std::string folder, out, diffuse, specular, normals, gloss, roughness, height, lobe, roughness_v, tangent,
        confidence;
    ImportOptions options;
    std::function<std::vector<std::string>()> typed;  // flags of the command
};

// Flags that say how a map is to be read which is not there, or is not read that way.
void refuse_useless(const ImportArguments& a, const MapFiles& files) {
    const auto refuse = [&](bool useless, std::initializer_list<std::string_view> flags, const char* reason) {
        if (useless) refuse_typed(a.typed(), flags, reason);
    };
    if (!(least_alpha(a.options) < greatest_alpha(a.options)))
        throw UsageError(fmt::format("--alpha-min {}: is not less than --alpha-max {}",
                                     least_alpha(a.options), greatest_alpha(a.options)));
    refuse(files.gloss && files.roughness, {"--gloss"},
           "says what --roughness says too; leave out one of them");
    refuse(!files.gloss || files.roughness, {"--alpha-min", "--alpha-max"},
           "is of a gloss map, and none is used");
    refuse(!files.normals, {"--normals-y-down"}, "is of a normal map, and there is none");
    refuse(!files.diffuse, {"--diffuse-srgb"}, "is of a diffuse map, and there is none");
    refuse(!files.height || lower_extension(*files.height) == ".exr", {"--height-range-mm"},
           "is of a height map of whole numbers, and there is none; an EXR file is in mm");
}

// A kind of map: its name, what was typed for it, and its file.
struct GivenMap {
    const char* name;
    const std::string& typed;
    std::optional<fs::path>& file;
};

std::array<GivenMap, 10> given_maps(const ImportArguments& a, MapFiles& files) {
    return {{{"diffuse", a.diffuse, files.diffuse},
             {"specular", a.specular, files.specular},
             {"normals", a.normals, files.normals},
             {"gloss", a.gloss, files.gloss},
             {"roughness", a.roughness, files.roughness},
             {"height", a.height, files.height},
             {"lobe", a.lobe, files.lobe},
             {"roughness_v", a.roughness_v, files.across},
             {"tangent", a.tangent, files.tangent},
             {"confidence", a.confidence, files.confidence}}};
}

// A map that is named comes before those that are found.
MapFiles map_files(const ImportArguments& a) {
    MapFiles files;
    for (const GivenMap& map : given_maps(a, files))
        if (!map.typed.empty()) map.file = map.typed;
    if (!a.folder.empty()) files = find_maps(a.folder, files);
    if (!a.gloss.empty() && a.roughness.empty()) files.roughness.reset();
    return files;
}

// Each map's file by its name, which is there, is a map, and is not what is written.
nlohmann::json checked_maps(const ImportArguments& a, MapFiles& files) {
    nlohmann::json maps = nlohmann::json::object();
    for (const auto& [name, typed, file] : given_maps(a, files)) {
        if (!file) continue;
        if (!fs::is_regular_file(*file)) fail("{}: no such file", file->string());
        if (lower_extension(*file) == ".exr" && is_painting(*file))
            fail("{}: is a painting, not a map; its maps are written by: export {} --to maps", file->string(),
                 file->string());
        refuse_to_overwrite(a.out, {*file});
        maps[name] = file->string();
    }
    return maps;
}

nlohmann::json result_of(const Surface& surface, const ImportReport& report) {
    nlohmann::json poor = nlohmann::json::array();
    if (!report.height.converged)
        poor.push_back("the height did not converge; its low frequencies are doubtful");
    return {{"width", surface.width()},
            {"height", surface.height()},
            {"pixels",
             {{"all", report.pixels}, {"measured", report.measured}, {"facing_away", report.facing_away}}},
            {"mm_per_pixel", surface.mm_per_pixel},
            {"scale_known", surface.scale_known},
            {"second_lobe_weight", surface.reflectance_model.second_lobe_weight},
            {"diffuse_roughness", surface.reflectance_model.diffuse_roughness},
            {"median_tilt_deg", report.median_tilt_deg},
            {"support_tilt_deg", report.support_tilt_deg},
            {"height_solver",
             {{"cycles", report.height.cycles},
              {"residual", report.height.residual},
              {"converged", report.height.converged}}},
            {"dry_hash", hash_of(surface)},
            {"warnings", told(report.warnings)},
            {"poor", poor}};
}

nlohmann::json run_import(const ImportArguments& a) {
    const Progress progress = console_progress();
    require_ending(a.out, {".exr"}, "a painting is an .exr file");
    if (is_rti(a.folder)) {
        const std::vector<std::string> typed = a.typed();
        for (const std::string& flag : typed)
            if (flag.starts_with("--") && flag != "--out" && flag != "--mm-per-pixel")
                refuse_typed(typed, {flag}, "is of maps, and an RTI file is read");
        return import_rti(a.folder, a.out, a.options.mm_per_pixel, progress);
    }
    MapFiles files = map_files(a);
    const nlohmann::json maps = checked_maps(a, files);
    refuse_useless(a, files);
    const ImportOptions wanted = a.folder.empty() ? a.options : as_described(a.folder, a.options);
    AtomicFile out(a.out);
    ImportReport report;
    Surface surface = import_maps(files, wanted, report, progress);
    nlohmann::json options = to_json(wanted);
    std::vector<fs::path> inputs;
    for (const auto& [name, typed, file] : given_maps(a, files)) {
        if (!file) continue;
        inputs.push_back(*file);
        options["maps"][name] = file->filename().string();
    }
    surface.provenance = json_line(provenance_of("import", options, records_of(inputs)));
    write_painting(out, surface, progress);
    nlohmann::json result = result_of(surface, report);
    result["painting"] = a.out, result["maps"] = maps;
    return result;
}

}  // namespace

Command import_command() {
    return {
        "import",
        "make a painting of published maps (Ward maps, or albedo, normals and height) or of an RTI file",
        [](Flags& flags) {
            auto a = std::make_shared<ImportArguments>();
            flags.option(
                "MAPS", a->folder,
                "folder whose maps are found by name: kd or albedo, ks, normals, gloss, roughness, height, "
                "lobe, roughness_v, tangent, confidence; maps.json of export --to maps says scale, second "
                "lobe and "
                "diffuse roughness, brdf.json of export --to openlime scale, encoding and limits of alpha; "
                "or an "
                "RTI file (.ptm, .rti), or a folder of Relight (info.json)");
            flags.option("--out", a->out, "painting file to write (.exr)").required();
            flags.option("--diffuse", a->diffuse, "diffuse map (kd, albedo)");
            flags.option("--specular", a->specular, "specular map (ks)");
            flags.option("--normals", a->normals, "normal map, n = 2 c - 1; EXR: n");
            flags.option("--gloss", a->gloss, "gloss map (see --alpha-min, --alpha-max)");
            flags.option("--roughness", a->roughness, "roughness map, Ward's alpha");
            flags.option("--height", a->height,
                         "height map; integrated from the normals where there is none");
            flags.option("--lobe", a->lobe,
                         "colours of lobes, that specular is multiplied by; white without");
            flags.option("--roughness-v", a->roughness_v,
                         "of anisotropic lobes (brushed metal), with --tangent: alpha across the "
                         "tangent; along it, it is roughness^2 over this");
            flags.option(
                "--tangent", a->tangent,
                "direction of the tangent, from x towards y, in radians (EXR): where lobes are wide");
            flags.option("--confidence", a->confidence, "0 where nothing was measured, up to 1; 1 without");
            flags.fields(a->options);
            a->typed = flags.typed();
            return [a] { return run_import(*a); };
        }};
}

}  // namespace tangi
