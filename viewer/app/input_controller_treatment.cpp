// input_controller_treatment.cpp: of the hand: damage that is drawn, and keys of a treatment.
#include "viewer/app/input_controller.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

namespace tangi {

namespace {

constexpr double kClose_px = 8;  // of the screen: as near is on a polygon's first corner

}  // namespace

// The brush begins, a corner is set, the wand asked.
void InputController::press_on_mask(const InputEvent& event, const glm::dvec2& at) {
    TreatmentState& t = state_.treatment_state;
    if (event.code != GLFW_MOUSE_BUTTON_LEFT) return;
    mask_erases_ = t.erase != ((event.mods & kAnotherWay) != 0) || (pen_ && pen_->eraser);
    const Corner corner{at.x + 0.5, at.y + 0.5};  // of pixels, not their middles
    switch (t.mask_tool) {
        case MaskTool::brush:
            drag_ = Drag::mask;
            t.touches.push_back({MaskTouch::Kind::press, corner, mask_erases_});
            break;
        case MaskTool::wand:
            t.touches.push_back({MaskTouch::Kind::wand, corner, mask_erases_});
            break;
        case MaskTool::area:
            t.touches.push_back({MaskTouch::Kind::area, corner, true});
            break;
        case MaskTool::polygon:
            if (t.polygon.size() >= 3 &&
                glm::length(placement().to_screen(t.polygon.front()) - cursor_) < kClose_px)
                close_polygon(mask_erases_);
            else
                t.polygon.push_back(at);
            break;
    }
}

void InputController::close_polygon(bool erase) {
    MaskTouch touch{MaskTouch::Kind::polygon, {}, erase};
    for (const glm::dvec2& corner : std::exchange(state_.treatment_state.polygon, {}))
        touch.polygon.push_back({corner.x + 0.5, corner.y + 0.5});
    state_.treatment_state.touches.push_back(std::move(touch));
}

// Keys of a polygon under way; true where it was one.
bool InputController::mask_key(const InputEvent& event) {
    TreatmentState& t = state_.treatment_state;
    if (t.polygon.empty() || event.mods != 0) return false;
    if (event.code == GLFW_KEY_ENTER && t.polygon.size() >= 3)
        close_polygon(t.erase);
    else if (event.code == GLFW_KEY_ESCAPE)
        t.polygon.clear();
    else if (event.code == GLFW_KEY_BACKSPACE)
        t.polygon.pop_back();
    else
        return false;
    return true;
}

// From the painting as it is through its stages and back; before and cleaned are the same here.
void InputController::next_stage() {
    std::optional<TreatmentStage>& stage = state_.treatment_state.state;
    if (!stage)
        stage = TreatmentStage::before;
    else if (*stage == TreatmentStage::varnished)
        stage.reset();
    else
        stage = std::max(static_cast<TreatmentStage>(static_cast<int>(*stage) + 1), TreatmentStage::filled);
}

void InputController::treatment_act(Action action) {
    TreatmentState& t = state_.treatment_state;
    TreatmentState::Ask& ask = t.ask;
    switch (action) {
        case Action::treatment:
            ask.begin = !t.on;
            break;
        case Action::damage_map:
            t.map = !t.map;
            break;
        case Action::suggest:
            ask.suggest = true;
            break;
        case Action::accept:
            ask.apply = t.preview.has_value();
            ask.accept = !t.preview && t.suggestion;
            break;
        case Action::keep_damage:
            ask.keep = true;
            break;
        case Action::fill_losses:
            ask.fill = true;
            break;
        case Action::isolate:
            ask.isolate = true;
            break;
        case Action::varnish:
            ask.varnish = true;
            break;
        case Action::next_state:
            next_stage();
            break;
        case Action::compare_states:
            ask.compare_states = true;
            break;
        case Action::additions:
            t.additions = !t.additions;
            break;
        case Action::treatment_report:
            ask.report_wanted = true;
            break;
        default:
            break;
    }
}

}  // namespace tangi
