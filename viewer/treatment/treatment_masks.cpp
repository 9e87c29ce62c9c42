// treatment_masks.cpp: of the treatment: damage that is drawn, and suggested.
#include <fmt/format.h>

#include <algorithm>

#include "retouch/treatment/treatment_area.h"
#include "surface/base/error.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

using nlohmann::json;

namespace {

// [1] Regions that are less sure are not even offered.
constexpr double kLeastSure = 0.2;

const char* name_of(MaskTool tool) {
    constexpr std::array<const char*, 4> names = {"brush", "polygon", "wand", "area"};
    return names[static_cast<std::size_t>(tool)];
}

DamageClass area_class_of(Suggesting what) {
    switch (what) {
        case Suggesting::old_fill:
            return DamageClass::old_fill;
        case Suggesting::overpaint:
            return DamageClass::overpaint;
        case Suggesting::stain:
            return DamageClass::stain;
        case Suggesting::flaking:
            return DamageClass::flaking;
        default:
            return DamageClass::abrasion;
    }
}

std::vector<double> mean_confidence(const MaskRegions& regions, const Image<float>& confidence) {
    std::vector<double> sum(regions.regions.size());
    for (std::size_t i = 0; i < confidence.size(); ++i)
        if (const int number = regions.number.pixels()[i]; number > 0)
            sum[static_cast<std::size_t>(number - 1)] += static_cast<double>(confidence.pixels()[i]);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(regions.regions[i].pixels, 1);
    return sum;
}

}  // namespace

// That of the class that is drawn: begun with what the class has.
MaskDraft& TreatmentController::draft() {
    const DamageClass damage = state_.treatment_state.current;
    auto found = drafts_.find(damage);
    if (found == drafts_.end()) found = drafts_.emplace(damage, MaskDraft(treatment().mask(damage))).first;
    return found->second;
}

void TreatmentController::changed(const Region& region) {
    if (region.empty()) return;
    const DamageClass damage = state_.treatment_state.current;
    map_.set(damage, drafts_.at(damage).mask(), region);
    const Region r = map_.compose(style_, region);
    map_changed_ = map_changed_.empty()
                       ? r
                       : Region{std::min(r.x0, map_changed_.x0), std::min(r.y0, map_changed_.y0),
                                std::max(r.x1, map_changed_.x1), std::max(r.y1, map_changed_.y1)};
    count_edits();
}

void TreatmentController::count_edits() {
    TreatmentState& t = state_.treatment_state;
    t.edits = 0;
    for (const auto& [damage, draft] : drafts_) t.edits += draft.actions();
    const auto own = drafts_.find(t.current);
    t.can_redo = own != drafts_.end() && own->second.can_redo();
    if (drafts_.empty())
        for (DamageRow& row : t.damage) row.corrected.reset();
    else if (!last_)  // not at each place of a brush: a large map takes a while
        count_corrected();
}

void TreatmentController::touch(const MaskTouch& touch) {
    TreatmentState& t = state_.treatment_state;
    if (!t.usable) return;
    t.map = t.damage[static_cast<std::size_t>(t.current)].shown = true;  // else one would draw blindly
    t.additions = false;
    const MaskEdit edit = touch.erase ? MaskEdit::remove : MaskEdit::add;
    const double radius_px = 0.5 * static_cast<double>(t.brush_mm) / t.mm_per_pixel;
    switch (touch.kind) {
        case MaskTouch::Kind::press:
            if (last_) draft().end();
            draft().begin();
            last_ = touch.at;
            changed(draft().draw(touch.at, touch.at, radius_px, edit));
            break;
        case MaskTouch::Kind::drag:
            if (!last_) break;
            changed(draft().draw(*last_, touch.at, radius_px, edit));
            last_ = touch.at;
            break;
        case MaskTouch::Kind::release:
            if (!last_) break;
            draft().end();
            last_.reset();
            count_edits();
            break;
        case MaskTouch::Kind::polygon:
            polygon(touch.polygon, edit);
            break;
        case MaskTouch::Kind::wand:
            wand_at(touch);
            break;
        case MaskTouch::Kind::area: {
            MaskDraft& mask = draft();
            const Mask area = connected_at(mask.mask(), static_cast<int>(std::floor(touch.at.x)),
                                           static_cast<int>(std::floor(touch.at.y)));
            if (area.empty()) {
                setup_.say(fmt::format("nothing of '{}' lies there", title_of(t.current)));
                break;
            }
            mask.begin();
            const Region region = mask.combine(area, MaskEdit::remove);
            mask.end();
            changed(region);
            break;
        }
    }
}

