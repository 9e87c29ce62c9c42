// axis_remedy.cpp: turns of lights as flags.
#include "fit/light_checks/axis_remedy.h"

#include <fmt/format.h>

#include <cmath>

namespace tangi {

LightTurn light_turn_of(const LightAxes& axes) {
    const LightTurn exchange = axes.exchanged ? LightTurn{true, 90} : LightTurn{};
    // Both axes mirrored are half a turn.
    const LightTurn signs{axes.flip_x != axes.flip_y, axes.flip_x ? 180.0 : 0.0};
    return LightTurn{false, axes.rotation_deg}.after(signs.after(exchange));
}

LightAxes light_axes_of(const LightTurn& turn) {
    if (turn.turn_deg == 180) return {.flip_x = true, .flip_y = !turn.mirrored};
    if (turn.mirrored && turn.turn_deg == 90) return {.exchanged = true};
    if (turn.mirrored && turn.turn_deg == 270) return {.exchanged = true, .flip_x = true, .flip_y = true};
    return {.flip_y = turn.mirrored, .rotation_deg = signed_deg(turn.turn_deg)};
}

double signed_deg(double deg) { return deg > 180 ? deg - 360 : deg; }

std::string axes_remedy(const LightAxes& taken, const LightTurn& turn) {
    LightAxes wanted = light_axes_of(turn.after(light_turn_of(taken)));
    // A turn that was measured is known to about a degree; one that was given is kept as it is.
    if (std::fmod(turn.turn_deg, 90) != 0) wanted.rotation_deg = std::round(wanted.rotation_deg);
    std::string give;
    LightAxes leave;  // of what was taken
    if (wanted.are_reordered())
        give += " --light-axes " + in_words(wanted);
    else
        leave = {.exchanged = taken.exchanged, .flip_x = taken.flip_x, .flip_y = taken.flip_y};
    if (wanted.rotation_deg != 0)
        give += fmt::format(" --light-rotation-deg {:.6g}", wanted.rotation_deg);
    else
        leave.rotation_deg = taken.rotation_deg;
    if (!leave.differ()) return "give" + give;
    return (give.empty() ? "" : "give" + give + " and ") + "leave out" + flags_given(leave);
}

std::string flags_given(const LightAxes& taken) {
    return std::string(taken.are_reordered() ? " --light-axes" : "") +
           (taken.rotation_deg != 0 ? " --light-rotation-deg" : "");
}

}  // namespace tangi
