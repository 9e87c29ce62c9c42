// board.cpp: the palette that paints are mixed on.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

// What is on the brush, with its paints; and what a stroke here does.
void carried(const WindowState& s) {
    const BoardState& b = s.board;
    const OnBrush left = s.dirty_brush ? s.painter.on_brush : OnBrush();
    const OnBrush on = b.carried == Carried::nothing ? left : s.on_brush();
    const float line = ImGui::GetTextLineHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy({line, line});
    load_gauge(*ImGui::GetWindowDrawList(), {at.x + line / 2, at.y + line / 2}, line / 2, on);
    ImGui::SameLine();
    std::string text = on.fill > 0 ? fmt::format("{:.0f} %", 100 * std::min(on.fill, 9.99)) : "no paint";
    constexpr std::size_t kMostNamed = 2;
    for (std::size_t i = 0; i < on.recipe.size(); ++i) {
        const auto& [name, part] = on.recipe[i];
        if (i == kMostNamed || part < 0.01) {
            text += " …";
            break;
        }
        text += i == 0 ? ": " : ", ";
        text += on.recipe.size() == 1 ? name : fmt::format("{:.0f} % {}", 100 * part, name);
    }
    ImGui::TextUnformatted(text.c_str());
    ImGui::TextDisabled("%s", b.carried == Carried::taken_up ? "the brush paints with what it took up here"
                              : b.carried == Carried::chosen
                                  ? "stroke here to mix it with what lies here"
                                  : "stroke here to take paint up; then paint with it");
}

// The palette before there is paint on it, as large as it will be.
void empty(float width) {
    const ImVec2 at = ImGui::GetCursorScreenPos(), size(width, 0.75f * width);
    ImGui::InvisibleButton("empty", size);  // else a drag would move the window
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddRectFilled(at, {at.x + size.x, at.y + size.y}, IM_COL32(225, 225, 225, 255));
    constexpr const char* kText = "Lay out the paints, or squeeze the mixture out";
    const ImVec2 wide = ImGui::CalcTextSize(kText);
    draw->AddText({at.x + (size.x - wide.x) / 2, at.y + (size.y - wide.y) / 2}, IM_COL32(60, 60, 60, 255),
                  kText);
}

}  // namespace

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
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("a pile of the mixture, where there is room");
    ImGui::SameLine();
    if (ImGui::Button("Wash the brush")) s.ask.wash = true;
    carried(s);
    if (!s.painter.has_board || b.texture == 0) {
        empty(width);
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
