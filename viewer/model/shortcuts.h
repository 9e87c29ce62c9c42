// shortcuts.h: what keys do in the window: one table, from which the defaults, the help and the names in the
// user's file are derived. No GLFW window, no OpenGL.
//
// keys.json in settings_folder() changes them: {"shadows": "Shift+S", "redo": ["Ctrl+Y", "Ctrl+Shift+Z"]}; an
// empty list leaves an action without a key.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tangi {

enum class Action {
    tool_tilt,
    tool_light,
    tool_pan,
    tool_paint,
    tool_pick,
    tool_ruler,
    tool_region,
    tool_annotate,
    tool_damage,
    tool_sample,
    fit,
    one_to_one,
    straighten,
    turn_left,
    turn_right,
    light_left,
    light_right,
    light_up,
    light_down,
    shadows,
    illuminant,
    loupe,
    brush_smaller,
    brush_larger,
    dry,
    undo,
    redo,
    compare,
    compare_way,
    next_photo,
    previous_photo,
    report,
    annotation_kind,
    next_annotation,
    previous_annotation,
    annotation_text,
    annotation_view,
    delete_annotation,
    show_annotations,
    load_annotations,
    copy_annotations,
    treatment,
    damage_map,
    suggest,
    accept,
    keep_damage,
    fill_losses,
    isolate,
    varnish,
    next_state,
    compare_states,
    additions,
    treatment_report,
    fresh,
    open,
    save,
    save_as,
    snapshot,
    film,
    panels,
    help,
    close
};

struct Shortcut {
    Action action;
    const char* name;      // in keys.json
    const char* defaults;  // chords, separated by spaces
    const char* help;
};
std::span<const Shortcut> shortcuts();
const char* help_of(Action action);

// A key as GLFW numbers it, and modifiers (GLFW_MOD_SHIFT, _CONTROL, _ALT).
struct Chord {
    int key = 0, mods = 0;
    friend auto operator<=>(const Chord&, const Chord&) = default;
};
// "Ctrl+Shift+Z", "F1", "PageUp", "["; nothing for anything else.
std::optional<Chord> chord_named(std::string_view text);
bool is_modifier(int key);  // by itself it is no chord
std::string name_of(const Chord& chord);

class Keys {
public:
    Keys();  // the defaults

    std::optional<Action> action(int key, int mods) const;
    std::string text(Action action) const;  // "Ctrl+Y, Ctrl+Shift+Z"; empty where it has none

    // Gives an action this key alone; without one it has none. The action that had the key before loses it,
    // and is returned.
    std::optional<Action> set(Action action, const std::optional<Chord>& chord);
    // What differs from the defaults, as read() takes it; throws Error where it cannot be written.
    void write(const std::filesystem::path& file) const;

    // The defaults, changed by a file; just the defaults where there is none. Throws Error naming the file
    // and what is wrong: no such action, no such key, a key that two actions have.
    static Keys read(const std::filesystem::path& file);

private:
    std::map<Chord, Action> actions_;
    std::map<Action, std::vector<Chord>> chords_;
};

}  // namespace tangi
