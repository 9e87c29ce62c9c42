// damage_command.cpp: tangipaint damage P.exr --treatment DIR: what is damaged, suggested or drawn; a table.
#include <cmath>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch/treatment_arguments.h"
#include "retouch/damage/area_suggestion.h"
#include "retouch/mask/mask_editor.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_picture.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kAlike = 8;         // CIE Delta E 1976
constexpr double kWorthALook = 0.1;  // [1] an area of less confidence is not spoken of

struct DamageArguments {
    std::string painting, treatment, suggest, as, edit = "add", wand, legend;
    std::optional<double> mm_per_pixel;
    std::optional<double> tolerance;  // CIE Delta E 1976 that the wand goes on by
    double grow_mm = 0;
    AreaArguments area;
    AuthorArguments author;
    LossOptions loss;
    CraquelureOptions craquelure;
    GlossOptions gloss;
    AreaOptions areas;
};

nlohmann::json to_json(const std::vector<SuggestedArea>& areas) {
    nlohmann::json all = nlohmann::json::array();
    for (const SuggestedArea& area : areas)
        all.push_back({{"box_px", {area.box.x0, area.box.y0, area.box.x1, area.box.y1}},
                       {"area_mm2", area.area_mm2},
                       {"confidence", area.confidence},
                       {"evidence", area.confidence < kWeakEvidence ? "weak" : "good"},
                       {"cues", area.cues}});
    return all;
}

nlohmann::json to_json(const std::vector<GlossPatch>& patches) {
    nlohmann::json all = nlohmann::json::array();
    for (const GlossPatch& p : patches)
        all.push_back({{"glossier", p.glossier},
                       {"box_px", {p.box.x0, p.box.y0, p.box.x1, p.box.y1}},
                       {"area_mm2", p.area_mm2},
                       {"roughness_ratio", p.roughness_ratio},
                       {"specular_ratio", p.specular_ratio}});
    return all;
}

void draw_legend(AtomicFile& legend, const Treatment& treatment, const MasksToCome& to_come,
                 const Progress& progress) {
    told_of(legend.temporary(), legend.target(), [&] {
        write_picture_8bit(legend.temporary(),
                           damage_picture(treatment, treatment.read_canvas(progress).dry(), to_come));
    });
}

// The legend shows what the step makes of the map, and comes about with it, or neither does.
void add_legend(AtomicFile& legend, const Treatment& treatment, TreatmentStep& step,
                const Progress& progress) {
    draw_legend(legend, treatment, step.masks, progress);
    step.elsewhere = [&legend] { legend.commit(); };
}

// What was suggested replaces what the class had, as the log says.
nlohmann::json suggest(Treatment& treatment, const DamageArguments& a, AtomicFile* legend,
                       const Progress& progress) {
    const Canvas canvas = treatment.read_canvas(progress);
    const Surface& surface = canvas.dry();
    const double mm = treatment.mm_per_pixel();
    TreatmentStep step{.action = "suggest damage", .parameters = {{"suggest", a.suggest}}};
    const auto keep = [&](const std::string& name, const DamageSuggestion& s) {
        step.masks[name] = s.mask;
        step.masks[name + ".confidence"] = s.confidence;
        const MaskArea area = area_of(s.mask, mm);
        step.results[name] = area_of_step(treatment, area.mm2);
        step.results[name]["count"] = area.regions, step.results[name]["percent"] = area.percent;
    };
    if (a.suggest == "loss") {
        const std::string name = a.as.empty() ? "loss_to_ground" : a.as;
        step.parameters["options"] = to_json(a.loss);
        keep(name, suggest_loss(surface, mm, a.loss, progress));
    } else if (a.suggest == "craquelure") {
        const CraquelureSuggestion cracks = suggest_craquelure(surface, mm, a.craquelure, progress);
        step.parameters["options"] = to_json(a.craquelure);
        keep(a.as.empty() ? "craquelure" : a.as, cracks);
        step.results["measured"] = as_stated(cracks.measure, mm, treatment.scale_known());
    } else if (const auto damage = damage_class_named(a.suggest)) {
        const AreaSuggestion areas = suggest_areas(surface, mm, *damage, a.areas, progress);
        step.parameters["options"] = to_json(a.areas);
        keep(a.as.empty() ? a.suggest : a.as, areas);
        step.results["areas"] = to_json(areas.areas);
        if (areas.areas.empty() && areas.surest >= kWorthALook)
            step.results["less_sure"] = fmt::format(
                "nothing that is sure enough; the surest area has {:.2f}: --area-confidence {:.2f} suggests "
                "it",
                areas.surest, std::floor(areas.surest * 100) / 100);
    } else {
        const GlossSuggestion gloss = suggest_gloss(surface, mm, a.gloss, progress);
        step.parameters["options"] = to_json(a.gloss);
        keep("glossier", gloss.glossier);
        keep(a.as.empty() ? "matter" : a.as, gloss.matter);
        step.results["patches"] = to_json(gloss.patches);
    }
    step.results = in_known_units(step.results, treatment);
    const nlohmann::json result = step.results;
    if (legend) add_legend(*legend, treatment, step, progress);
    treatment.record(step, a.author.author(), progress);
    return result;
}

