// gamepad.h: what a gamepad does to the window's state: one stick tilts, the other moves the light, triggers
// zoom.
#pragma once

#include <optional>
#include <string>

#include "viewer/model/window_state.h"

namespace tangi {

// A gamepad at one moment, as GLFW maps the many kinds to one.
struct GamepadMoment {
    glm::dvec2 left{0}, right{0};                           // [1] sticks, right and up; length 1 at their rim
    double closer = 0, farther = 0;                         // [1] right and left trigger, 0..1
    bool straighten = false, fit = false, shadows = false;  // buttons A, B, X
};

// A stick that is let go rests anywhere near the middle: there it means nothing. Beyond, it begins at 0 and
// grows with the square, so that small movements are fine. Length 1 at most.
glm::dvec2 past_dead_zone(const glm::dvec2& stick);

// `seconds` of this, after `before`: buttons act when they go down. True where something has changed.
bool apply_gamepad(const GamepadMoment& now, const GamepadMoment& before, double seconds, Extent screen,
                   WindowState& state);

// The first gamepad that is there, now. GLFW must be running.
struct GamepadSeen {
    std::string name;
    GamepadMoment moment;
};
std::optional<GamepadSeen> gamepad_now();

}  // namespace tangi
