// treatment_actions.cpp: of the treatment: what is asked of it, and steps that are laid.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "paint/canvas/appearance_part.h"
#include "retouch/inpaint/recipe_json.h"
#include "retouch/report/treatment_report.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_picture.h"
#include "surface/base/error.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// The retouch, and nothing else, is on top of what the painting is.
bool goes_on_from(const Canvas& now, const Canvas& preview) {
    if (preview.dried().size() != now.dried().size() + 1 ||
        now.ingredients().size() > preview.ingredients().size() || !now.wet().empty())
        return false;
    for (std::size_t i = 0; i < now.dried().size(); ++i)
        if (now.dried()[i].name != preview.dried()[i].name ||
            !identical(now.dried()[i].paint, preview.dried()[i].paint))
            return false;
    return true;
}

// "; this; that": behind what a step did.
std::string all_of_warnings(const json& result) {
    std::string said;
    if (result.contains("warnings"))
        for (const json& warning : result["warnings"]) said += "; " + warning.get<std::string>();
    return said;
}

// Of a retouch of lines or dots: how wide they are, and from where they are not seen any more.
std::string lines_in_words(const RetouchReport& report, const Fusion& fusion) {
    std::string lines = fmt::format("{} lines or dots, {:.2f} mm apart, {:.2f} mm wide; ", report.marks,
                                    report.pitch_mm, report.width_mm);
    lines += fusion.fuses
                 ? fmt::format("they fuse from {:.1f} m on, there ΔE2000 {:.1f} from the colour around",
                               fusion.distance_m, fusion.delta_e_fused)
                 : fmt::format("they are still seen from {:.0f} m", fusion.distance_m);
    return lines;
}

}  // namespace

void TreatmentController::take() {
    TreatmentState& t = state_.treatment_state;
    if (job_ && job_is_ours_) {
        t.ask.open_dialog = t.ask.report_dialog = false;  // they are open
        return;
    }
    const TreatmentState::Ask ask = std::exchange(t.ask, {});
    const std::vector<MaskTouch> touches = std::exchange(t.touches, {});
    if (!painter_) return;
    if (ask.stop && job_) job_->stop();
    if (ask.begin) begin();
    if (!ask.open.empty()) {
        if (fs::is_regular_file(ask.open / "log.jsonl"))
            state_.ask.open = ask.open / "painting.exr";
        else
            setup_.say(fmt::format("{}: is no treatment: there is no log.jsonl in it", ask.open.string()));
    }
    if (!held_) return;
    if (ask.check) check();
    if (!t.usable) return;
    for (const MaskTouch& done : touches) touch(done);
    const auto own = drafts_.find(t.current);
    if (ask.undo && own != drafts_.end() && own->second.can_undo()) changed(own->second.undo());
    if (ask.redo && own != drafts_.end() && own->second.can_redo()) changed(own->second.redo());
    if (ask.keep) keep_edits();
    if (ask.drop_edits) drop_edits();
    if (ask.suggest) suggest();
    if (ask.accept && suggested_) accept();
    if (ask.drop_suggestion) {
        suggested_.reset();
        t.suggestion.reset();
        map_.set_suggestion({});
        map_changed_ = map_.compose(style_);
    }
    steps(ask);
}

void TreatmentController::steps(const TreatmentState::Ask& ask) {
    if (ask.fill) fill();
    if (ask.isolate || ask.varnish) varnish(ask.isolate);
    if (ask.preview) preview();
    if (ask.apply && preview_) apply();
    if (ask.drop_preview && preview_) {
        preview_.reset();
        state_.treatment_state.preview.reset();
        painter_->show_as({});
    }
    if (ask.undo_step) undo_last();
    if (!ask.remove.empty()) remove({ask.remove});
    if (ask.remove_all) {
        std::vector<std::string> all;
        for (const LayerRow& layer : state_.treatment_state.layers) all.push_back(layer.name);
        remove(all);
    }
    if (ask.compare_states) compare_states();
    if (ask.see_from) see_from();
    if (ask.stop_comparing) {
        state_.comparing.pair.reset();
        state_.comparing.on = state_.comparing.loaded && state_.comparing.on;
    }
    change_pairs(ask);
    if (ask.match_around) match({});
    if (ask.match_at) match(ask.match_at);
    if (ask.report_wanted && all_is_logged()) state_.treatment_state.ask.report_dialog = true;
    if (!ask.report.empty() && all_is_logged()) report(ask.report);
}

