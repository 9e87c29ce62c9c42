// treatment_settings.cpp: of the treatment: what results are made with, by which it is seen that they are
// stale.
#include <algorithm>

#include "retouch/inpaint/recipe_json.h"
#include "surface/base/json_text.h"
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

using nlohmann::json;

std::vector<Illuminant> TreatmentController::illuminants_that_count() const {
    const auto& counts = state_.treatment_state.illuminants;
    std::vector<Illuminant> illuminants;
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (counts[i]) illuminants.push_back(static_cast<Illuminant>(i));
    return illuminants;
}

RetouchOptions TreatmentController::retouch_options() const {
    const TreatmentState& t = state_.treatment_state;
    RetouchOptions options = t.retouch;
    options.match.max_paints = t.most_paints;
    options.match.illuminants = illuminants_that_count();
    if (options.match.illuminants.empty()) options.match.illuminants = {Illuminant::d65};
    if (t.avoid_pairs)
        options.match.allowed =
            without_pairs(setup_.palette.paints.size(), pairs_to_avoid(setup_.palette.paints, *pairs_));
    return options;
}

// The paints, the damage that is worked on, and the treatment as its log has it.
json TreatmentController::made_on() const {
    const TreatmentState& t = state_.treatment_state;
    json on = {{"palette", setup_.palette.name}, {"pairs", json::array()}};
    for (const Pigment& paint : setup_.palette.paints) on["paints"].push_back(paint.name);
    for (const DamageClass damage : t.where) on["where"].push_back(name_of(damage));
    if (t.avoid_pairs)
        for (const PigmentPair& pair : *pairs_) on["pairs"].push_back({pair.first, pair.second});
    on["log"] = t.log.empty() ? "" : t.log.front().sha256;
    return on;
}

std::string TreatmentController::preview_made_with() const {
    json with = made_on();
    with["retouch"] = parameters_of(state_.treatment_state.mode, retouch_options());
    return json_line(with);
}

std::string TreatmentController::match_made_with() const {
    const TreatmentState& t = state_.treatment_state;
    json with = made_on();
    with["paints_at_most"] = t.most_paints;
    for (const Illuminant one : illuminants_that_count()) with["illuminants"].push_back(name_of(one));
    if (t.film) with["film_mm"] = t.retouch.thickness_mm;
    return json_line(with);
}

std::string TreatmentController::suggestion_made_with(Suggesting what) const {
    const TreatmentState& t = state_.treatment_state;
    if (what == Suggesting::loss) return json_line(to_json(t.loss));
    if (what == Suggesting::craquelure) return json_line(to_json(t.craquelure));
    if (what == Suggesting::gloss) return json_line(to_json(t.gloss));
    return json_line(to_json(t.areas));
}

// What was made with other settings than there are now is not laid, taken over or taken up unseen.
void TreatmentController::find_stale() {
    TreatmentState& t = state_.treatment_state;
    if (t.preview) t.preview->stale = t.preview->made_with != preview_made_with();
    if (t.suggestion)
        t.suggestion->stale = t.suggestion->made_with != suggestion_made_with(t.suggestion->what);
    if (t.match) t.match->stale = t.match->made_with != match_made_with();
}

}  // namespace tangi
