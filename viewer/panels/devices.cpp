// devices.cpp: the panel Devices: webcam, tilt sensor, gamepad, monitor.
#include <imgui.h>

#include "viewer/panels/panels.h"

namespace tangi::panels {

void devices(WindowState& s) {
    Following& follow = s.follow;
    const bool compares = s.comparing.on;  // nothing tilts then, and nothing is lit
    ImGui::BeginDisabled(compares);
    ImGui::Checkbox("My head (webcam)", &follow.head);
    tip("Gloss moves as it does on the wall: the painting is seen from where your head is");
    if (follow.head) {
        ImGui::SameLine();
        ImGui::TextDisabled(follow.sees_head ? "seen" : "no face");
    }
    ImGui::Checkbox("Light of the room (webcam)", &follow.light);
    tip("The brightest direction that the webcam sees becomes the light");
    ImGui::Checkbox("Tilt sensor", &follow.sensor);
    tip("The screen is the painting: tilt it, and the light wanders over it");
    idle_while(!follow.head && !follow.sensor, "Of the head, or the sensor", [&] {
        if (ImGui::Button("This is straight on")) follow.recentre = true;
    });
    ImGui::EndDisabled();
    ImGui::TextDisabled("Gamepad: %s", follow.gamepad.empty() ? "none" : follow.gamepad.c_str());
    ImGui::TextDisabled("Monitor: %s", s.monitor.c_str());
}

}  // namespace tangi::panels