// In a folder beside the painting, which is opened.
void TreatmentController::begin() {
    const fs::path painting = painter_->file();
    fs::path folder = painting;
    folder.replace_extension(".treatment");
    if (fs::exists(folder / "log.jsonl")) {
        state_.ask.open = folder / "painting.exr";
        return;
    }
    if (state_.painter.unsaved || !state_.painter.layers.empty()) {
        setup_.say("this painting has been painted on; a treatment begins with one as it was fitted");
        return;
    }
    std::optional<double> scale;
    if (state_.scale_known)
        scale = painter_->mm_per_pixel();
    else if (state_.treatment_state.width_mm > 0)
        scale = static_cast<double>(state_.treatment_state.width_mm) / state_.painting.width;
    if (!scale && !state_.treatment_state.scale_asked) {
        state_.treatment_state.scale_asked = true;
        setup_.say(
            "the painting's scale is unknown, and a treatment keeps the scale that it began with: give the "
            "width under Treatment, at the left; begun once more without, it has pixels instead of mm");
        return;
    }
    start("beginning a treatment",
          [this, painting, folder, scale, who = author()](const Progress& p) -> Finish {
              Treatment::begin(folder, painting, who, scale, p);
              return [this, folder] {
                  state_.ask.open = folder / "painting.exr";
                  setup_.say(fmt::format(
                      "a treatment begins in {}: the painting there is a copy, and stays as it is",
                      folder.filename().string()));
              };
          });
}

// Changes the canvas on the painter's thread, so that no stroke is lost, and writes it down.
void TreatmentController::step(std::string title, Step work) {
    if (state_.painter.unsaved) {
        setup_.say("first record what was painted: Ctrl+S");
        return;
    }
    if (preview_) {
        setup_.say("first apply the retouch that is previewed, or put it aside");
        return;
    }
    start(std::move(title),
          [this, painter = painter_, work = std::move(work)](const Progress& progress) -> Finish {
              std::string said;
              painter
                  ->change([&](Canvas& canvas) {
                      const std::lock_guard lock(held_->mutex);
                      said = work(held_->treatment, canvas, progress);
                  })
                  .get();
              Facts facts = facts_of(treatment(), canvas_of(*painter));
              return [this, said = std::move(said), facts = std::move(facts)]() mutable {
                  state_.treatment_state.state.reset();
                  state_shown_.reset();
                  state_.treatment_state.map = false;  // what was done is to be seen
                  state_.comparing.pair.reset();       // pictures of what was before
                  state_.comparing.on = state_.comparing.loaded && state_.comparing.on;
                  adopt(std::move(facts));
                  setup_.say(said);
              };
          });
}

void TreatmentController::fill() {
    const TreatmentState& t = state_.treatment_state;
    const Filling filling{t.texture, Transfer{Transfer::Kind::srgb}.decode(t.fill_srgb), t.fill};
    step("filling", [where = t.where, filling, who = author()](Treatment& treatment, Canvas& canvas,
                                                               const Progress& progress) {
        const json result =
            fill_step(treatment, canvas, area_of_classes(treatment, where), filling, who, progress);
        const StatedLength deepest = stated_length(result, "deepest");
        return fmt::format("in the log: {}, {}, {:.2f}{} at its deepest; step at its border {:.3f}{} rms{}",
                           result["layer"].get<std::string>(), area_in_words(result),
                           deepest.value.get<double>(), deepest.unit,
                           stated_length(result, "border_rms").value.get<double>(), deepest.unit,
                           all_of_warnings(result));
    });
}

void TreatmentController::varnish(bool isolating) {
    const TreatmentState& t = state_.treatment_state;
    step(isolating ? "isolating" : "varnishing",
         [isolating, where = t.where, options = isolating ? t.isolating : t.varnish, who = author()](
             Treatment& treatment, Canvas& canvas, const Progress& progress) {
             const StepArea area = area_of_classes(treatment, where);
             const json result = varnish_step(
                 treatment, canvas, {isolating, isolating ? &area : nullptr, options}, who, progress);
             return fmt::format("in the log: {}, {}{}", result["layer"].get<std::string>(),
                                area_in_words(result), all_of_warnings(result));
         });
}

void TreatmentController::remove(const std::vector<std::string>& layers) {
    step("taking off",
         [layers, who = author()](Treatment& treatment, Canvas& canvas, const Progress& progress) {
             remove_step(treatment, canvas, layers, who, progress);
             std::string said = fmt::format("in the log: {} taken off", fmt::join(layers, ", "));
             if (canvas.dried().empty() && sha256_of(*tangi::shown(canvas)) == treatment.dry_sha256())
                 said += "; the painting is the original again, bit for bit";
             return said;
         });
}

void TreatmentController::undo_last() {
    if (state_.treatment_state.edits > 0) {
        setup_.say("first enter the corrections of the map in the log, or drop them");
        return;
    }
    step("undoing a step", [who = author()](Treatment& treatment, Canvas& canvas, const Progress& progress) {
        const json done = undo_step(treatment, canvas, who, progress);
        const json& back = done["brought_back"];
        return fmt::format("in the log: {} of line {} undone{}", done["undone"]["action"].get<std::string>(),
                           done["undone"]["line"].get<int>(),
                           back.empty() ? ""
                                        : fmt::format("; {} on the painting again",
                                                      fmt::join(back.get<std::vector<std::string>>(), ", ")));
    });
}

