// board.cpp: the palette that paints are mixed on.
#include <fmt/format.h>
#include <imgui.h>

#include <cmath>

#include "viewer/panels/panels.h"

namespace tangi::panels {

void board(WindowState& s) {
    BoardState& b = s.board;
    b.rect = {};
    if (!b.open) return;
    const float width = 420 * s.scale;
    ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - 12, 12}, ImGuiCond_Appearing, {1, 0});
    if (!ImGui::Begin("Mixing palette", &b.open,
                      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                          ImGuiWindowFlags_NoFocusOnAppearing)) {
        ImGui::End();
        return;
    }
    if (ImGui::Button("Lay out the paints")) s.ask.lay_out = true;
    ImGui::SameLine();
    if (ImGui::Button("Wipe clean")) s.ask.wipe_board = true;
    ImGui::SameLine();
    if (ImGui::Button("Squeeze out")) s.ask.squeeze = true;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("a pile of the mixture, in the middle");
    ImGui::SameLine();
    if (ImGui::Button("Wash the brush")) b.wash = true;
    ImGui::TextDisabled("%s", b.wash      ? "the brush is washed"
                              : b.in_hand ? "the brush paints with what it took up here"
                                          : "stroke here to take paint up; then paint with it");
    if (!s.painter.has_board || b.texture == 0) {
        ImGui::End();
        return;
    }
    const float height = width * static_cast<float>(b.size.height) / static_cast<float>(b.size.width);
    ImGui::InvisibleButton("board", {width, height});  // else a drag would move the window
    const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    b.rect = {from.x, from.y, to.x, to.y};
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(b.texture)), from, to);
    if (ImGui::IsItemHovered()) {
        const double board_mm = b.size.width * s.stroke_mm_per_pixel;
        const auto radius = static_cast<float>(s.brush.size_mm / 2 / board_mm * static_cast<double>(width));
        draw->PushClipRect(from, to, true);
        draw->AddCircle(ImGui::GetIO().MousePos, radius, IM_COL32(0, 0, 0, 200), 40, 2);
        draw->AddCircle(ImGui::GetIO().MousePos, radius, IM_COL32(255, 255, 255, 220), 40, 1);
        draw->PopClipRect();
    }
    ImGui::End();
}

}  // namespace tangi::panels
