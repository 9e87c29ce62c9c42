// quality_command.cpp: tangipaint quality PAINTING.exr --mask MASK.png --out DIR: retouches against what is
// beside them.
#include <cmath>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch_arguments.h"
#include "paint/appearance.h"
#include "paint/canvas_file.h"
#include "paint/retouch/quality.h"
#include "surface/error.h"
#include "surface/picture_file.h"
#include "surface/relight.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kRaking_deg = 15;
constexpr std::array<std::pair<const char*, double>, 4> kRaking = {
    {{"right", 0}, {"top", 90}, {"left", 180}, {"bottom", 270}}};

struct QualityArguments {
    std::string painting, mask, damaged, out, lamps = "D65,A,F11";
    std::optional<double> mm_per_pixel;
    QualityOptions options;
};

nlohmann::json as_json(const Step& step) { return {{"mean", step.mean}, {"rms", step.rms}}; }

nlohmann::json as_json(const RetouchQuality& q) {
    return {{"box_px", {q.box.x0, q.box.y0, q.box.x1, q.box.y1}},
            {"area_mm2", q.area_mm2},
            {"delta_e_2000", by_lamp(q.delta_e)},
            {"border_delta_e_2000", by_lamp(q.border_delta_e)},
            {"height_step_mm", as_json(q.height_mm)},
            {"gloss_step", q.gloss_step},
            {"specular_step", as_json(q.specular)},
            {"roughness_step", as_json(q.roughness)}};
}

// What light from the sides shows: steps, and gloss that differs.
nlohmann::json write_raking(const Canvas& canvas, const fs::path& folder, const Progress& progress) {
    const Surface seen = appearance(canvas, {}, progress);
    nlohmann::json files = nlohmann::json::array();
    for (const auto& [name, azimuth_deg] : kRaking) {
        const double a = azimuth_deg * M_PI / 180, e = kRaking_deg * M_PI / 180;
        Light light =
            distant_light({static_cast<float>(std::cos(a) * std::cos(e)),
                           static_cast<float>(std::sin(a) * std::cos(e)), static_cast<float>(std::sin(e))});
        light.gain = Rgb(static_cast<float>(1 / std::sin(e)));  // a flat matt white is 1
        const fs::path path = folder / fmt::format("raking_{}.png", name);
        RelightOptions options;
        options.cast_shadows = true;
        write_picture(path, relight(seen, std::span(&light, 1), options, progress),
                      Transfer{Transfer::Kind::srgb}, {.bits = 8});
        files.push_back(path.string());
    }
    return files;
}

nlohmann::json run_quality(const QualityArguments& a) {
    const std::vector<Illuminant> lamps = lamps_in(a.lamps, "--lamps");
    require_writable_folder(a.out);
    const Progress progress = console_progress();
    const Canvas canvas = read_canvas(a.painting, progress, a.mm_per_pixel);
    const Mask mask = read_mask(a.mask, canvas.width(), canvas.height());
    const Mask damaged = a.damaged.empty() ? Mask() : read_mask(a.damaged, canvas.width(), canvas.height());
    const QualityReport report = quality_of(canvas, mask, damaged, lamps, a.options, progress);
    fs::create_directories(a.out);
    const fs::path folder = a.out;
    write_map(folder / "delta_e_2000.exr", report.delta_e);
    write_map(folder / "height_mm.exr", report.height_mm);
    write_map(folder / "gloss.exr", report.gloss);
    // Black is 0, white CIEDE2000 10.
    Image<float> shown = report.delta_e;
    for (float& v : shown.pixels()) v = std::min(v / 10, 1.0f);
    write_map(folder / "delta_e_2000.png", shown, {.bits = 8});
    nlohmann::json regions = nlohmann::json::array();
    for (const RetouchQuality& q : report.regions) regions.push_back(as_json(q));
    nlohmann::json mean = nlohmann::json::object();
    for (const Illuminant lamp : lamps) {
        double sum = 0, area = 0;
        for (const RetouchQuality& q : report.regions)
            sum += q.area_mm2 * q.delta_e[static_cast<std::size_t>(lamp)], area += q.area_mm2;
        mean[std::string(name_of(lamp))] = sum / area;
    }
    return {{"folder", a.out},
            {"delta_e_2000", mean},
            {"regions", regions},
            {"raking", write_raking(canvas, folder, progress)}};
}

}  // namespace

Command quality_command() {
    return {
        "quality", "compare retouches with what is beside them: colour, height, gloss, raking light",
        [](Flags& flags) {
            auto a = std::make_shared<QualityArguments>();
            flags.option("PAINTING", a->painting, "painting file (.exr) with its retouches").required();
            flags.option("--mask", a->mask, "picture, white where the retouches are").required();
            flags
                .option("--out", a->out,
                        "folder to write: maps of CIEDE2000 (the worst under the lamps), height and gloss "
                        "against the surroundings, and pictures in raking light")
                .required();
            flags.option("--damaged", a->damaged, "picture, white where there is other damage beside them");
            flags.option("--lamps", a->lamps, "lamps to compare under: of A, D50, D65, F11, LED")
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