// Lays it on a copy of what there is; `shown`: what the panel says of it.
TreatmentController::Preview TreatmentController::laid(const Laying& laying, const Treatment& now,
                                                       Canvas canvas, ShownRetouch& shown,
                                                       const Progress& progress) {
    const std::vector<Pigment>& paints = laying.palette.paints;
    StepArea area = area_of_classes(now, laying.where);
    canvas.confine({});
    const std::string layer = now.new_layer_name(LayerRole::retouch);
    const RetouchReport report = lay_retouch(canvas, laying.palette, area.mask, damaged(now),
                                             {laying.mode, layer, laying.options}, progress);
    json results = in_known_units(to_json(report, paints, laying.pairs), now);
    results["layer"] = layer;
    count_beside(results, now, canvas.dried().back(), area.mask);
    shown.made_with = laying.made_with;
    shown.mode = name_of(laying.mode);
    shown.delta_e = report.delta_e_mean;
    shown.outside_px = results["on_original"]["pixels"].get<int>();
    for (const Pile& pile : report.piles)
        shown.piles.push_back(fmt::format("{:2.0f} %  {}", 100 * pile.share, text_of(pile.steps, paints)));
    if (report.marks > 0) {
        const double mm = canvas.mm_per_pixel();
        const RetouchViews views = retouch_views(diffuse_in(canvas, canvas.region()), area.mask, report);
        const Fusion fusion = fusion_of(views.retouched, views.target, views.mask, report.pitch_mm / mm, mm);
        results["lines"].update(to_json(fusion));
        shown.lines = lines_in_words(report, fusion);
    }
    json parameters = parameters_of(laying.mode, laying.options);
    parameters["area"] = area.described, parameters["palette"] = laying.palette.name;
    return {std::move(canvas), std::move(area), std::move(parameters), std::move(results), layer};
}

void TreatmentController::preview() {
    TreatmentState& t = state_.treatment_state;
    if (state_.painter.unsaved) {
        setup_.say("first record what was painted: Ctrl+S");
        return;
    }
    t.state.reset();
    Laying laying{.mode = t.mode,
                  .options = retouch_options(),
                  .where = t.where,
                  .palette = setup_.palette,
                  .list = pairs_,
                  .pairs = pairs_to_avoid(setup_.palette.paints, *pairs_),
                  .made_with = preview_made_with()};
    start("laying a retouch to look at",
          [this, painter = painter_, laying = std::move(laying)](const Progress& progress) -> Finish {
              const Treatment now = treatment();
              ShownRetouch shown;
              auto made =
                  std::make_shared<const Preview>(laid(laying, now, canvas_of(*painter), shown, progress));
              return [this, made, shown = std::move(shown)]() mutable {
                  preview_ = made;
                  state_.treatment_state.preview = std::move(shown);
                  state_.treatment_state.map = false;
                  painter_->show_as([made](const Canvas&) { return made->canvas; });
              };
          });
}

void TreatmentController::apply() {
    if (job_) {
        setup_.say(fmt::format("first stop, or wait for: {}", job_->title()));
        return;
    }
    if (state_.treatment_state.preview->made_with != preview_made_with()) {
        setup_.say("the settings have been changed since the retouch was laid: preview it again");
        return;
    }
    const auto made = std::exchange(preview_, {});
    state_.treatment_state.preview.reset();
    painter_->show_as({});
    step("entering the retouch in the log", [made, who = author()](Treatment& treatment, Canvas& canvas,
                                                                   const Progress& progress) {
        if (!goes_on_from(canvas, made->canvas))
            fail("the painting has changed since the retouch was laid: preview it again");
        canvas = made->canvas;
        treatment.record({.action = "retouch",
                          .parameters = made->parameters,
                          .results = made->results,
                          .masks = {{made->layer, made->area.mask}},
                          .canvas = &canvas,
                          .added = {{made->layer, LayerRole::retouch}}},
                         who, progress);
        return fmt::format("in the log: {} ({})", made->layer, made->parameters["mode"].get<std::string>());
    });
}

// A report is of what is in the log: says what is not.
bool TreatmentController::all_is_logged() {
    if (state_.left_over_strokes > 0)
        setup_.say("first recover the strokes that were not saved, or put them aside: no report has them");
    else if (state_.painter.unsaved)
        setup_.say("first record what was painted: Ctrl+S; no report has it before");
    else if (state_.treatment_state.edits > 0)
        setup_.say(
            "first enter the corrections of the map in the log (Ctrl+K), or drop them: no report has them "
            "before");
    else
        return true;
    return false;
}

void TreatmentController::report(const fs::path& html) {
    start("writing the report", [this, html, tool = setup_.author.tool](const Progress& progress) -> Finish {
        const auto files = write_treatment_report(treatment(), html, tool, progress);
        return [this, html, count = files.size()] {
            setup_.say(fmt::format("wrote {} and {} files beside it", html.string(), count - 1));
        };
    });
}

}  // namespace tangi