Mask wanded(const Treatment& treatment, const DamageArguments& a, const Progress& progress) {
    const auto xy = numbers_in(a.wand, "--wand", "X,Y");
    if (xy.size() != 2) throw UsageError(fmt::format("--wand {}: give a point in mm: X,Y", a.wand));
    const double mm = treatment.mm_per_pixel();
    const auto pixel = [](double v) { return static_cast<int>(std::floor(std::clamp(v, -1e6, 1e6))); };
    return wand(treatment.read_canvas(progress).dry(), pixel(xy[0] / mm + treatment.width() / 2.0),
                pixel(treatment.height() / 2.0 - xy[1] / mm), WandBy::colour, a.tolerance.value_or(kAlike));
}

// Drawn areas are added to a class, taken away from it, or replace it.
void draw(Treatment& treatment, const DamageArguments& a, AtomicFile* legend, const Progress& progress) {
    if (a.area.classes.size() != 1)
        throw UsageError("name the one class that is drawn: --class loss_to_ground");
    const DamageClass damage = damage_class_of(a.area.classes.front(), "--class");
    AreaArguments drawn = a.area;
    drawn.classes.clear();
    Mask area = drawn.area(treatment);
    if (!a.wand.empty()) area = united(area, wanded(treatment, a, progress));
    if (area_of(area, 1).mm2 == 0 && a.edit != "replace")
        throw UsageError(
            "nothing is inside of what is drawn: of a mask, white is; --edit replace empties a class");
    if (a.grow_mm != 0) area = dilated(area, a.grow_mm / treatment.mm_per_pixel());
    const Mask before = treatment.mask(damage);
    const Mask after = a.edit == "replace"  ? area
                       : a.edit == "remove" ? without(before, area)
                                            : united(before, area);
    const std::string name(name_of(damage));
    TreatmentStep step{
        .action = "draw damage",
        .parameters = {{"class", name}, {"edit", a.edit}, {"area", drawn.as_json()}, {"grow_mm", a.grow_mm}},
        .inputs = drawn.inputs()};
    if (!a.wand.empty())
        step.parameters["wand_mm"] = a.wand, step.parameters["tolerance"] = a.tolerance.value_or(kAlike);
    step.masks[name] = after;
    step.results[name] = area_of_step(treatment, area_of(after, treatment.mm_per_pixel()).mm2);
    if (legend) add_legend(*legend, treatment, step, progress);
    treatment.record(step, a.author.author(), progress);
}

// Flags that have nothing to work on would be passed over in silence.
void require_use(const DamageArguments& a, bool drawing) {
    if (!drawing && !a.area.classes.empty())
        throw UsageError("--class: nothing is drawn; give --polygon, --mask or --wand, or --edit replace");
    if (!drawing && (a.edit != "add" || a.grow_mm != 0))
        throw UsageError(
            "--edit and --grow-mm are of what is drawn; give --class with --polygon, --mask or --wand");
    if (a.wand.empty() && a.tolerance) throw UsageError("--tolerance is of --wand X,Y, which is not given");
}

