// treatment_suggestions.cpp: of the treatment: damage that is suggested, and accepted.
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

const char* search_title(Suggesting what) {
    constexpr std::array<const char*, 8> titles = {
        "looking for losses",    "looking for craquelure", "looking for other gloss", "looking for old fills",
        "looking for overpaint", "looking for stains",     "looking for abrasion",    "looking for flaking"};
    return titles[static_cast<std::size_t>(what)];
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

TreatmentController::Search TreatmentController::search_of(Suggesting what) const {
    const TreatmentState& t = state_.treatment_state;
    return {.what = what,
            .made_with = suggestion_made_with(what),
            .dry = painter_->dry(),
            .mm_per_pixel = t.mm_per_pixel,
            .scale_known = t.scale_known,
            .loss = t.loss,
            .craquelure = t.craquelure,
            .gloss = t.gloss,
            .areas = t.areas};
}

void TreatmentController::find_losses(const Search& search, Found& found, const Progress& progress) {
    LossOptions options = search.loss;
    options.confidence = std::min(options.confidence, kLeastSure);  // the slider goes on from there
    found.suggested.action = "loss";
    found.suggested.options = to_json(options);
    found.suggested.best = suggest_loss(*search.dry, search.mm_per_pixel, options, progress);
    found.shown.title = "Losses";
    found.shown.as = DamageClass::loss_to_ground;
}

void TreatmentController::find_craquelure(const Search& search, Found& found, const Progress& progress) {
    const double mm = search.mm_per_pixel;
    CraquelureSuggestion cracks = suggest_craquelure(*search.dry, mm, search.craquelure, progress);
    found.suggested.action = "craquelure";
    found.suggested.options = to_json(search.craquelure);
    found.shown.title = "Craquelure";
    found.shown.as = DamageClass::craquelure;
    found.shown.measured = in_words(cracks.measure, mm, search.scale_known);
    found.suggested.results["measured"] = as_stated(cracks.measure, mm, search.scale_known);
    found.suggested.best = std::move(cracks);
}

void TreatmentController::find_areas(const Search& search, Found& found, const Progress& progress) {
    const DamageClass damage = area_class_of(search.what);
    AreaOptions options = search.areas;
    options.area_confidence = std::min(options.area_confidence, kLeastSure);  // the slider goes on from there
    AreaSuggestion areas = suggest_areas(*search.dry, search.mm_per_pixel, damage, options, progress);
    found.suggested.action = name_of(damage);
    found.suggested.options = to_json(options);
    found.shown.title = title_of(damage);
    found.shown.as = damage;
    if (!areas.areas.empty()) {
        const SuggestedArea& surest = areas.areas.front();
        found.shown.measured = fmt::format("the surest: {}", surest.cues);
        if (areas.weak > 0)
            found.shown.measured +=
                fmt::format("; {} of {} rest on weak evidence", areas.weak, areas.areas.size());
    }
    found.suggested.best = std::move(areas);
}

void TreatmentController::find_gloss(const Search& search, Found& found, const Progress& progress) {
    GlossSuggestion patches = suggest_gloss(*search.dry, search.mm_per_pixel, search.gloss, progress);
    found.suggested.action = "gloss";
    found.suggested.options = to_json(search.gloss);
    found.shown.title = "Matter patches";
    found.shown.as = DamageClass::overpaint;
    found.shown.measured = fmt::format("{} patches, glossier ones among them", patches.patches.size());
    found.suggested.further.emplace_back("glossier", std::move(patches.glossier));
    found.suggested.best = std::move(patches.matter);
}

TreatmentController::Found TreatmentController::found_by(const Search& search, const Progress& progress) {
    Found found;
    found.shown.what = search.what;
    found.shown.made_with = search.made_with;
    found.suggested.mm_per_pixel = search.mm_per_pixel;
    switch (search.what) {
        case Suggesting::loss:
            find_losses(search, found, progress);
            break;
        case Suggesting::craquelure:
            find_craquelure(search, found, progress);
            break;
        case Suggesting::gloss:
            find_gloss(search, found, progress);
            break;
        default:
            find_areas(search, found, progress);
            break;
    }
    Suggested& s = found.suggested;
    s.regions = regions_of(s.best.mask);
    s.confidence = mean_confidence(s.regions, s.best.confidence);
    found.shown.regions = static_cast<int>(s.confidence.size());
    // All of them, where the measure of confidence is not the one that losses have.
    if (search.what == Suggesting::craquelure || search.what == Suggesting::gloss) found.shown.threshold = 0;
    return found;
}

void TreatmentController::suggest() {
    const Suggesting what = state_.treatment_state.suggesting;
    start(search_title(what), [this, search = search_of(what)](const Progress& progress) -> Finish {
        return [this, found = found_by(search, progress)]() mutable {
            suggested_ = std::move(found.suggested);
            state_.treatment_state.suggestion = std::move(found.shown);
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
