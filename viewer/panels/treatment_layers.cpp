// treatment_layers.cpp: of the panel Steps: the layers of a treatment, and what undoes a step.
#include <fmt/format.h>
#include <imgui.h>

#include <utility>

#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

// Whether a click is meant for the row that it meets. Rows move when a layer goes; the second click of a
// double click, as long as one takes, was meant for the row that was there before.
bool is_meant(TreatmentState& t) {
    const ImGuiIO& io = ImGui::GetIO();
    if (!ImGui::IsMouseReleased(ImGuiMouseButton_Left)) return true;  // by a key
    return io.MouseClickedTime[ImGuiMouseButton_Left] >=
           t.layers_moved_s + static_cast<double>(io.MouseDoubleClickTime);
}

// Above the rows, so that it stays where it is when one goes.
void undo_and_all(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    const NextUndo& next = t.next_undo;
    const std::string undo = next.step.empty() ? "Undo" : "Undo: " + next.step;
    const float wide = ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().FramePadding.x;
    const char* why = next.step.empty()      ? "There is no step to undo"
                      : next.refused.empty() ? nullptr
                                             : next.refused.c_str();
    idle_while(next.step.empty() || !next.refused.empty(), why, [&] {
        if (ImGui::SmallButton((in_lines(undo, wide, 1) + "###undo").c_str()) && is_meant(t))
            t.ask.undo_step = true;
        tip(undo +
            ". What a step laid comes off, what was taken off lies there again, the damage map is what it "
            "was before; the log keeps the step, and has a line more that says it was undone");
    });
    idle_while(t.layers.empty(), "There is no layer", [&] {
        if (ImGui::SmallButton("Take all off") && is_meant(t)) t.ask.remove_all = true;
        tip("A step of the treatment, which can be undone");
    });
}

}  // namespace

void treatment_layers(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    if (std::exchange(t.layers_moved, false)) t.layers_moved_s = ImGui::GetTime();
    undo_and_all(s);
    if (t.layers.empty()) ImGui::TextDisabled("nothing lies on the painting");
    for (auto layer = t.layers.rbegin(); layer != t.layers.rend(); ++layer) {  // what lies on top first
        ImGui::PushID(layer->name.c_str());
        if (ImGui::SmallButton("Take off") && is_meant(t)) t.ask.remove = layer->name;
        tip("A step of the treatment, which can be undone; what lies below stays as it is");
        ImGui::SameLine();
        ImGui::TextUnformatted(layer->name.c_str());
        if (layer->role == LayerRole::fill || layer->role == LayerRole::retouch) {
            ImGui::SameLine();
            const int beside = layer->on_original.pixels;
            ImGui::TextColored(beside > 0 ? kFault : kGood, "%d px on original", beside);
        }
        ImGui::PopID();
    }
}

}  // namespace tangi::panels
