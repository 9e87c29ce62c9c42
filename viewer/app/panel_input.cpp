#include "viewer/app/panel_input.h"

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <limits>

namespace tangi {

namespace {

using Kind = InputEvent::Kind;

constexpr double kDoubleClick_s = 0.3;  // between its presses, at most

bool is_button(const InputEvent& event) {
    return event.kind == Kind::press || event.kind == Kind::release || event.kind == Kind::lost;
}

// A key that does something to a text, other than to write a character: its place among characters counts.
bool acts(const InputEvent& event) {
    const bool changes_others = event.code >= GLFW_KEY_LEFT_SHIFT && event.code <= GLFW_KEY_RIGHT_SUPER;
    if (event.kind != Kind::key || changes_others) return false;
    return event.code >= GLFW_KEY_ESCAPE || (event.mods & (GLFW_MOD_CONTROL | GLFW_MOD_SUPER)) != 0;
}

// Dear ImGui (1.86) keeps what can be undone in a text field until another field is used, and believes it
// when this one is used again: where it holds a shorter text by then, undoing reads beyond its end.
void forget_fields_that_were_left() {
    ImGuiContext& context = *ImGui::GetCurrentContext();
    if (context.InputTextState.ID != context.ActiveId) context.InputTextState.ID = 0;
}

}  // namespace

// What the panels are told of one moment.
struct PanelInput::Moment {
    std::array<bool, 5> buttons{};  // that changed
    std::bitset<512> keys;          // the same
    bool moved = false, wheel = false, text = false, acted = false;
    std::optional<glm::dvec2> at;
    bool button() const {
        return std::ranges::any_of(buttons, [](bool changed) { return changed; });
    }
};

// The keyboard's own repetition of a key that stays down.
bool PanelInput::repeats(const InputEvent& event) const {
    const auto code = static_cast<std::size_t>(std::max(event.code, 0));
    return event.kind == Kind::key && code < keys_.size() && keys_[code];
}

// True where nothing is lost when this event belongs to the same moment as those before.
bool PanelInput::fits(const InputEvent& event, const Moment& m) const {
    const auto code = static_cast<std::size_t>(std::max(event.code, 0));
    switch (event.kind) {
        case Kind::move:
            return !m.button() && !m.wheel;
        case Kind::press:
            return !m.button() && !m.wheel && !m.text && !m.acted;
        case Kind::release:  // what was dragged goes along before it is let go
        case Kind::lost:
            return !m.button() && !m.wheel && !m.moved;
        case Kind::wheel:
            return !m.button();
        case Kind::key:
        case Kind::key_up:
            if (code >= m.keys.size() || repeats(event)) return true;
            return !m.keys[code] && !m.button() && !(m.acted && acts(event));
        case Kind::text:  // Dear ImGui takes text before keys
            return !m.acted && !m.button();
        case Kind::gesture:
        case Kind::leave:
            return true;
    }
    return true;
}

// Dear ImGui sees how far apart frames are, not clicks: of two slow frames it would never make a double
// click. It is told which one is the second: whatever may have come in time.
void PanelInput::count_click(const InputEvent& event) {
    double& pressed_s = pressed_s_[static_cast<std::size_t>(event.code)];
    const bool is_second = event.time_s - event.late_s - pressed_s < kDoubleClick_s;
    ImGui::GetIO().MouseDoubleClickTime = is_second ? std::numeric_limits<float>::max() : 0;
    pressed_s = event.time_s;
}

void PanelInput::take(const InputEvent& event, Moment& m, Fed& fed) {
    ImGuiIO& io = ImGui::GetIO();
    const auto code = static_cast<std::size_t>(std::max(event.code, 0));
    if (event.kind == Kind::move || is_button(event)) m.at = event.at;
    m.moved |= event.kind == Kind::move;
    switch (event.kind) {
        case Kind::press:
        case Kind::release:
            if (code >= buttons_.size()) break;
            m.buttons[code] = true;
            buttons_[code] = event.kind == Kind::press;
            if (event.kind == Kind::press) count_click(event);
            break;
        case Kind::lost:
            m.buttons = buttons_;
            buttons_ = {};
            break;
        case Kind::wheel:
            m.wheel = true;
            io.MouseWheelH += static_cast<float>(event.at.x);
            io.MouseWheel += static_cast<float>(event.at.y);
            break;
        case Kind::key:
        case Kind::key_up:
            if (repeats(event)) break;  // which Dear ImGui counts itself
            m.acted |= acts(event);
            fed.enter |= event.kind == Kind::key && (code == GLFW_KEY_ENTER || code == GLFW_KEY_KP_ENTER);
            fed.escape |= event.kind == Kind::key && code == GLFW_KEY_ESCAPE;
            if (code >= keys_.size()) break;
            m.keys[code] = true;
            keys_[code] = event.kind == Kind::key;
            break;
        case Kind::text:
            m.text = true;
            io.AddInputCharacter(static_cast<unsigned>(event.code));
            break;
        case Kind::move:
        case Kind::gesture:
        case Kind::leave:
            break;
    }
}

PanelInput::Fed PanelInput::feed(const std::optional<glm::dvec2>& finger, bool ready_to_type) {
    forget_fields_that_were_left();
    ImGuiIO& io = ImGui::GetIO();
    Fed fed;
    Moment moment;
    while (!events_.empty() && fits(events_.front(), moment)) {
        const bool typed = events_.front().kind == Kind::key || events_.front().kind == Kind::text;
        if (typed && !ready_to_type) break;
        take(events_.front(), moment, fed);
        events_.pop_front();
    }
    // Before more events, the pointer is where the last of these was; else where the backend sees the mouse.
    const std::optional<glm::dvec2> at = moment.at ? moment.at : finger;
    if (at) io.MousePos = {static_cast<float>(at->x), static_cast<float>(at->y)};
    std::ranges::copy(buttons_, std::begin(io.MouseDown));
    for (std::size_t key = 0; key < keys_.size(); ++key) io.KeysDown[key] = keys_[key];
    io.KeyCtrl = keys_[GLFW_KEY_LEFT_CONTROL] || keys_[GLFW_KEY_RIGHT_CONTROL];
    io.KeyShift = keys_[GLFW_KEY_LEFT_SHIFT] || keys_[GLFW_KEY_RIGHT_SHIFT];
    io.KeyAlt = keys_[GLFW_KEY_LEFT_ALT] || keys_[GLFW_KEY_RIGHT_ALT];
    io.KeySuper = keys_[GLFW_KEY_LEFT_SUPER] || keys_[GLFW_KEY_RIGHT_SUPER];
    return fed;
}

bool PanelInput::popup_is_open() { return ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup); }

void PanelInput::close_popups() {
    if (popup_is_open()) ImGui::ClosePopupToLevel(0, true);
}

}  // namespace tangi
