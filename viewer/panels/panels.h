// panels.h: what lies beside and over the painting. Each draws itself with Dear ImGui and changes the state.
#pragma once

#include "viewer/window_state.h"

namespace tangi::panels {

inline constexpr float kWidth = 300;  // [pixels] of the column at the left

// The column: File, Tools, Light, Look, Paint, Palette, Canvas.
void column(WindowState& state, float height);

void file(WindowState& state);
void tools(WindowState& state);
void light(WindowState& state);
void look(WindowState& state);
void brush(WindowState& state);
void palette(WindowState& state);
void canvas(WindowState& state);

// Over the painting: ruler, brush outline, probe, status. `origin`: the canvas area's corner in the window.
void overlay(WindowState& state, const Placement& placement, Extent screen, const glm::dvec2& cursor,
             bool cursor_over);

// Keys and what they do.
void help(WindowState& state);

}  // namespace tangi::panels
