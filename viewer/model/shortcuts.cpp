#include "viewer/model/shortcuts.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace {

constexpr int kMods = GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT;

struct KeyName {
    const char* name;
    int key;
};
constexpr std::array<KeyName, 19> kKeyNames = {{{"Space", GLFW_KEY_SPACE},
                                                {"Tab", GLFW_KEY_TAB},
                                                {"Enter", GLFW_KEY_ENTER},
                                                {"Escape", GLFW_KEY_ESCAPE},
                                                {"Backspace", GLFW_KEY_BACKSPACE},
                                                {"Delete", GLFW_KEY_DELETE},
                                                {"Insert", GLFW_KEY_INSERT},
                                                {"Home", GLFW_KEY_HOME},
                                                {"End", GLFW_KEY_END},
                                                {"PageUp", GLFW_KEY_PAGE_UP},
                                                {"PageDown", GLFW_KEY_PAGE_DOWN},
                                                {"Left", GLFW_KEY_LEFT},
                                                {"Right", GLFW_KEY_RIGHT},
                                                {"Up", GLFW_KEY_UP},
                                                {"Down", GLFW_KEY_DOWN},
                                                {"Comma", GLFW_KEY_COMMA},
                                                {"Period", GLFW_KEY_PERIOD},
                                                {"Plus", GLFW_KEY_EQUAL},
                                                {"Minus", GLFW_KEY_MINUS}}};

bool same_word(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char x, char y) { return std::tolower(x) == std::tolower(y); });
}

int key_named(std::string_view text) {
    for (const KeyName& named : kKeyNames)
        if (same_word(text, named.name)) return named.key;
    if (text.size() == 1 && (std::isalnum(static_cast<unsigned char>(text[0])) ||
                             std::string_view("[],.;'/\\`-=").find(text[0]) != std::string_view::npos))
        return std::toupper(static_cast<unsigned char>(text[0]));
    if (text.size() < 2 || std::toupper(static_cast<unsigned char>(text[0])) != 'F') return 0;
    for (int i = 1; i <= 25; ++i)
        if (text.substr(1) == std::to_string(i)) return GLFW_KEY_F1 + i - 1;
    return 0;
}

Chord checked_chord(const std::string& text, const std::string& where) {
    const auto chord = chord_named(text);
    if (!chord) fail("{}: '{}' is no key; keys are as in \"Ctrl+Shift+Z\", \"F5\", \"PageUp\"", where, text);
    return *chord;
}

