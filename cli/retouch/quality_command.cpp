// quality_command.cpp: tangipaint quality PAINTING.exr --mask MASK.png --out DIR, or --treatment DIR:
// retouches against what is beside them.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch/retouch_arguments.h"
#include "cli/retouch/treatment_arguments.h"
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "retouch/inpaint/quality.h"
#include "retouch/treatment/treatment_area.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"
#include "surface/render/relight.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kRaking_deg = 15;
constexpr std::array<std::pair<const char*, double>, 4> kRaking = {
    {{"right", 0}, {"top", 90}, {"left", 180}, {"bottom", 270}}};

struct QualityArguments {
    std::string painting, damaged, out, treatment, illuminants = "D65,A,F11";
    AreaArguments area;
    AuthorArguments author;
    std::optional<double> mm_per_pixel;
    QualityOptions options;
};

nlohmann::json as_json(const Step& step) { return {{"mean", step.mean}, {"rms", step.rms}}; }

nlohmann::json as_json(const RetouchQuality& q) {
    nlohmann::json json = {{"box_px", {q.box.x0, q.box.y0, q.box.x1, q.box.y1}},
                           {"area_mm2", q.area_mm2},
                           {"delta_e_2000", by_each_light(q.delta_e)},
                           {"border_delta_e_2000", by_each_light(q.border_delta_e)},
                           {"height_step_mm", as_json(q.height_mm)},
                           {"gloss_step", q.gloss_step},
                           {"specular_step", as_json(q.specular)},
                           {"roughness_step", as_json(q.roughness)}};
    if (q.undamaged.empty()) return json;
    json["undamaged"] = as_json(mean_of(q.undamaged));
    json["undamaged"]["places"] = q.undamaged.size();
    return json;
}

std::string raking_picture(const char* name) { return fmt::format("raking_{}.png", name); }

// What light from the sides shows: steps, and gloss that differs. The canvas is given up: pictures need its
// room.
void write_raking(Canvas&& given_up, const fs::path& folder, const Progress& progress) {
    const Surface seen = [&] {
        const Canvas canvas = std::move(given_up);
        return appearance(canvas, {}, progress);
    }();
    for (const auto& [name, azimuth_deg] : kRaking) {
        const double a = azimuth_deg * M_PI / 180, e = kRaking_deg * M_PI / 180;
        Light light =
            distant_light({static_cast<float>(std::cos(a) * std::cos(e)),
                           static_cast<float>(std::sin(a) * std::cos(e)), static_cast<float>(std::sin(e))});
        light.gain = Rgb(static_cast<float>(1 / std::sin(e)));  // a flat matt white is 1
        RelightOptions options;
        options.cast_shadows = true;
        write_picture(folder / raking_picture(name), relight(seen, std::span(&light, 1), options, progress),
                      Transfer{Transfer::Kind::srgb}, {.bits = 8});
    }
}

// Maps, which `report` loses, and raking light.
void write_pictures(const fs::path& folder, QualityReport& report, Canvas&& canvas,
                    const Progress& progress) {
    write_map(folder / "delta_e_2000.exr", report.delta_e);
    write_map(folder / "height_mm.exr", report.height_mm);
    write_map(folder / "gloss.exr", report.gloss);
    // Black is 0, white CIEDE2000 10.
    for (float& v : report.delta_e.pixels()) v = std::min(v / 10, 1.0f);
    write_map(folder / "delta_e_2000.png", report.delta_e, {.bits = 8});
    report.delta_e = report.height_mm =
        report.gloss = {};  // as large as the painting: raking light needs the room
    write_raking(std::move(canvas), folder, progress);
}

// Where the retouches of a treatment belong: those that are still there, as the log has them.
Mask retouched(const Treatment& treatment) {
    Mask all(treatment.width(), treatment.height());
    const std::vector<std::string> names = treatment.mask_names();
    for (const TreatmentLayer& layer : treatment.layers())
        if (layer.role == LayerRole::retouch &&
            std::find(names.begin(), names.end(), layer.name) != names.end())
            all = united(all, treatment.mask(layer.name));
    if (area_of(all, 1).mm2 == 0)
        fail("{}: has no retouch that quality could be told of; give --class, --mask or --polygon",
             treatment.folder().string());
    return all;
}

void require_sound(const QualityArguments& a) {
    if (a.treatment.empty()) {
        if (a.painting.empty() || a.out.empty() || a.area.masks.empty())
            throw UsageError(
                "give a painting, its retouches and where to write: quality PAINTING.exr --mask MASK.png "
                "--out DIR; or --treatment");
        if (!a.area.classes.empty() || !a.area.polygons.empty())
            throw UsageError("--class and --polygon are of a treatment; give --mask, or --treatment");
        require_writable_folder(a.out);
    } else if (!(a.painting.empty() && a.out.empty())) {
        throw UsageError(
            "--treatment holds its painting and keeps the maps; leave out PAINTING.exr and --out");
    }
}

// A folder within the treatment that no earlier comparison wrote to: "quality/2".
std::string new_folder(const Treatment& treatment) {
    for (int number = 1;; ++number)
        if (std::string name = fmt::format("quality/{}", number); !fs::exists(treatment.folder() / name))
            return name;
}