void TreatmentController::polygon(const Polygon& corners, MaskEdit edit) {
    MaskDraft& mask = draft();
    Mask area;
    try {
        area = mask_of_polygons({corners}, mask.mask().width(), mask.mask().height());
    } catch (const Error& error) {
        setup_.say(error.what());
        return;
    }
    mask.begin();
    const Region region = mask.combine(area, edit);
    mask.end();
    if (region.empty()) setup_.say("the polygon encloses no pixel by half or more: nothing is drawn");
    changed(region);
}

void TreatmentController::wand_at(const MaskTouch& touch) {
    const TreatmentState& t = state_.treatment_state;
    const int x = static_cast<int>(touch.at.x), y = static_cast<int>(touch.at.y);
    const auto tolerance = static_cast<double>(t.tolerance[static_cast<std::size_t>(t.wand_by)]);
    start("the wand",
          [this, dry = painter_->dry(), x, y, by = t.wand_by, tolerance, erase = touch.erase,
           damage = t.current](const Progress&) -> Finish {
              Mask area = wand(*dry, x, y, by, tolerance);
              return [this, area = std::move(area), erase, damage] {
                  state_.treatment_state.current = damage;
                  MaskDraft& mask = draft();
                  mask.begin();
                  const Region region = mask.combine(area, erase ? MaskEdit::remove : MaskEdit::add);
                  mask.end();
                  changed(region);
              };
          });
}

// Of the class that is drawn, as the legend has it.
void TreatmentController::count_corrected() {
    const DamageClass damage = state_.treatment_state.current;
    DamageRow& row = *std::ranges::find(state_.treatment_state.damage, damage, &DamageRow::damage);
    const auto own = drafts_.find(damage);
    row.corrected.reset();
    if (own == drafts_.end() || !own->second.can_undo()) return;
    const MaskArea area = area_of(own->second.mask(), state_.treatment_state.mm_per_pixel);
    row.corrected = {area.regions, area.mm2 / 100, area.percent};
}

// Each class that was corrected is a step.
void TreatmentController::keep_edits() {
    const TreatmentState& t = state_.treatment_state;
    std::vector<std::pair<DamageClass, MaskDraft>> edited;
    for (const auto& [damage, draft] : drafts_) {
        if (!draft.can_undo()) continue;
        if (state_.painter.unsaved && t.where.contains(damage)) {
            setup_.say("first record what was painted there: Ctrl+S");
            return;
        }
        edited.emplace_back(damage, draft);
    }
    const std::string under_way =
        t.polygon.empty() ? ""
                          : "the polygon under way is not closed, and not part of it: Enter closes it, Esc "
                            "drops it";
    if (edited.empty() && !under_way.empty()) setup_.say("nothing is in the log yet: " + under_way);
    if (edited.empty()) return;
    start("entering the damage in the log",
          [this, under_way, edited = std::move(edited), who = author(), painter = painter_,
           tool = std::string(name_of(t.mask_tool))](const Progress& progress) -> Finish {
              {
                  const std::lock_guard lock(held_->mutex);
                  for (const auto& [damage, draft] : edited)
                      draw_step(held_->treatment, damage, draft.mask(),
                                {{"edit", "by hand"}, {"edits", draft.actions()}, {"last_tool", tool}}, who,
                                {}, progress);
              }
              Facts facts = facts_of(treatment(), canvas_of(*painter));
              return [this, under_way, facts = std::move(facts)]() mutable {
                  drafts_.clear();
                  count_edits();
                  adopt(std::move(facts));
                  setup_.say("the damage map is in the log" + (under_way.empty() ? "" : "; " + under_way));
              };
          });
}

