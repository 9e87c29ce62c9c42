// painting.cpp: the panels Paint (the brush) and Palette.
#include <fmt/format.h>
#include <imgui.h>

#include "viewer/panels/panels.h"

namespace tangi::panels {

void brush(WindowState& s) {
    if (ImGui::BeginCombo("Brush", s.brush_name.c_str())) {
        for (const auto& [name, settings] : s.brushes)
            if (ImGui::Selectable(name.c_str(), name == s.brush_name)) {
                s.use_brush(name);
                s.tool = Tool::paint;
            }
        ImGui::EndCombo();
    }
    const auto slider = [](const char* label, double& value, float low, float high, const char* format,
                           bool logarithmic = false) {
        auto v = static_cast<float>(value);
        if (ImGui::SliderFloat(label, &v, low, high, format, logarithmic ? ImGuiSliderFlags_Logarithmic : 0))
            value = v;
    };
    slider("Size", s.brush.size_mm, 0.2f, 100, "%.1f mm", true);
    slider("Load", s.brush.load_mm, 0, 6, "%.2f mm");
    ImGui::SliderFloat("Pressure", &s.pressure, 0.02f, 1, "%.2f");
    if (!ImGui::TreeNode("Bristles")) return;
    slider("Deposit", s.brush.deposit, 0, 3, "%.2f");
    slider("Pick up", s.brush.pickup, 0, 3, "%.2f");
    slider("Push", s.brush.push, 0, 1, "%.2f");
    slider("Grooves", s.brush.groove_mm, 0, 1, "%.2f mm");
    slider("Bristle", s.brush.bristle_mm, 0.05f, 2, "%.2f mm");
    ImGui::SliderFloat("Steady", &s.stabiliser_mm, 0, 20, "%.1f mm");
    ImGui::Checkbox("Follows the stroke", &s.brush.follow);
    ImGui::Checkbox("Dirty brush: not washed between strokes", &s.dirty_brush);
    ImGui::TreePop();
}

void palette(WindowState& s) {
    const auto as_colour = [](const Rgb& c) { return ImVec4(c.r, c.g, c.b, 1); };
    constexpr int kColumns = 9;
    for (std::size_t i = 0; i < s.palette.paints.size(); ++i) {
        const Pigment& paint = s.palette.paints[i];
        if (i % kColumns) ImGui::SameLine(0, 3);
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::ColorButton("paint", as_colour(s.paint_colours[i]), ImGuiColorEditFlags_NoTooltip,
                               {26 * s.scale, 26 * s.scale})) {
            if (!ImGui::GetIO().KeyShift) s.mix.clear();
            s.mix[paint.name] += 1;
            s.tool = Tool::paint;
        }
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s%s\nclick: this paint; Shift-click: mix it in", paint.name.c_str(),
                              paint.approximate() ? " (approximate)" : "");
        ImGui::PopID();
    }
    ImGui::ColorButton("mixture", as_colour(Transfer{Transfer::Kind::srgb}.encode(s.mixed_colour())),
                       ImGuiColorEditFlags_NoTooltip, {width(s) - 30 * s.scale, 24 * s.scale});
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("the mixture, laid on thickly");
    std::string gone;
    for (auto& [name, part] : s.mix) {
        ImGui::PushID(name.c_str());
        if (ImGui::SmallButton("x") && s.mix.size() > 1) gone = name;
        ImGui::SameLine();
        ImGui::PushItemWidth(80 * s.scale);
        ImGui::SliderFloat("##part", &part, 0, 4, "%.2f");
        ImGui::PopItemWidth();
        ImGui::SameLine();
        ImGui::TextUnformatted(name.c_str());
        ImGui::PopID();
    }
    if (!gone.empty()) s.mix.erase(gone);
}

}  // namespace tangi::panels
