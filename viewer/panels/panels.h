// panels.h: what lies beside and over the painting. Each draws itself with Dear ImGui and changes the state.
#pragma once

#include <fmt/format.h>
#include <imgui.h>

#include <string>

#include "viewer/model/window_state.h"

namespace tangi::panels {

inline const ImVec4 kWarning(1, 0.8f, 0.3f, 1), kFault(1, 0.45f, 0.4f, 1), kGood(0.55f, 0.9f, 0.55f, 1);

// A place on the canvas area, which begins `left` [pixels] from the window's edge.
inline ImVec2 in_window(const glm::dvec2& screen, float left) {
    return {static_cast<float>(screen.x) + left, static_cast<float>(screen.y)};
}

// There is no room for two columns and a painting between them: a treatment is in the left one, then, with a
// switch above it.
inline bool is_narrow(const WindowState& state) {
    constexpr float kPainting = 340;  // [pixels] that it shall have, as beside both in a window of 970
    return static_cast<float>(state.window_width) < (300 + 330 + kPainting) * state.scale;
}

// [pixels] of the column at the left.
inline float width(const WindowState& state) {
    return (state.treatment_state.on && is_narrow(state) ? 330 : 300) * state.scale;
}

// "Fit (F)": what its key does, too.
inline std::string with_key(const WindowState& state, const char* label, Action action) {
    const std::string key = state.keys.text(action);
    return key.empty() ? label : fmt::format("{} ({})###{}", label, key, label);
}

// "%.1f mm", or "%.1f px" where the painting has no scale: its pixels stand for mm then.
inline std::string length(const WindowState& state, const char* number) {
    return std::string(number) + (state.scale_known ? " mm" : " px");
}

// A part of a panel that folds. What is in it may have the part's name, such as the button Fill: Dear ImGui
// takes two items of one name for the same, and the button would not do anything.
template <class Draw>
void folding(const char* name, bool open, Draw&& draw) {
    if (!ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0)) return;
    ImGui::PushID(name);
    draw();
    ImGui::PopID();
}

// What of a text there is room for in so many lines of this width [pixels], with " …" where it is not all.
std::string in_lines(const std::string& text, float wide, int lines);

// Text that comes and goes, in lines that are there all the time: controls below it stay under the pointer.
// What is longer is cut, and whole under the pointer.
void note(const std::string& text, int lines = 1,
          const ImVec4& colour = ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));

// Controls that have no effect now are grey, and say why under the pointer; they stay where they are.
template <class Draw>
void idle_while(bool idle, const char* why, Draw&& draw) {
    ImGui::BeginDisabled(idle);
    ImGui::BeginGroup();
    draw();
    ImGui::EndGroup();
    ImGui::EndDisabled();
    if (idle && why && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("%s", why);
}

// The column: File, Photographs, Tools; Light, Look, Devices; Paint, Palette, Canvas, which come before those
// while one paints; Annotations, which come before all of these while one annotates.
void column(WindowState& state, float height);

void file(WindowState& state);
void photographs(WindowState& state);
void tools(WindowState& state);
void light(WindowState& state);
void look(WindowState& state);
void devices(WindowState& state);
void annotations(WindowState& state);
void messages(WindowState& state);  // what the fit had doubts about, and what the window said
void brush(WindowState& state);
void palette(WindowState& state);
void canvas(WindowState& state);

// The column at the right, while the painting is under treatment: Damage, Steps, Colour, Record.
inline float treatment_width(const WindowState& state) {
    return state.treatment_state.on && !is_narrow(state) ? 330 * state.scale : 0;
}
void treatment_column(WindowState& state, float height);
void treatment_parts(WindowState& state);  // what is in it
void treatment(WindowState& state);        // of the left column: to begin or open one
void damage(WindowState& state);
void steps(WindowState& state);
void treatment_layers(WindowState& state);  // of the steps
void matching(WindowState& state);
void record(WindowState& state);
void tip(const std::string& text);  // of the item before

// Over the painting: the damage map, and the polygon or brush that is drawn on it.
void damage_map(const WindowState& state, const Placement& placement, Extent screen, const glm::dvec2& cursor,
                bool cursor_over);

// Over the painting, in the `pane` of it that begins `left` from the window's edge: the annotations, and what
// is drawn of one.
void annotations_over(const WindowState& state, const Placement& placement, float left, Extent pane);

// Over the painting: ruler, brush outline, probe, status. `origin`: the canvas area's corner in the window.
void overlay(WindowState& state, const Placement& placement, Extent screen, const glm::dvec2& cursor,
             bool cursor_over);

// While the painting is read: its name, what is being done, and the part of it [1] that is done.
void opening(const WindowState& state, const std::string& stage, double fraction, Extent screen);

// Instead of the painting: a photograph and the painting relit as the textures hold them, as
// state.comparing says.
void held_photo(const WindowState& state, unsigned photo, unsigned relit, Extent screen);

// How much of which paint is on the brush: a disc [pixels] that empties.
void load_gauge(ImDrawList& draw, const ImVec2& centre, float radius, const OnBrush& on_brush);

// The palette that paints are mixed on, in a window of its own.
void board(WindowState& state);

// A new canvas: what it is painted on, its size, colour and gloss, with a preview. In a window of its own.
void new_canvas(WindowState& state);

// Windows with the height along the ruler and statistics of the region, where there are such.
void measurements(WindowState& state);

// Keys and what they do.
void help(WindowState& state);

}  // namespace tangi::panels
