// treatment_labels.cpp: how things of a treatment are called in the window.
#include "viewer/treatment/treatment_controller.h"

namespace tangi {

namespace {

bool is_small(char c) { return c >= 'a' && c <= 'z'; }

}  // namespace

std::string in_panel_words(const std::string& text) {
    if (text.find("tangipaint ") != std::string::npos) return text;  // a whole command
    std::string words;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool begins = i == 0 || text[i - 1] == ' ';
        if (!begins || text.compare(i, 2, "--") != 0 || i + 2 == text.size() || !is_small(text[i + 2])) {
            words += text[i];
            continue;
        }
        for (i += 2; i < text.size() && (is_small(text[i]) || text[i] == '-'); ++i)
            words += text[i] == '-' ? ' ' : text[i];
        --i;
    }
    return words;
}

std::string TreatmentController::no_strokes() const {
    const TreatmentState& t = state_.treatment_state;
    if (!t.on) return {};
    if (gone_) return "the treatment's folder is not where it was: put it back, or open it anew";
    if (t.checking) return "the treatment is being checked";
    if (!t.usable) return "the treatment is not as its log says: see Record";
    if (t.preview) return "apply the retouch that is previewed, or put it aside, before you paint";
    if (t.state) return "a state of the treatment is shown: choose Now before you paint";
    if (confine_due_ || refresh_due_ || (job_ && job_is_ours_)) return "the mask is being made ready";
    if (t.confined && t.where.empty()) return "choose the damage that is retouched: Steps, Area";
    const bool mapped = std::any_of(t.damage.begin(), t.damage.end(), [&](const DamageRow& row) {
        return row.there && t.where.contains(row.damage);
    });
    if (t.confined && !mapped) return "no such damage is on the map yet: suggest or draw it, panel Damage";
    return {};
}

const char* title_of(DamageClass damage) {
    constexpr std::array<const char*, kDamageClasses.size()> titles = {
        "Loss to ground", "Loss to support", "Abrasion",  "Craquelure",
        "Flaking",        "Old fill",        "Overpaint", "Stain"};
    return titles[static_cast<std::size_t>(damage)];
}

const char* title_of(LayerRole role) {
    constexpr std::array<const char*, 4> titles = {"fill", "isolating varnish", "retouch", "varnish"};
    return titles[static_cast<std::size_t>(role)];
}

const char* title_of(TreatmentStage state) {
    constexpr std::array<const char*, 5> titles = {"Before", "Cleaned", "Filled", "Retouched", "Varnished"};
    return titles[static_cast<std::size_t>(state)];
}

}  // namespace tangi
