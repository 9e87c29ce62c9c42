// treatment_command.cpp: tangipaint treatment ACTION DIR: what there is, checked, painted, taken off, shown,
// reported.
#include <algorithm>
#include <cctype>
#include <functional>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch/treatment_arguments.h"
#include "paint/canvas/appearance.h"
#include "paint/session/session.h"
#include "retouch/report/treatment_report.h"
#include "retouch/treatment/confining_mask.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_picture.h"
#include "retouch/treatment/treatment_strokes.h"
#include "surface/base/error.h"
#include "surface/base/words.h"
#include "surface/file/atomic_file.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

struct TreatmentArguments {
    std::string action, folder, painting, strokes, palette, layer, state = "varnished",
                                                                   light = "0.35,0.35,0.87", out;
    std::string published_at;
    bool all = false;
    double feather_mm = 0;
    std::optional<double> mm_per_pixel;
    AreaArguments area;
    AuthorArguments author;
    std::function<std::vector<std::string>()> typed;  // flags of the command
};

void require(const std::string& value, const char* flag, const std::string& action) {
    if (value.empty()) throw UsageError(fmt::format("treatment {}: give {}", action, flag));
}

json layers_of(const Treatment& treatment) {
    json layers = json::array();
    for (const TreatmentLayer& layer : treatment.layers())
        layers.push_back({{"name", layer.name}, {"role", name_of(layer.role)}, {"sha256", layer.sha256}});
    return layers;
}

json status(const Treatment& treatment) {
    json masks = treatment.mask_names();
    return {{"treatment", treatment.folder().string()},
            {"width", treatment.width()},
            {"height", treatment.height()},
            {"mm_per_pixel", treatment.mm_per_pixel()},
            {"scale_known", treatment.scale_known()},
            {"dry_sha256", treatment.dry_sha256()},
            {"log_lines", treatment.log().entries().size()},
            {"log_head", treatment.log().head()},
            {"damage", damage_table(treatment)},
            {"masks", masks},
            {"layers", layers_of(treatment)}};
}

json check(const Treatment& treatment, const Progress& progress) {
    std::vector<std::string> faults = treatment.check(progress);
    for (std::string& fault : strokes_that_cannot_be_repeated(treatment)) faults.push_back(std::move(fault));
    StrokesRepeated repeated;
    if (faults.empty()) repeated = repeat_strokes(treatment, treatment.read_canvas(progress), progress);
    for (std::string& fault : repeated.faults) faults.push_back(std::move(fault));
    for (const std::string& fault : faults) warn(fault);
    if (!faults.empty())
        fail("{}: {} of what the log says is not so; the first: {}", treatment.folder().string(),
             faults.size(), faults.front());
    json result = status(treatment);
    result["checked"] = true;
    result["strokes"] = {{"painted_again", repeated.painted_again},
                         {"not_painted_again", repeated.not_repeated}};
    std::vector<std::string> unlogged = treatment.unlogged(treatment.read_canvas(progress));
    for (std::string& what : unlogged)
        what += fmt::format("; tangipaint treatment retouch {} takes it in", treatment.folder().string());
    if (!unlogged.empty()) result["warnings"] = told(unlogged);
    return result;
}

// Strokes stop at the area of this step, not at masks of where they were made.
void leave_masks_out(Journal& journal) {
    for (const auto& [line, event] : journal.entries)
        if (std::holds_alternative<ConfineEvent>(event))
            journal.warnings.push_back(
                {line, "'confine' is rejected: strokes stop at the area of this step"});
    std::erase_if(journal.entries,
                  [](const auto& entry) { return std::holds_alternative<ConfineEvent>(entry.event); });
}

// Strokes of a journal, or wet paint that the window left on the treatment's painting, as a retouch.
json retouch(Treatment& treatment, const TreatmentArguments& a, const Progress& progress) {
    Canvas canvas = treatment.read_canvas(progress);
    StepArea area = a.area.step_area(treatment);
    if (a.area.empty()) area.mask = damaged(treatment);
    if (area_of(area.mask, 1).mm2 == 0)
        fail("{}: no damage is mapped where a retouch would belong; give --class, --mask or --polygon",
             treatment.folder().string());
    TreatmentStep step{.action = "retouch", .parameters = {{"feather_mm", a.feather_mm}}};
    if (!a.strokes.empty()) {
        if (!canvas.wet().empty())
            fail("{}: has wet paint on it already; dry it first with treatment retouch without --strokes",
                 treatment.painting().string());
        const ConfiningMask mask =
            confining_mask(treatment.folder(), feathered(area.mask, a.feather_mm / treatment.mm_per_pixel()));
        Journal journal = read_journal(a.strokes);
        leave_masks_out(journal);
        Session session(std::move(canvas), a.palette.empty() ? artist_acrylics() : read_palette(a.palette));
        step.strokes = strokes_within(mask, journal, session);
        session.canvas().confine(mask.mask);
        step.results["warnings"] = told(replay(session, journal, progress));
        step.results["strokes"] = session.totals().strokes;
        canvas = session.canvas();
        canvas.confine({});
        step.inputs.emplace_back(a.strokes);
        if (!a.palette.empty()) step.inputs.emplace_back(a.palette);
        step.parameters["palette"] = session.palette().name;
    }
    const std::size_t before = step.results.contains("warnings") ? step.results["warnings"].size() : 0;
    const std::string source = a.strokes.empty() ? treatment.painting().string() : a.strokes;
    json result =
        retouch_step(treatment, canvas, {area, std::move(step), source}, a.author.author(), progress);
    if (result.contains("warnings")) told(result["warnings"].get<std::vector<std::string>>(), before);
    return result;
}