// What the treatment keeps of it; `pictures`: the folder that they are in now, `within`: that they are for.
TreatmentStep step_of(const QualityArguments& a, const nlohmann::json& result, const fs::path& pictures,
                      const std::string& within) {
    nlohmann::json parameters = to_json(a.options);
    parameters["annulus"] = to_json(a.options.annulus);
    parameters["illuminants"] = a.illuminants;
    parameters["area"] = a.area.empty() ? nlohmann::json("retouches") : a.area.as_json();
    TreatmentStep step{
        .action = "quality", .parameters = parameters, .results = result, .inputs = a.area.inputs()};
    if (!a.damaged.empty()) step.inputs.emplace_back(a.damaged);
    for (const auto& file : fs::directory_iterator(pictures))
        step.copies[within + "/" + file.path().filename().string()] = file.path();
    return step;
}

// Regions and their mean under each illuminant, weighted by their areas.
nlohmann::json as_json(const QualityReport& report, const std::vector<Illuminant>& illuminants) {
    nlohmann::json regions = nlohmann::json::array(), mean = nlohmann::json::object();
    for (const RetouchQuality& q : report.regions) regions.push_back(as_json(q));
    for (const Illuminant illuminant : illuminants) {
        double sum = 0, area = 0;
        for (const RetouchQuality& q : report.regions)
            sum += q.area_mm2 * q.delta_e[static_cast<std::size_t>(illuminant)], area += q.area_mm2;
        mean[std::string(name_of(illuminant))] = sum / area;
    }
    return {{"delta_e_2000", mean}, {"regions", regions}};
}

nlohmann::json run_quality(const QualityArguments& a) {
    const std::vector<Illuminant> illuminants = illuminants_in(a.illuminants, "--illuminants");
    require_sound(a);
    const Progress progress = console_progress();
    std::optional<Treatment> treatment;
    if (!a.treatment.empty())
        treatment = open_treatment(a.treatment), require_its_scale(*treatment, a.mm_per_pixel);
    Canvas canvas =
        treatment ? treatment->read_canvas(progress) : read_canvas(a.painting, progress, a.mm_per_pixel);
    Mask spoilt = a.damaged.empty() ? Mask() : read_mask(a.damaged, canvas.width(), canvas.height());
    Mask mask(canvas.width(), canvas.height());
    if (treatment) {
        mask = a.area.empty() ? retouched(*treatment) : a.area.area(*treatment);
        spoilt = spoilt.empty() ? damaged(*treatment) : united(spoilt, damaged(*treatment));
    } else {
        for (const std::string& file : a.area.masks)
            mask = united(mask, read_mask(file, canvas.width(), canvas.height()));
    }
    QualityReport report = quality_of(canvas, mask, spoilt, illuminants, a.options, progress);
    mask = spoilt = Mask();
    const double mm_per_pixel = canvas.mm_per_pixel();
    const bool scale_known =
        treatment ? treatment->scale_known() : canvas.dry().scale_known || a.mm_per_pixel;
    const std::string within = treatment ? new_folder(*treatment) : "";
    const fs::path folder = treatment ? treatment->folder() / within : fs::path(a.out);
    // All of them, or none. Of a treatment they wait where the next command looks for what was left.
    FolderFiles written(treatment ? treatment->folder() : folder);
    const fs::path pictures = treatment ? written.temporary() / within : written.temporary();
    told_of(pictures, folder, [&] {
        make_folder(pictures);
        write_pictures(pictures, report, std::move(canvas), progress);
    });
    nlohmann::json result = in_known_units(as_json(report, illuminants), mm_per_pixel, scale_known);
    nlohmann::json raking = nlohmann::json::array();
    for (const auto& [name, unused] : kRaking) raking.push_back((folder / raking_picture(name)).string());
    if (treatment)
        treatment->record(step_of(a, result, pictures, within), a.author.author(), progress);
    else
        written.place();
    result["folder"] = folder.string();
    result["raking"] = raking;
    return result;
}

}  // namespace

Command quality_command() {
    return {"quality", "compare retouches with what is beside them: colour, height, gloss, raking light",
            [](Flags& flags) {
                auto a = std::make_shared<QualityArguments>();
                flags.option("PAINTING", a->painting, "painting (.exr or .tangi) with its retouches");
                a->area.add_to(flags, "where the retouches are; of a treatment all of them without");
                flags.option(
                    "--out", a->out,
                    "folder to write: maps of CIEDE2000 (the worst under the illuminants), height and gloss "
                    "against the surroundings, and pictures in raking light");
                flags.option(
                    "--treatment", a->treatment,
                    "treatment to compare, and log and report it in (docs/guide/retouching.md), instead of "
                    "PAINTING.exr and --out");
                a->author.add_to(flags);
                flags.option("--damaged", a->damaged,
                             "picture, white where there is other damage beside them");
                flags
                    .option("--illuminants", a->illuminants,
                            "illuminants to compare under: of A, D50, D65, F11, LED")
                    .show_default();
                flags
                    .option("--mm-per-pixel", a->mm_per_pixel,
                            "size of the painting's pixels where the file does not say")
                    .check(within(1e-4, 1e3));
                flags.fields(a->options);
                flags.fields(a->options.annulus);
                return [a] { return run_quality(*a); };
            }};
}

}  // namespace tangi
