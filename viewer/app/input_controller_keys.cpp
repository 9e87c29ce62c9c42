// input_controller_keys.cpp: what keys do, of the hand.
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "viewer/app/input_controller.h"

namespace tangi {

namespace {

constexpr double kLightStep_deg = 3, kTurn_deg = 15;

}  // namespace

// The key that an action is given from now on; Backspace: none.
void InputController::rebind(const InputEvent& event) {
    if (is_modifier(event.code)) return;  // what comes with it counts
    const Action action = *std::exchange(state_.rebinding, {});
    if (event.code == GLFW_KEY_ESCAPE) return;
    std::optional<Chord> chord;
    state_.message_until_s = event.time_s + 8;
    if (event.code != GLFW_KEY_BACKSPACE) {
        chord = Chord{event.code, event.mods & (GLFW_MOD_SHIFT | GLFW_MOD_CONTROL | GLFW_MOD_ALT)};
        const bool has_its_use =
            event.code == GLFW_KEY_SPACE || event.code == GLFW_KEY_ENTER || event.code == GLFW_KEY_KP_ENTER;
        if (has_its_use || chord_named(name_of(*chord)) != chord) {
            state_.message = has_its_use ? "Space and Enter have uses of their own: choose another key"
                                         : "this key has no name that the program knows: choose another one";
            return;
        }
    }
    const std::optional<Action> loses = state_.keys.set(action, chord);
    state_.ask.keys_changed = true;
    state_.message = fmt::format("{}: {}", help_of(action), chord ? name_of(*chord) : "no key");
    if (loses) state_.message += fmt::format("; no longer: {}", help_of(*loses));
}

void InputController::key(const InputEvent& event) {
    if (state_.rebinding) {
        rebind(event);
        return;
    }
    if (state_.tool == Tool::damage && mask_key(event)) return;
    if (state_.tool == Tool::annotate && annotation_key(event)) return;
    if (event.code == GLFW_KEY_ENTER && event.mods == 0) {
        if (state_.closing && state_.unsaved())
            state_.ask.save = state_.ask.close = true;
        else if (state_.left_over_strokes > 0)
            (state_.left_over_of_another ? state_.ask.discard : state_.ask.recover) = true;
        else if (!state_.dropped.empty())
            state_.ask.fit_folder = std::exchange(state_.dropped, {});
    }
    if (event.code == GLFW_KEY_ESCAPE && state_.help) {
        state_.help = false;  // which lies over all else
        return;
    }
    if (event.code == GLFW_KEY_ESCAPE) {
        state_.ask.stay = state_.finishing.has_value();
        state_.closing = state_.new_canvas.open = false;
        state_.open_next.clear();
        state_.dropped.clear();
        put_ruler_away();
    }
    if (event.code == GLFW_KEY_SPACE) space_ = true;
    const std::optional<Action> action = state_.keys.action(event.code, event.mods);
    if (!action || is_idle(*action, event.time_s)) return;
    for (const ToolName& tool : kTools)
        if (tool.action == *action &&
            (state_.treatment_state.on || (tool.tool != Tool::damage && tool.tool != Tool::sample))) {
            if (state_.tool != tool.tool) end_stroke();
            state_.tool = tool.tool;
        }
    look_act(*action);
    painting_act(*action);
    window_act(*action);
    file_act(*action);
    annotation_act(*action);
    if (*action == Action::treatment || state_.treatment_state.on) treatment_act(*action);
}

// Keys of an annotation that is drawn, but where something is asked that they answer.
bool InputController::annotation_key(const InputEvent& event) {
    const bool asks = state_.closing || state_.finishing || state_.left_over_strokes > 0 ||
                      !state_.dropped.empty() || state_.help || state_.new_canvas.open;
    return !asks && !state_.comparing.on && annotator_.key(event.code, event.mods, annotated(), state_.view);
}

void InputController::annotation_act(Action action) {
    AnnotationState& a = state_.annotations;
    WindowState::Requests& ask = state_.ask;
    switch (action) {
        case Action::annotation_kind:
            if (state_.tool == Tool::annotate)
                a.kind = static_cast<AnnotationKind>((static_cast<int>(a.kind) + 1) % kAnnotationKinds);
            else
                end_stroke();
            state_.tool = Tool::annotate;
            break;
        case Action::next_annotation:
            ask.step_annotation = 1;
            break;
        case Action::previous_annotation:
            ask.step_annotation = -1;
            break;
        case Action::annotation_text:
            ask.write_text = true;
            break;
        case Action::annotation_view:
            ask.keep_view = true;
            break;
        case Action::delete_annotation:
            ask.remove_annotation = state_.tool == Tool::annotate;
            break;
        case Action::show_annotations:
            a.shown = !a.shown;
            break;
        case Action::load_annotations:
            ask.load_annotations_dialog = true;
            break;
        case Action::copy_annotations:
            ask.copy_annotations_dialog = true;
            break;
        default:
            break;
    }
}

// What changes how the painting is seen.
void InputController::look_act(Action action) {
    Angles& light = state_.lights[state_.light].angles;
    switch (action) {
        case Action::shadows:
            state_.shadows = !state_.shadows;
            break;
        case Action::illuminant:
            state_.see_in(light_after(state_.illuminant));
            break;
        case Action::loupe:
            state_.loupe = !state_.loupe;
            break;
        case Action::turn_left:
            state_.view = turned(state_.view, kTurn_deg);
            break;
        case Action::turn_right:
            state_.view = turned(state_.view, -kTurn_deg);
            break;
        case Action::light_left:
            light.azimuth_deg = std::remainder(light.azimuth_deg + kLightStep_deg, 360.0);
            break;
        case Action::light_right:
            light.azimuth_deg = std::remainder(light.azimuth_deg - kLightStep_deg, 360.0);
            break;
        case Action::light_up:
            light.elevation_deg = std::min(light.elevation_deg + kLightStep_deg, 90.0);
            break;
        case Action::light_down:
            light.elevation_deg = std::max(light.elevation_deg - kLightStep_deg, 2.0);
            break;
        case Action::compare:
            end_stroke();  // beside a photograph nothing is painted
            if (state_.comparing.pair) {
                state_.treatment_state.ask.stop_comparing = true;
                break;
            }
            state_.comparing.on = state_.comparing.loaded && !state_.comparing.on;
            if (!state_.comparing.loaded) state_.ask.photos_dialog = true;
            break;
        case Action::compare_way:
            state_.comparing.way =
                static_cast<CompareWay>((static_cast<std::size_t>(state_.comparing.way) + 1) %
                                        (state_.comparing.pair ? kPairWays : kCompareWays.size()));
            break;
        default:
            break;
    }
}

// Of the brush that the tool has: the painter's, or the one that draws damage.
void InputController::resize_brush(bool larger) {
    float& mask_mm = state_.treatment_state.brush_mm;
    double& size_mm = state_.brush.size_mm;
    if (state_.tool == Tool::damage)
        mask_mm = larger ? std::min(mask_mm * 1.15f, 100.0f) : std::max(mask_mm / 1.15f, 0.2f);
    else
        size_mm = larger ? std::min(size_mm * 1.15, 500.0) : std::max(size_mm / 1.15, 0.1);
}

// What changes the painting: strokes, or damage that is drawn.
void InputController::painting_act(Action action) {
    WindowState::Requests& ask = state_.ask;
    switch (action) {
        case Action::dry:
            ask.dry = true;
            break;
        case Action::undo:
            if (state_.tool == Tool::annotate)
                ask.undo_annotation = !annotator_.step_back();
            else
                (state_.tool == Tool::damage ? state_.treatment_state.ask.undo : ask.undo) = true;
            break;
        case Action::redo:
            if (state_.tool == Tool::annotate)
                ask.redo_annotation = true;
            else
                (state_.tool == Tool::damage ? state_.treatment_state.ask.redo : ask.redo) = true;
            break;
        case Action::brush_smaller:
        case Action::brush_larger:
            resize_brush(action == Action::brush_larger);
            break;
        default:
            break;
    }
}

// What is asked of the window.
void InputController::window_act(Action action) {
    WindowState::Requests& ask = state_.ask;
    switch (action) {
        case Action::fit:
            ask.fit = true;
            break;
        case Action::one_to_one:
            ask.one_to_one = true;
            break;
        case Action::straighten:
            ask.straighten = true;
            break;
        case Action::next_photo:
            ask.step_photo = 1;
            break;
        case Action::previous_photo:
            ask.step_photo = -1;
            break;
        case Action::report:
            ask.report_dialog = state_.comparing.news.book != nullptr;
            break;
        case Action::snapshot:
            ask.snapshot = true;
            break;
        case Action::film:
            ask.film_dialog = !state_.film;
            break;
        case Action::panels:
            panels_ = !panels_;
            break;
        case Action::help:
            state_.help = !state_.help;
            break;
        default:
            break;
    }
}

// What is asked of files.
void InputController::file_act(Action action) {
    WindowState::Requests& ask = state_.ask;
    switch (action) {
        case Action::fresh:
            ask.new_canvas = true;
            break;
        case Action::open:
            ask.open_dialog = true;
            break;
        case Action::save:
            ask.save = true;
            break;
        case Action::save_as:
            ask.save_dialog = true;
            break;
        case Action::close:
            ask.close = true;
            break;
        default:
            break;
    }
}

}  // namespace tangi