json remove(Treatment& treatment, const TreatmentArguments& a, const Progress& progress) {
    if (a.layer.empty() == !a.all) throw UsageError("treatment remove: give --layer NAME, or --all");
    Canvas canvas = treatment.read_canvas(progress);
    std::vector<std::string> removed;
    if (a.all)
        for (const TreatmentLayer& layer : treatment.layers()) removed.push_back(layer.name);
    else
        removed.push_back(a.layer);
    remove_step(treatment, canvas, removed, a.author.author(), progress);
    json result = status(treatment);
    result["removed"] = removed;
    if (canvas.dried().empty())
        result["identical_to_original"] = sha256_of(*shown(canvas)) == treatment.dry_sha256();
    return result;
}

json undo(Treatment& treatment, const TreatmentArguments& a, const Progress& progress) {
    Canvas canvas = treatment.read_canvas(progress);
    json result = undo_step(treatment, canvas, a.author.author(), progress);
    result.update(status(treatment));
    return result;
}

json show(const Treatment& treatment, const TreatmentArguments& a, const Progress& progress) {
    const auto state = treatment_stage_named(a.state);
    const Vec3 light = parse_direction_in_front(a.light, "--light");
    Surface surface;
    {
        const Canvas canvas = treatment.read_canvas(progress);
        surface = surface_in_state(treatment, canvas, *state, progress);
    }
    write_picture_8bit(a.out, look_of(surface, distant_light(light), 0, progress));
    return {{"picture", a.out}, {"state", a.state}};
}

json show_additions(const Treatment& treatment, const TreatmentArguments& a, const Progress& progress) {
    const Canvas canvas = treatment.read_canvas(progress);
    const Mask belongs = mapped_damage(treatment);
    write_picture_8bit(a.out, additions_picture(canvas, treatment.layers(), belongs));
    json layers = json::object();
    for (const DriedLayer& layer : canvas.dried())
        layers[layer.name] =
            in_known_units(to_json(on_original(layer.paint, belongs, treatment.mm_per_pixel())), treatment);
    return {{"picture", a.out}, {"on_original", layers}};
}

// Where files are published, with the stroke that their names follow.
std::string address_of(std::string url) {
    if (url.empty()) return url;
    const auto refuse = [&](std::string_view why) {
        throw UsageError(
            fmt::format("--published-at {}: {}; give the address of a folder: "
                        "https://museum.example/42/",
                        url, why));
    };
    const std::size_t slashes = url.find("://");
    const std::string scheme = lower_case(url.substr(0, slashes == std::string::npos ? 0 : slashes));
    if (scheme != "https" && scheme != "http") refuse("does not begin with https:// or http://");
    const std::size_t host = slashes + 3;
    if (host >= url.size() || !std::isalnum(static_cast<unsigned char>(url[host]))) refuse("names no host");
    for (const char c : url)
        if (c <= ' ' || c >= 0x7f || std::string_view("?#\"'<>\\^`{|}").find(c) != std::string_view::npos)
            refuse("has a letter that no folder's address has (write it as %XX)");
    url.replace(0, slashes, scheme);
    if (!url.ends_with('/')) url += '/';
    return url;
}