// A class, so that the short names of actions hold within it only.
struct ShortcutTable {
    using enum Action;
    static constexpr auto kRows = std::to_array<Shortcut>(
        {{tool_tilt, "tool-tilt", "T", "Tilt: drag tilts the painting, the light stays"},
         {tool_light, "tool-light", "L", "Light: drag moves the light, as on a dome over the painting"},
         {tool_pan, "tool-pan", "H", "Pan: drag moves the painting"},
         {tool_paint, "tool-paint", "B",
          "Paint: drag; Ctrl-click takes a paint up, Shift-drag changes the size"},
         {tool_pick, "tool-pick", "I", "Pick: click mixes what lies there"},
         {tool_ruler, "tool-ruler", "M", "Ruler: drag measures, with the height along the line"},
         {tool_region, "tool-region", "G", "Region: drag chooses the part that statistics are of"},
         {tool_annotate, "tool-annotate", "A",
          "Annotate: click or drag draws; by keys, Enter sets points at a crosshair that arrows move"},
         {tool_damage, "tool-damage", "K", "Damage: brush, polygon or wand on the damage map; Ctrl erases"},
         {tool_sample, "tool-match", "U", "Match: click finds recipes for the colour there"},
         {fit, "fit", "F", "the whole painting in the window"},
         {one_to_one, "one-to-one", "1", "a pixel of the painting as one of the screen"},
         {straighten, "straighten", "R", "straighten"},
         {turn_left, "turn-left", "Comma", "turn by 15°"},
         {turn_right, "turn-right", "Period", "the other way"},
         {light_left, "light-left", "Left", "light: azimuth"},
         {light_right, "light-right", "Right", "the other way"},
         {light_up, "light-up", "Up", "light: elevation"},
         {light_down, "light-down", "Down", "the other way"},
         {shadows, "shadows", "S", "shadows"},
         {illuminant, "illuminant", "J", "the next kind of light: daylight, incandescent, fluorescent, LED"},
         {loupe, "loupe", "O", "loupe"},
         {brush_smaller, "brush-smaller", "[", "smaller brush"},
         {brush_larger, "brush-larger", "]", "larger brush"},
         {dry, "dry", "D", "dry the wet paint"},
         {undo, "undo", "Ctrl+Z", "undo"},
         {redo, "redo", "Ctrl+Y Ctrl+Shift+Z", "redo"},
         {compare, "compare", "C", "compare with photographs, or not"},
         {compare_way, "compare-way", "V", "side by side, wipe, blink, difference, colour difference"},
         {next_photo, "next-photo", "PageDown", "next photograph"},
         {previous_photo, "previous-photo", "PageUp", "previous photograph"},
         {report, "report", "Ctrl+R", "report of the comparison with all photographs"},
         {annotation_kind, "annotation-kind", "Shift+A", "annotate with: point, line, polygon, text"},
         {next_annotation, "next-annotation", "Ctrl+PageDown", "next annotation, in its light and view"},
         {previous_annotation, "previous-annotation", "Ctrl+PageUp", "previous annotation"},
         {annotation_text, "annotation-text", "F2", "annotation: its text; Enter ends it"},
         {annotation_view, "annotation-view", "Shift+F2",
          "annotation: keep light, view and look as they are now"},
         {delete_annotation, "delete-annotation", "Delete", "annotation: delete it, while one annotates"},
         {show_annotations, "show-annotations", "Shift+X", "annotations: show them, or not"},
         {load_annotations, "load-annotations", "Ctrl+L", "annotations: add those of a file"},
         {copy_annotations, "copy-annotations", "Ctrl+Shift+L",
          "annotations: a copy of them in another file"},
         {treatment, "treatment", "Ctrl+T", "treatment: begin one, or open that of the painting"},
         {damage_map, "damage-map", "X", "damage map: show it, or not"},
         {suggest, "suggest", "Ctrl+G", "damage: suggest what the panel says"},
         {accept, "accept", "Ctrl+Enter",
          "accept what was suggested, or apply the retouch that is previewed"},
         {keep_damage, "keep-damage", "Ctrl+K", "damage: enter the corrections in the log"},
         {fill_losses, "fill-losses", "Ctrl+F", "treatment: fill"},
         {isolate, "isolate", "Ctrl+I", "treatment: isolating varnish"},
         {varnish, "varnish", "Ctrl+Shift+I", "treatment: varnish over all"},
         {next_state, "next-state", "N", "treatment: show the next state"},
         {compare_states, "compare-states", "Ctrl+E", "treatment: hold two states against each other"},
         {additions, "additions", "Ctrl+Shift+X", "treatment: show additions in false colour"},
         {treatment_report, "treatment-report", "Ctrl+Shift+R", "treatment: write the report"},
         {fresh, "new", "Ctrl+N", "new canvas"},
         {open, "open", "Ctrl+O", "open"},
         {save, "save", "Ctrl+S", "save"},
         {save_as, "save-as", "Ctrl+Shift+S", "save under another name"},
         {snapshot, "snapshot", "F12", "snapshot"},
         {film, "film", "Shift+F12", "film of the light going round"},
         {panels, "panels", "Tab", "hide the panels"},
         {help, "help", "F1", "keys"},
         {close, "close", "Ctrl+Q", "close"}});
};

}  // namespace

std::span<const Shortcut> shortcuts() { return ShortcutTable::kRows; }

const char* help_of(Action action) {
    for (const Shortcut& shortcut : shortcuts())
        if (shortcut.action == action) return shortcut.help;
    return "";
}

std::optional<Chord> chord_named(std::string_view text) {
    Chord chord;
    for (auto plus = text.find('+'); plus != std::string_view::npos && plus + 1 < text.size();
         plus = text.find('+')) {
        const std::string_view word = text.substr(0, plus);
        if (same_word(word, "Ctrl"))
            chord.mods |= GLFW_MOD_CONTROL;
        else if (same_word(word, "Shift"))
            chord.mods |= GLFW_MOD_SHIFT;
        else if (same_word(word, "Alt"))
            chord.mods |= GLFW_MOD_ALT;
        else
            return {};
        text.remove_prefix(plus + 1);
    }
    chord.key = key_named(text);
    if (chord.key == 0) return {};
    return chord;
}

bool is_modifier(int key) {
    return (key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER) || key == GLFW_KEY_CAPS_LOCK ||
           key == GLFW_KEY_NUM_LOCK || key == GLFW_KEY_SCROLL_LOCK;
}