void TreatmentController::keep_now() {
    if (!held_ || state_.treatment_state.edits == 0) return;
    try {
        const std::lock_guard lock(held_->mutex);
        while (!drafts_.empty()) {
            const auto& [damage, draft] = *drafts_.begin();
            if (draft.can_undo())
                draw_step(held_->treatment, damage, draft.mask(),
                          {{"edit", "by hand"}, {"edits", draft.actions()}}, author());
            drafts_.erase(drafts_.begin());
        }
    } catch (const Error& error) {
        setup_.say(error.what());
    }
    count_edits();
}

void TreatmentController::drop_edits() {
    last_.reset();
    for (const auto& [damage, draft] : std::exchange(drafts_, {})) map_.set(damage, treatment().mask(damage));
    map_changed_ = map_.compose(style_);
    count_edits();
}

void TreatmentController::suggest_areas_into(Suggested& s, ShownSuggestion& shown, DamageClass damage,
                                             const Surface& dry, double mm, AreaOptions options,
                                             const Progress& progress) {
    options.area_confidence = std::min(options.area_confidence, kLeastSure);  // the slider goes on from there
    AreaSuggestion areas = tangi::suggest_areas(dry, mm, damage, options, progress);
    s.action = name_of(damage);
    s.options = to_json(options);
    shown.title = title_of(damage);
    shown.as = damage;
    if (!areas.areas.empty()) {
        const SuggestedArea& surest = areas.areas.front();
        shown.measured = fmt::format("the surest: {}", surest.cues);
        if (areas.weak > 0)
            shown.measured += fmt::format("; {} of {} rest on weak evidence", areas.weak, areas.areas.size());
    }
    s.best = std::move(areas);
}

void TreatmentController::suggest() {
    TreatmentState& t = state_.treatment_state;
    const Suggesting what = t.suggesting;
    constexpr std::array<const char*, 8> titles = {
        "looking for losses",    "looking for craquelure", "looking for other gloss", "looking for old fills",
        "looking for overpaint", "looking for stains",     "looking for abrasion",    "looking for flaking"};
    const auto& title = titles[static_cast<std::size_t>(what)];
    start(title,
          [this, what, made_with = suggestion_made_with(what), dry = painter_->dry(), mm = t.mm_per_pixel,
           known = t.scale_known, loss = t.loss, craquelure = t.craquelure, gloss = t.gloss,
           areas = t.areas](const Progress& progress) -> Finish {
              Suggested s;
              ShownSuggestion shown;
              shown.what = what;
              shown.made_with = made_with;
              s.mm_per_pixel = mm;
              if (what == Suggesting::loss) {
                  LossOptions options = loss;
                  options.confidence =
                      std::min(options.confidence, kLeastSure);  // the slider goes on from there
                  s.action = "loss";
                  s.options = to_json(options);
                  s.best = suggest_loss(*dry, mm, options, progress);
                  shown.title = "Losses";
                  shown.as = DamageClass::loss_to_ground;
              } else if (what == Suggesting::craquelure) {
                  CraquelureSuggestion cracks = suggest_craquelure(*dry, mm, craquelure, progress);
                  s.action = "craquelure";
                  s.options = to_json(craquelure);
                  shown.title = "Craquelure";
                  shown.as = DamageClass::craquelure;
                  shown.measured = in_words(cracks.measure, mm, known);
                  s.results["measured"] = as_stated(cracks.measure, mm, known);
                  s.best = std::move(cracks);
              } else if (what != Suggesting::gloss) {
                  suggest_areas_into(s, shown, area_class_of(what), *dry, mm, areas, progress);
              } else {
                  GlossSuggestion patches = suggest_gloss(*dry, mm, gloss, progress);
                  s.action = "gloss";
                  s.options = to_json(gloss);
                  shown.title = "Matter patches";
                  shown.as = DamageClass::overpaint;
                  shown.measured =
                      fmt::format("{} patches, glossier ones among them", patches.patches.size());
                  s.further.emplace_back("glossier", std::move(patches.glossier));
                  s.best = std::move(patches.matter);
              }
              s.regions = regions_of(s.best.mask);
              s.confidence = mean_confidence(s.regions, s.best.confidence);
              shown.regions = static_cast<int>(s.confidence.size());
              // All of them, where the measure of confidence is not the one that losses have.
              if (what == Suggesting::craquelure || what == Suggesting::gloss) shown.threshold = 0;
              return [this, s = std::move(s), shown = std::move(shown)]() mutable {
                  suggested_ = std::move(s);
                  state_.treatment_state.suggestion = std::move(shown);
                  state_.treatment_state.map = true;
                  state_.treatment_state.additions = false;
                  show_suggestion();
                  if (state_.treatment_state.suggestion->regions == 0)
                      setup_.say(
                          "nothing that looks like it was found; the numbers below say how it is looked for");
              };
          });
}