nlohmann::json run_damage(const DamageArguments& a) {
    const Progress progress = console_progress();
    const bool drawing = !a.area.masks.empty() || !a.area.polygons.empty() || !a.wand.empty() ||
                         (!a.area.classes.empty() && a.edit == "replace");  // by nothing: emptied
    if (!a.suggest.empty() && (drawing || !a.area.classes.empty()))
        throw UsageError("--suggest finds areas by itself: draw in a second run; --as names another class");
    if (!a.as.empty()) damage_class_of(a.as, "--as");
    require_use(a, drawing);
    if (a.treatment.empty()) throw UsageError("--treatment: name the folder of the treatment: P.treatment");
    std::optional<AtomicFile> legend;
    if (!a.legend.empty()) {
        require_picture_ending(a.legend, "--legend");
        refuse_to_overwrite(a.legend, {a.painting});
        legend.emplace(a.legend);  // that it can be written is known before the step
    }
    Treatment treatment =
        fs::exists(fs::path(a.treatment) / "log.jsonl")
            ? open_treatment(a.treatment)
            : Treatment::begin(a.treatment, a.painting, a.author.author(), a.mm_per_pixel, progress);
    require_its_scale(treatment, a.mm_per_pixel);
    if (sha256_of(read_painting(a.painting, progress)) != treatment.dry_sha256())
        fail("{}: is not the painting that {} began with", a.painting, a.treatment);
    nlohmann::json result = {{"treatment", a.treatment}};
    AtomicFile* const picture = legend ? &*legend : nullptr;
    if (!a.suggest.empty()) result["suggested"] = suggest(treatment, a, picture, progress);
    if (drawing) draw(treatment, a, picture, progress);
    result["damage"] = damage_table(treatment);
    if (treatment.has_mask(DamageClass::craquelure))
        result["craquelure"] =
            as_stated(measure_lines(treatment.mask(DamageClass::craquelure), treatment.mm_per_pixel()),
                      treatment.mm_per_pixel(), treatment.scale_known());
    if (!treatment.scale_known())
        result["warnings"] =
            told({"the painting's scale is unknown: a pixel counts as one mm; begin with "
                  "--mm-per-pixel for areas in cm2"});
    if (legend) {
        if (a.suggest.empty() && !drawing) {  // of what is mapped already
            draw_legend(*legend, treatment, {}, progress);
            legend->commit();
        }
        result["legend"] = a.legend;
    }
    return result;
}

}  // namespace

Command damage_command() {
    return {
        "damage", "map the damage of a painting: suggested, or drawn; begins its treatment",
        [](Flags& flags) {
            auto a = std::make_shared<DamageArguments>();
            flags.option("PAINTING", a->painting, "painting (.exr or .tangi)").required();
            flags.option("--treatment", a->treatment, "folder of the treatment; made where it is not there")
                .required();
            flags
                .option("--suggest", a->suggest,
                        "loss, craquelure, gloss, old_fill, overpaint, stain, abrasion or flaking")
                .check(one_of({"loss", "craquelure", "gloss", "old_fill", "overpaint", "stain", "abrasion",
                               "flaking"}));
            flags.option("--as", a->as, "class that what is suggested goes to, where not the usual one");
            a->area.add_to(flags, "that is drawn");
            flags.option("--edit", a->edit, "what is drawn is added to the class, or: replace, remove")
                .check(one_of({"add", "replace", "remove"}));
            flags.option("--wand", a->wand,
                         "X,Y in mm from the centre, y up: what is connected to it and of its colour");
            flags
                .option("--tolerance", a->tolerance,
                        fmt::format("of the wand, CIE Delta E 1976; {} where not given", kAlike))
                .check(within(0.1, 200));
            flags.option("--grow-mm", a->grow_mm, "make what is drawn so much wider; below 0: narrower")
                .check(within(-100, 100));
            flags.option("--legend", a->legend, "picture to write: the map of damage with its legend");
            flags
                .option("--mm-per-pixel", a->mm_per_pixel,
                        "size of the painting's pixels where the file does not say")
                .check(within(1e-4, 1e3));
            a->author.add_to(flags);
            flags.fields(a->craquelure);
            flags.fields(a->loss);
            flags.fields(a->gloss);
            flags.fields(a->areas);
            return [a] { return run_damage(*a); };
        }};
}

}  // namespace tangi
