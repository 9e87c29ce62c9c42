// treatment_settings.cpp: of the treatment: what results are made with, by which it is seen that they are
// stale.
#include <algorithm>

#include "retouch/inpaint/recipe_json.h"
#include "viewer/treatment/treatment_desk.h"

namespace tangi {

using nlohmann::json;

std::vector<Illuminant> TreatmentDesk::lamps_that_count() const {
    std::vector<Illuminant> lamps;
    for (std::size_t lamp = 0; lamp < state_.treating.lamps.size(); ++lamp)
        if (state_.treating.lamps[lamp]) lamps.push_back(static_cast<Illuminant>(lamp));
    return lamps;
}

RetouchOptions TreatmentDesk::retouch_options() const {
    const Treating& t = state_.treating;
    RetouchOptions options = t.retouch;
    options.match.max_paints = t.most_paints;
    options.match.lamps = lamps_that_count();
    if (options.match.lamps.empty()) options.match.lamps = {Illuminant::d65};
    if (t.avoid_pairs)
        options.match.allowed =
            without_pairs(setup_.palette.paints.size(), pairs_to_avoid(setup_.palette.paints, *pairs_));
    return options;
}

// The paints, the damage that is worked on, and the treatment as its log has it.
json TreatmentDesk::made_on() const {
    const Treating& t = state_.treating;
    json on = {{"palette", setup_.palette.name}, {"pairs", json::array()}};
    for (const Pigment& paint : setup_.palette.paints) on["paints"].push_back(paint.name);
    for (const DamageClass damage : t.where) on["where"].push_back(name_of(damage));
    if (t.avoid_pairs)
        for (const PigmentPair& pair : *pairs_) on["pairs"].push_back({pair.first, pair.second});
    on["log"] = t.log.empty() ? "" : t.log.front().sha256;
    return on;
}

std::string TreatmentDesk::preview_made_with() const {
    json with = made_on();
    with["retouch"] = parameters_of(state_.treating.mode, retouch_options());
    return with.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string TreatmentDesk::match_made_with() const {
    const Treating& t = state_.treating;
    json with = made_on();
    with["paints_at_most"] = t.most_paints;
    for (const Illuminant lamp : lamps_that_count()) with["lamps"].push_back(name_of(lamp));
    if (t.film) with["film_mm"] = t.retouch.thickness_mm;
    return with.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string TreatmentDesk::suggestion_made_with(Suggesting what) const {
    const Treating& t = state_.treating;
    if (what == Suggesting::loss) return to_json(t.loss).dump();
    if (what == Suggesting::craquelure) return to_json(t.craquelure).dump();
    if (what == Suggesting::gloss) return to_json(t.gloss).dump();
    return to_json(t.areas).dump();
}

// What was made with other settings than there are now is not laid, taken over or taken up unseen.
void TreatmentDesk::find_stale() {
    Treating& t = state_.treating;
    if (t.preview) t.preview->stale = t.preview->made_with != preview_made_with();
    if (t.suggestion)
        t.suggestion->stale = t.suggestion->made_with != suggestion_made_with(t.suggestion->what);
    if (t.match) t.match->stale = t.match->made_with != match_made_with();
}

}  // namespace tangi
