// notes.cpp: text in panels that has only so much room, and is whole under the pointer.
#include <imgui.h>

#include <algorithm>

#include "viewer/panels/panels.h"

namespace tangi::panels {

void tip(const std::string& text) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text.c_str());
}

std::string in_lines(const std::string& text, float wide, int lines) {
    const float most = (static_cast<float>(lines) + 0.5f) * ImGui::GetTextLineHeight();
    const auto fits = [&](const std::string& part) {
        return ImGui::CalcTextSize(part.c_str(), nullptr, false, wide).y <= most;
    };
    std::string shown = text;
    while (!fits(shown)) {
        const auto blank = text.find_last_of(" \n", shown.size() - std::min<std::size_t>(shown.size(), 5));
        if (blank == std::string::npos) break;
        shown = text.substr(0, blank) + " …";
    }
    return shown;
}

void note(const std::string& text, int lines, const ImVec4& colour) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float wide = std::max(ImGui::GetContentRegionAvail().x, 1.0f);
    const float high = static_cast<float>(lines) * ImGui::GetTextLineHeight();
    ImGui::Dummy({1, high});  // no wider: a window that fits what is in it can become narrower again
    if (text.empty()) return;
    const std::string shown = in_lines(text, wide, lines);
    ImDrawList* draw = ImGui::GetWindowDrawList();
    const ImVec4 clip(at.x, at.y, at.x + wide, at.y + high);
    draw->AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, ImGui::GetColorU32(colour), shown.c_str(),
                  nullptr, wide, &clip);
    if (shown == text || !ImGui::IsWindowHovered() || !ImGui::IsMouseHoveringRect(at, {clip.z, clip.w}))
        return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(35 * ImGui::GetFontSize());
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

}  // namespace tangi::panels