// Regions whose mean confidence reaches the threshold.
Mask TreatmentController::sure_enough() const {
    const auto threshold = static_cast<double>(state_.treatment_state.suggestion->threshold);
    Mask mask(suggested_->best.mask.width(), suggested_->best.mask.height());
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const int number = suggested_->regions.number.pixels()[i];
        if (number > 0 && suggested_->confidence[static_cast<std::size_t>(number - 1)] >= threshold)
            mask.pixels()[i] = 1;
    }
    return mask;
}

void TreatmentController::show_suggestion() {
    ShownSuggestion& shown = *state_.treatment_state.suggestion;
    threshold_ = shown.threshold;
    const Mask mask = sure_enough();
    shown.shown = static_cast<int>(
        std::count_if(suggested_->confidence.begin(), suggested_->confidence.end(),
                      [&](double sure) { return sure >= static_cast<double>(shown.threshold); }));
    shown.area_cm2 = area_of(mask, suggested_->mm_per_pixel).mm2 / 100;
    map_.set_suggestion(mask);
    map_changed_ = map_.compose(style_);
}

// What was suggested takes the place of what the class has, as the log says.
void TreatmentController::accept() {
    const ShownSuggestion shown = *state_.treatment_state.suggestion;
    if (shown.made_with != suggestion_made_with(shown.what)) {
        setup_.say("how it is looked for has been changed since: suggest again");
        return;
    }
    if (shown.shown == 0) {
        setup_.say("nothing was found to accept; what is mapped stays");
        return;
    }
    if (const auto drawn = drafts_.find(shown.as); drawn != drafts_.end() && drawn->second.can_undo()) {
        setup_.say(
            fmt::format("first enter the corrections of '{}' in the log, or drop them", title_of(shown.as)));
        return;
    }
    TreatmentStep step{.action = "suggest damage",
                       .parameters = {{"suggest", suggested_->action},
                                      {"options", suggested_->options},
                                      {"threshold", shown.threshold}},
                       .results = suggested_->results};
    const bool known = state_.treatment_state.scale_known;
    const auto keep = [&](const std::string& name, const Mask& mask, const Image<float>& confidence) {
        const MaskArea area = area_of(mask, suggested_->mm_per_pixel);
        step.masks[name] = mask;
        step.masks[name + ".confidence"] = confidence;
        step.results[name] = area_of_step(area.mm2, suggested_->mm_per_pixel, known);
        step.results[name]["count"] = area.regions, step.results[name]["percent"] = area.percent;
    };
    keep(std::string(name_of(shown.as)), sure_enough(), suggested_->best.confidence);
    for (const auto& [name, further] : suggested_->further) keep(name, further.mask, further.confidence);
    start("entering the damage in the log",
          [this, step = std::move(step), who = author(), painter = painter_,
           as = shown.as](const Progress& progress) -> Finish {
              {
                  const std::lock_guard lock(held_->mutex);
                  held_->treatment.record(step, who, progress);
              }
              Facts facts = facts_of(treatment(), canvas_of(*painter));
              return [this, as, facts = std::move(facts)]() mutable {
                  suggested_.reset();
                  state_.treatment_state.suggestion.reset();
                  map_.set_suggestion({});
                  drafts_.erase(as);
                  state_.treatment_state.current = as;
                  adopt(std::move(facts));
                  setup_.say(fmt::format("in the log: {}", title_of(as)));
              };
          });
}

}  // namespace tangi