// Flags that this action has no use for.
void refuse_useless(const TreatmentArguments& a) {
    struct Use {
        std::initializer_list<std::string_view> flags, actions;
        const char* of;
    };
    const Use uses[] = {{{"--painting"}, {"begin", "earlier"}, "begin and earlier"},
                        {{"--mm-per-pixel"}, {"begin"}, "begin"},
                        {{"--strokes", "--palette", "--class", "--mask", "--polygon", "--feather-mm"},
                         {"retouch"},
                         "retouch"},
                        {{"--layer", "--all"}, {"remove"}, "remove"},
                        {{"--state", "--light"}, {"show"}, "show"},
                        {{"--out"}, {"show", "additions", "report"}, "show, additions and report"},
                        {{"--published-at"}, {"report"}, "report"}};
    for (const Use& use : uses)
        if (std::find(use.actions.begin(), use.actions.end(), a.action) == use.actions.end())
            refuse_typed(a.typed(), use.flags,
                         fmt::format("is of {}; {} has no use for it", use.of, a.action));
}

json run_treatment(const TreatmentArguments& a) {
    const Progress progress = console_progress();
    refuse_useless(a);
    if (a.action == "begin") {
        require(a.painting, "--painting P.exr", a.action);
        return status(Treatment::begin(a.folder, a.painting, a.author.author(), a.mm_per_pixel, progress));
    }
    const bool writes = a.action == "show" || a.action == "additions" || a.action == "report";
    if (writes) require(a.out, "--out FILE", a.action);
    if (writes && a.action != "report") require_picture_ending(a.out);
    address_of(a.published_at);
    if (a.action == "report" && lower_extension(a.out) != ".html" && lower_extension(a.out) != ".pdf")
        throw UsageError(fmt::format("--out {}: a report is written as .html and .pdf, side by side", a.out));
    Treatment treatment = open_treatment(a.folder);
    if (writes) refuse_to_overwrite(a.out, {treatment.painting(), treatment.log().path()});
    if (a.action == "status") return status(treatment);
    if (a.action == "check") return check(treatment, progress);
    // A report without them would say that they are not there.
    if (a.action == "retouch" || a.action == "remove" || a.action == "undo" || a.action == "report")
        refuse_over_unsaved(treatment);
    if (a.action == "retouch") return retouch(treatment, a, progress);
    if (a.action == "earlier") {
        require(a.painting, "--painting P.exr", a.action);
        treatment.keep_earlier(a.painting, a.author.author(), progress);
        return status(treatment);
    }
    if (a.action == "remove") return remove(treatment, a, progress);
    if (a.action == "undo") return undo(treatment, a, progress);
    if (a.action == "show") return show(treatment, a, progress);
    if (a.action == "additions") return show_additions(treatment, a, progress);
    json files = json::array();
    for (const fs::path& file : write_treatment_report(treatment, a.out, a.author.author().tool, progress,
                                                       address_of(a.published_at)))
        files.push_back(file.string());
    return {{"files", files}, {"log_head", treatment.log().head()}};
}

}  // namespace

Command treatment_command() {
    return {
        "treatment",
        "the treatment of a painting: begin, earlier, status, check, retouch, undo, remove, show, additions, "
        "report",
        [](Flags& flags) {
            auto a = std::make_shared<TreatmentArguments>();
            flags
                .option("ACTION", a->action,
                        "begin, earlier, status, check, retouch, undo, remove, show, additions, report")
                .required()
                .check(one_of({"begin", "earlier", "status", "check", "retouch", "undo", "remove", "show",
                               "additions", "report"}));
            flags.option("TREATMENT", a->folder, "folder of the treatment").required();
            flags.option("--painting", a->painting,
                         "begin, earlier: painting, which is copied; earlier: as it was before "
                         "it was cleaned");
            flags
                .option("--mm-per-pixel", a->mm_per_pixel,
                        "begin: size of the painting's pixels where the file does not say")
                .check(within(1e-4, 1e3));
            flags.option("--strokes", a->strokes,
                         "retouch: journal of strokes; without, the wet paint that the window left");
            flags.option("--palette", a->palette, "retouch: palette file (.json) that the strokes name");
            a->area.add_to(flags, "that the retouch stops at (losses and fills without)");
            flags.option("--feather-mm", a->feather_mm, "retouch: width over which it fades out at the rim")
                .check(within(0, 100))
                .show_default();
            flags.option("--layer", a->layer, "remove: name of the layer");
            flags.flag("--all", a->all, "remove: all layers");
            flags.option("--state", a->state, "show: before, cleaned, filled, retouched or varnished")
                .check(one_of({"before", "cleaned", "filled", "retouched", "varnished"}))
                .show_default();
            flags.option("--light", a->light, "show: direction to the light, X,Y,Z").show_default();
            flags.option("--out", a->out,
                         "show, additions: picture; report: page (.html), with a .pdf beside it");
            flags.option("--published-at", a->published_at,
                         "report: address (https://…/) that its files will have, for the IIIF manifest and "
                         "the annotations");
            a->author.add_to(flags);
            a->typed = flags.typed();
            return [a] { return run_treatment(*a); };
        }};
}

}  // namespace tangi
