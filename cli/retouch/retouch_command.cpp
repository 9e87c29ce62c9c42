// retouch_command.cpp: tangipaint retouch PAINTING.exr --mask MASK.png --mode MODE --out OUT.exr
#include <algorithm>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch/retouch_arguments.h"
#include "cli/retouch/treatment_arguments.h"
#include "paint/canvas/appearance_part.h"
#include "paint/files/canvas_file.h"
#include "retouch/colour_match/viewing_distance.h"
#include "retouch/inpaint/retouch_modes.h"
#include "retouch/treatment/treatment_area.h"
#include "surface/base/error.h"
#include "surface/base/words.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct RetouchArguments {
    std::string painting, damaged, mode = "mimetic", out, layer, inpainting = "membrane", preview;
    std::string treatment;
    AuthorArguments author;
    AreaArguments area;
    std::optional<double> mm_per_pixel;
    double distance_m = 2;
    PaintBoxArguments box;
    RetouchOptions options;
    ViewingOptions viewing;
};

// Colours carried on by more than a membrane are a guess of what was there, and named so.
std::string layer_name(const RetouchArguments& a, const Canvas& canvas) {
    if (!a.layer.empty()) return a.layer;
    const std::string what = a.inpainting == "membrane" ? fmt::format("retouch {}", a.mode)
                                                        : fmt::format("proposal {} {}", a.inpainting, a.mode);
    for (int number = 1;; ++number) {
        const std::string name = fmt::format("{} {}", what, number);
        const auto& dried = canvas.dried();
        if (std::none_of(dried.begin(), dried.end(), [&](const auto& d) { return d.name == name; }))
            return name;
    }
}

// What a suggestion of damage writes: a class, "glossier" and "matter", and the confidence of each.
bool names_a_suggestion(std::string name) {
    constexpr std::string_view confidence = ".confidence";
    if (name.ends_with(confidence)) name.resize(name.size() - confidence.size());
    return damage_class_named(name) || name == "glossier" || name == "matter";
}

// A layer's mask is a file of its name, and later steps find the layer by it: no other layer, mask or
// suggestion has it or had it, in whatever case, which some file systems do not tell apart.
void require_new_name(const std::string& name, const Canvas& canvas,
                      const std::optional<Treatment>& treatment) {
    constexpr std::size_t longest = 80;
    const bool odd = std::any_of(name.begin(), name.end(), [](char c) {
        return c == '/' || c == '\\' || static_cast<unsigned char>(c) < ' ' || c == 0x7f;
    });
    if (odd || name.size() > longest || name.front() == '.')
        throw UsageError(fmt::format(
            "--layer: a name is of 1 to {} bytes without slashes, and does not begin with a dot", longest));
    const std::string wanted = lower_case(name);
    const auto same = [&](const std::string& other) { return lower_case(other) == wanted; };
    const auto& dried = canvas.dried();
    bool taken = std::any_of(dried.begin(), dried.end(), [&](const auto& d) { return same(d.name); });
    if (treatment) {
        const std::vector<std::string> masks = treatment->mask_names();
        taken = taken || names_a_suggestion(wanted) || std::any_of(masks.begin(), masks.end(), same);
        for (const LogEntry& entry : treatment->log().entries())
            if (entry.content.contains("layers"))
                for (const nlohmann::json& layer : entry.content["layers"])
                    taken = taken || same(layer.value("name", ""));
    }
    if (taken)
        throw UsageError(fmt::format(
            "--layer '{}': there is a layer, mask or class of damage of that name, or was; give another",
            name));
}

void require_sound(const RetouchArguments& a) {
    if (a.treatment.empty() && (a.painting.empty() || a.out.empty()))
        throw UsageError(
            "give a painting and where to write it: retouch PAINTING.exr --out OUT.exr; or --treatment");
    if (!a.treatment.empty() && !(a.painting.empty() && a.out.empty()))
        throw UsageError("--treatment holds its painting; leave out PAINTING.exr and --out");
    if (a.area.empty()) throw UsageError("say where to retouch: --mask FILE");
    if (a.treatment.empty() && a.area.masks.empty())
        throw UsageError("--class and --polygon are of a treatment; give --mask, or --treatment");
    std::vector<fs::path> inputs = a.box.inputs();
    for (const std::string& file : {a.painting, a.damaged})
        if (!file.empty()) inputs.emplace_back(file);
    for (const fs::path& file : a.area.inputs()) inputs.push_back(file);
    if (!a.out.empty()) refuse_to_overwrite(a.out, inputs);
    if (a.preview.empty()) return;
    refuse_to_overwrite(a.preview, inputs);
    require_picture_ending(a.preview, "--preview");
}

// Where paint may lie.
Mask area_of(const RetouchArguments& a, const std::optional<Treatment>& treatment, const Canvas& canvas) {
    if (treatment) return a.area.area(*treatment);
    Mask all(canvas.width(), canvas.height());
    for (const std::string& file : a.area.masks)
        all = united(all, read_mask(file, canvas.width(), canvas.height()));
    return all;
}

