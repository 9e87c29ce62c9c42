// treatment_words.cpp: how things of a treatment are called in the window.
#include "viewer/treatment_desk.h"

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

const char* title_of(TreatmentState state) {
    constexpr std::array<const char*, 5> titles = {"Before", "Cleaned", "Filled", "Retouched", "Varnished"};
    return titles[static_cast<std::size_t>(state)];
}

}  // namespace tangi
