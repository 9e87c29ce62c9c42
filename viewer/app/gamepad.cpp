#include "viewer/app/gamepad.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

namespace tangi {

namespace {

constexpr double kDeadZone = 0.15, kTriggerDeadZone = 0.05;
constexpr double kTilt_deg_per_s = 90, kLight_per_s = 1.2;  // radii of the dome, seen from above
constexpr double kZoom_per_s = 4;

double past_trigger_dead_zone(double value) {
    return std::clamp((value - kTriggerDeadZone) / (1 - kTriggerDeadZone), 0.0, 1.0);
}

}  // namespace

glm::dvec2 past_dead_zone(const glm::dvec2& stick) {
    const double length = glm::length(stick);
    if (!(length > kDeadZone)) return glm::dvec2(0);
    const double beyond = std::min((length - kDeadZone) / (1 - kDeadZone), 1.0);
    return stick / length * beyond * beyond;
}

bool apply_gamepad(const GamepadMoment& now, const GamepadMoment& before, double seconds, Extent screen,
                   WindowState& state) {
    bool changed = false;
    const bool compares = state.comparing.on;  // nothing tilts then, and nothing is lit
    const glm::dvec2 tilt = past_dead_zone(now.left), light = past_dead_zone(now.right);
    if (tilt != glm::dvec2(0) && !compares) {
        state.tilt = held(state.tilt);
        const glm::dvec2 wanted =
            state.tilt.angle_deg + kTilt_deg_per_s * seconds * glm::dvec2(-tilt.y, tilt.x);
        state.tilt.angle_deg = glm::clamp(wanted, glm::dvec2(-Tilt::kMost_deg), glm::dvec2(Tilt::kMost_deg));
        changed = true;
    }
    if (light != glm::dvec2(0) && !compares) {
        Angles& moved = state.lights[state.light].angles;
        moved = light_at(place_of(moved) + kLight_per_s * seconds * light);
        state.sweeping = false;
        changed = true;
    }
    const double zoom = past_trigger_dead_zone(now.closer) - past_trigger_dead_zone(now.farther);
    if (zoom != 0) {
        const Extent seen = pane(state, screen);
        state.view = zoomed(state.view, std::pow(kZoom_per_s, zoom * seconds),
                            0.5 * glm::dvec2(seen.width, seen.height), seen);
        changed = true;
    }
    const auto pressed = [&](bool GamepadMoment::*button) { return now.*button && !(before.*button); };
    if (pressed(&GamepadMoment::straighten)) changed = state.ask.straighten = true;
    if (pressed(&GamepadMoment::fit)) changed = state.ask.fit = true;
    if (pressed(&GamepadMoment::shadows) && !compares) {
        state.shadows = !state.shadows;
        changed = true;
    }
    return changed;
}

std::optional<GamepadSeen> gamepad_now() {
    for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST; ++id) {
        GLFWgamepadstate state;
        if (!glfwJoystickPresent(id) || !glfwJoystickIsGamepad(id) || !glfwGetGamepadState(id, &state))
            continue;
        const auto axis = [&](int which) { return static_cast<double>(state.axes[which]); };
        const auto down = [&](int which) { return state.buttons[which] == GLFW_PRESS; };
        const char* name = glfwGetGamepadName(id);
        GamepadSeen seen{name ? name : "gamepad", {}};
        seen.moment.left = {axis(GLFW_GAMEPAD_AXIS_LEFT_X), -axis(GLFW_GAMEPAD_AXIS_LEFT_Y)};
        seen.moment.right = {axis(GLFW_GAMEPAD_AXIS_RIGHT_X), -axis(GLFW_GAMEPAD_AXIS_RIGHT_Y)};
        seen.moment.farther = (axis(GLFW_GAMEPAD_AXIS_LEFT_TRIGGER) + 1) / 2;
        seen.moment.closer = (axis(GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER) + 1) / 2;
        seen.moment.straighten = down(GLFW_GAMEPAD_BUTTON_A);
        seen.moment.fit = down(GLFW_GAMEPAD_BUTTON_B);
        seen.moment.shadows = down(GLFW_GAMEPAD_BUTTON_X);
        return seen;
    }
    return {};
}

}  // namespace tangi