// What is retouched: a painting, or that of a treatment.
struct Retouched {
    std::optional<Treatment> treatment;
    Canvas canvas;
    std::string dry_sha256;
    bool scale_known = false;
    Mask mask;          // where paint may lie
    Mask spoilt;        // other damage, whose colours count for nothing; may be empty
    std::string layer;  // that the retouch becomes
};

std::optional<Treatment> treatment_of(const RetouchArguments& a) {
    if (a.treatment.empty()) return {};
    Treatment treatment = open_treatment(a.treatment);
    require_its_scale(treatment, a.mm_per_pixel);
    refuse_over_unsaved(treatment);
    return treatment;
}

Mask spoilt_of(const RetouchArguments& a, const std::optional<Treatment>& treatment, const Canvas& canvas) {
    Mask spoilt = a.damaged.empty() ? Mask() : read_mask(a.damaged, canvas.width(), canvas.height());
    if (treatment) spoilt = spoilt.empty() ? damaged(*treatment) : united(spoilt, damaged(*treatment));
    return spoilt;
}

// Colours carried on by more than a membrane are a guess of what was there.
bool is_proposal(const RetouchArguments& a) { return a.inpainting != "membrane"; }

Retouched load(const RetouchArguments& a, const Progress& progress) {
    std::optional<Treatment> treatment = treatment_of(a);
    Canvas canvas =
        treatment ? treatment->read_canvas(progress) : read_canvas(a.painting, progress, a.mm_per_pixel);
    std::string hash = sha256_of(canvas.dry());
    Mask mask = area_of(a, treatment, canvas);
    Mask spoilt = spoilt_of(a, treatment, canvas);
    if (!a.layer.empty()) require_new_name(a.layer, canvas, treatment);
    std::string layer = treatment && a.layer.empty()
                            ? treatment->new_layer_name(LayerRole::retouch, is_proposal(a))
                            : layer_name(a, canvas);
    const bool scale_known =
        treatment ? treatment->scale_known() : canvas.dry().scale_known || a.mm_per_pixel;
    return {.treatment = std::move(treatment),
            .canvas = std::move(canvas),
            .dry_sha256 = std::move(hash),
            .scale_known = scale_known,
            .mask = std::move(mask),
            .spoilt = std::move(spoilt),
            .layer = std::move(layer)};
}

// What the retouch is, what it adds to the original, and from where it is not seen any more.
nlohmann::json result_of(const RetouchArguments& a, const Retouched& on, const PaintBox& box,
                         const RetouchReport& report, const RetouchViews& views) {
    const double mm = on.canvas.mm_per_pixel();
    nlohmann::json result =
        in_known_units(to_json(report, box.palette.paints, box.warnings), mm, on.scale_known);
    result["mode"] = a.mode, result["layer"] = on.layer, result["dry_sha256"] = on.dry_sha256;
    if (on.treatment)
        count_beside(result, *on.treatment, on.canvas.dried().back(), on.mask);
    else
        result["on_original"] = in_known_units(
            to_json(on_original(on.canvas.dried().back().paint, on.mask, mm)), mm, on.scale_known);
    if (report.marks > 0)
        result["lines"].update(to_json(
            fusion_of(views.retouched, views.target, views.mask, report.pitch_mm / mm, mm, a.viewing)));
    if (!on.scale_known && (report.marks > 0 || !a.preview.empty()))
        result["warnings"].push_back(
            "the painting's scale is unknown: widths, and the distance that a retouch is seen from, take a "
            "pixel for one mm");
    return result;
}

// Lights under which these paints do not give the colour.
void add_poor(const std::vector<Illuminant>& illuminants, const RetouchReport& report,
              nlohmann::json& result) {
    for (const Illuminant illuminant : illuminants)
        if (const double off = report.delta_e_mean[static_cast<std::size_t>(illuminant)]; off > kPoorMatch)
            result["poor"].push_back(
                fmt::format("under {} the retouch is off by CIEDE2000 {:.1f} on average: these paints, so "
                            "thin, over this "
                            "ground, do not give the colour",
                            name_of(illuminant), off));
}

// What the command writes, put in place together.
struct RetouchFiles {
    std::optional<AtomicFile> painting, preview;
    OutputSet set;
};

void write_preview(const RetouchArguments& a, const Image<Rgb>& retouched, double mm_per_pixel,
                   RetouchFiles& files) {
    const bool linear = lower_extension(a.preview) == ".exr";
    told_of(files.preview.emplace(a.preview).temporary(), a.preview, [&] {
        write_picture(files.preview->temporary(), seen_from(retouched, mm_per_pixel, a.distance_m),
                      linear ? Transfer{} : Transfer{Transfer::Kind::srgb}, {.bits = 8});
    });
    files.set.add(*files.preview);
}