std::string name_of(const Chord& chord) {
    std::string text;
    if (chord.mods & GLFW_MOD_CONTROL) text += "Ctrl+";
    if (chord.mods & GLFW_MOD_ALT) text += "Alt+";
    if (chord.mods & GLFW_MOD_SHIFT) text += "Shift+";
    for (const KeyName& named : kKeyNames)
        if (named.key == chord.key) return text + named.name;
    if (chord.key >= GLFW_KEY_F1 && chord.key <= GLFW_KEY_F25)
        return text + fmt::format("F{}", chord.key - GLFW_KEY_F1 + 1);
    return text + static_cast<char>(chord.key);
}

Keys::Keys() {
    for (const Shortcut& shortcut : shortcuts()) {
        std::istringstream words(shortcut.defaults);
        for (std::string word; words >> word;) {
            const Chord chord = checked_chord(word, "the table of keys");
            actions_[chord] = shortcut.action;
            chords_[shortcut.action].push_back(chord);
        }
    }
}

std::optional<Action> Keys::action(int key, int mods) const {
    const auto found = actions_.find({key, mods & kMods});
    if (found == actions_.end()) return {};
    return found->second;
}

std::string Keys::text(Action action) const {
    std::string text;
    const auto found = chords_.find(action);
    if (found == chords_.end()) return text;
    for (const Chord& chord : found->second) text += (text.empty() ? "" : ", ") + name_of(chord);
    return text;
}

std::optional<Action> Keys::set(Action action, const std::optional<Chord>& chord) {
    for (const Chord& old : chords_[action]) actions_.erase(old);
    chords_[action].clear();
    if (!chord) return {};
    std::optional<Action> loses;
    if (const auto had = actions_.find(*chord); had != actions_.end()) {
        loses = had->second;
        std::erase(chords_[had->second], *chord);
    }
    actions_[*chord] = action;
    chords_[action] = {*chord};
    return loses;
}

void Keys::write(const std::filesystem::path& file) const {
    const Keys usual;
    nlohmann::json changes = nlohmann::json::object();
    for (const Shortcut& shortcut : shortcuts()) {
        const auto of = [&](const Keys& keys) {
            const auto found = keys.chords_.find(shortcut.action);
            return found == keys.chords_.end() ? std::vector<Chord>() : found->second;
        };
        const std::vector<Chord> chords = of(*this);
        if (chords == of(usual)) continue;
        nlohmann::json names = nlohmann::json::array();
        for (const Chord& chord : chords) names.push_back(name_of(chord));
        changes[shortcut.name] = names;
    }
    make_folder(file.parent_path());
    write_text_file(file, json_lines(changes));
}

Keys Keys::read(const std::filesystem::path& file) {
    Keys keys;
    if (!std::filesystem::exists(file)) return keys;
    const std::string where = file.string();
    const nlohmann::json changes = json_or_discarded(read_text_file(file));
    if (!changes.is_object()) fail("{}: is not a JSON object such as {{\"shadows\": \"Shift+S\"}}", where);
    std::set<Action> changed;
    for (const auto& [name, value] : changes.items()) {
        const auto known = std::find_if(shortcuts().begin(), shortcuts().end(),
                                        [&name = name](const Shortcut& s) { return name == s.name; });
        if (known == shortcuts().end())
            fail("{}: there is no action '{}'; docs/guide/viewer.md lists them", where, shortened(name));
        std::vector<Chord> chords;
        for (const nlohmann::json& text : value.is_array() ? value : nlohmann::json::array({value})) {
            if (!text.is_string())
                fail("{}: '{}' must be a key or a list of keys, in quotes", where, shortened(name));
            chords.push_back(checked_chord(text.get<std::string>(), where));
        }
        keys.chords_[known->action] = std::move(chords);
        changed.insert(known->action);
    }
    // A key that was given an action loses the one it had by default.
    keys.actions_.clear();
    for (const bool by_user : {true, false})
        for (auto& [action, chords] : keys.chords_) {
            if (changed.contains(action) != by_user) continue;
            std::erase_if(chords, [&, of = action](const Chord& chord) {
                const auto [at, is_new] = keys.actions_.emplace(chord, of);
                if (!is_new && by_user && at->second != of)
                    fail("{}: two actions have the key {}", where, name_of(chord));
                return !is_new;
            });
        }
    return keys;
}

}  // namespace tangi