// In the treatment's log, with what it was made by; the preview comes into its place with it.
void record(const RetouchArguments& a, Retouched& on, const nlohmann::json& result, const PaintBox& box,
            RetouchFiles& files, const Progress& progress) {
    nlohmann::json parameters = parameters_of(*retouch_mode_named(a.mode), a.options);
    parameters["area"] = a.area.as_json();
    parameters["palette"] = box.palette.name, parameters["avoid_pairs"] = a.box.avoid_pairs;
    if (result.contains("lines")) parameters["viewing"] = to_json(a.viewing);
    TreatmentStep step;
    step.action = is_proposal(a) ? "propose" : "retouch";
    step.parameters = parameters, step.results = result;
    step.masks = {{on.layer, on.mask}};
    step.canvas = &on.canvas, step.added = {{on.layer, LayerRole::retouch}};
    step.inputs = a.box.inputs();
    for (const fs::path& file : a.area.inputs()) step.inputs.push_back(file);
    if (!a.damaged.empty()) step.inputs.emplace_back(a.damaged);
    step.elsewhere = [&] { files.set.commit(); };
    on.treatment->record(step, a.author.author(), progress);
}

nlohmann::json run_retouch(RetouchArguments a) {
    require_sound(a);
    const Progress progress = console_progress();
    const PaintBox box = paint_box(a.box);
    set_options(a.box, box, a.options.match);
    a.options.inpainting = *inpainting_named(a.inpainting);
    RetouchFiles files;
    if (a.treatment.empty())
        files.painting.emplace(a.out);  // that it can be written is known before the work
    Retouched on = load(a, progress);

    const RetouchReport report = lay_retouch(on.canvas, box.palette, on.mask, on.spoilt,
                                             {*retouch_mode_named(a.mode), on.layer, a.options}, progress);
    const RetouchViews views = retouch_views(diffuse_in(on.canvas, on.canvas.region()), on.mask, report);

    nlohmann::json result = result_of(a, on, box, report, views);
    if (result.contains("warnings")) told(result["warnings"].get<std::vector<std::string>>());
    add_poor(a.options.match.illuminants, report, result);
    if (!a.preview.empty()) {
        write_preview(a, views.retouched, on.canvas.mm_per_pixel(), files);
        result["preview"] = {{"picture", a.preview}, {"distance_m", a.distance_m}};
    }
    if (on.treatment) {
        record(a, on, result, box, files, progress);
        result["treatment"] = a.treatment;
    } else {
        fill_canvas(*files.painting, on.canvas, progress, parts_beside_paint(a.painting, progress));
        files.set.add(*files.painting);
        files.set.commit();
        result["painting"] = a.out;
    }
    return result;
}

}  // namespace

Command retouch_command() {
    return {
        "retouch", "lay a retouch inside a mask: mimetic, tratteggio, selection, abstraction, dots, neutral",
        [](Flags& flags) {
            auto a = std::make_shared<RetouchArguments>();
            flags.option("PAINTING", a->painting, "painting (.exr or .tangi)");
            a->area.add_to(flags, "where paint may lie");
            flags.option("--mode", a->mode, "mimetic, tratteggio, selection, abstraction, dotting or neutral")
                .check(one_of({"mimetic", "tratteggio", "selection", "abstraction", "dotting", "neutral"}))
                .show_default();
            flags.option("--out", a->out,
                         "painting file to write (.exr), with the retouch as a layer on top");
            flags.option("--layer", a->layer, "name of the layer; one that says the mode without");
            flags.option("--damaged", a->damaged, "picture, white where there is other damage beside it");
            flags
                .option("--inpainting", a->inpainting,
                        "how the surroundings' colour goes on into the mask: membrane, telea, "
                        "navier-stokes, patches (of the surroundings); all but the first make the layer a "
                        "proposal")
                .check(one_of({"membrane", "telea", "navier-stokes", "patches"}))
                .show_default();
            flags.option(
                "--treatment", a->treatment,
                "treatment to retouch and log in (docs/guide/retouching.md), instead of PAINTING.exr "
                "and --out");
            a->author.add_to(flags);
            flags.option("--preview", a->preview,
                         "picture to write (.png .tif .jpg .exr): the retouch as the eye has it from "
                         "--distance-m");
            flags.option("--distance-m", a->distance_m, "of the preview")
                .check(within(0.05, 1000))
                .show_default();
            flags
                .option("--mm-per-pixel", a->mm_per_pixel,
                        "size of the painting's pixels where the file does not say")
                .check(within(1e-4, 1e3));
            a->box.add_to(flags);
            flags.fields(a->options);
            flags.fields(a->options.annulus);
            flags.fields(a->options.match, [](std::string_view name) { return name == "max_paints"; });
            flags.fields(a->viewing);
            return [a] { return run_retouch(*a); };
        }};
}

}  // namespace tangi
