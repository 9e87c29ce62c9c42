// painting.cpp: the panels Paint (the brush) and Palette.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "viewer/model/palette_image.h"
#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

constexpr double kLargestBrush_mm = 500;  // as its key and the drag have it

// Values in steps: each is a paint of its own to the canvas.
bool stepped(const char* label, double& value, double low, double high, double step, const char* format) {
    if (!slide(label, value, static_cast<float>(low), static_cast<float>(high), format)) return false;
    value = std::clamp(std::round(value / step) * step, low, high);
    return true;
}

void finish(WindowState& s) {
    if (!ImGui::TreeNode("Gloss and medium")) return;
    const glm::dvec2 gloss = s.mixed_gloss();
    double specular = gloss.x, roughness = gloss.y;
    if (stepped("Gloss ρs", specular, 0, 0.2, 0.01, "%.2f")) s.finish.specular = specular;
    tip("Gloss: how much of the light its surface reflects");
    if (stepped("Roughness α", roughness, 0.05, 0.6, 0.05, "%.2f")) s.finish.roughness = roughness;
    tip("Roughness: how far highlights spread");
    stepped("Medium", s.finish.medium, 0, 0.9, 0.1, "%.1f");
    if (ImGui::SmallButton("Reset paint")) s.finish = {};
    ImGui::TreePop();
}

ImVec4 as_colour(const Rgb& c) { return {c.r, c.g, c.b, 1}; }

// A button for each paint: it is taken, or mixed in.
void paint_buttons(WindowState& s) {
    constexpr int kColumns = 9;
    for (std::size_t i = 0; i < s.palette.paints.size(); ++i) {
        const Pigment& paint = s.palette.paints[i];
        if (i % kColumns) ImGui::SameLine(0, 3);
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::ColorButton("paint", as_colour(s.paint_colours[i]), ImGuiColorEditFlags_NoTooltip,
                               {26 * s.scale, 26 * s.scale})) {
            if (!ImGui::GetIO().KeyShift) s.mix.clear();
            s.board.carried = Carried::chosen;
            s.mix[paint.name] += 1;
            s.tool = Tool::paint;
        }
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s%s\nclick: this paint; Shift-click: mix it in", paint.name.c_str(),
                              paint.approximate() ? " (approximate)" : "");
        ImGui::PopID();
    }
}

void gloss_of_mixture(const WindowState& s) {
    const ImVec2 size(width(s) - 30 * s.scale, 24 * s.scale), at = ImGui::GetCursorScreenPos();
    ImGui::Dummy(size);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("the mixture, laid on thickly over an edge, under a light");
    constexpr int kStrips = 70;
    const glm::dvec2 gloss = s.mixed_gloss();
    const std::vector<Rgb> strip = gloss_strip(s.mixed_colour(), gloss.x, gloss.y, kStrips);
    for (int i = 0; i < kStrips; ++i) {
        const float x = at.x + size.x * static_cast<float>(i) / kStrips;
        ImGui::GetWindowDrawList()->AddRectFilled(
            {x, at.y}, {x + size.x / kStrips + 0.5f, at.y + size.y},
            ImGui::ColorConvertFloat4ToU32(as_colour(strip[static_cast<std::size_t>(i)])));
    }
}

// How much of each paint there is in it.
void parts_of_mixture(WindowState& s) {
    std::string gone;
    for (auto& [name, part] : s.mix) {
        ImGui::PushID(name.c_str());
        if (ImGui::SmallButton("x") && s.mix.size() > 1) gone = name;
        ImGui::SameLine();
        ImGui::PushItemWidth(80 * s.scale);
        slide("##part", part, 0, 4, "%.2f");
        ImGui::PopItemWidth();
        ImGui::SameLine();
        ImGui::SetCursorPosY(ImGui::GetCursorPosY() + ImGui::GetStyle().FramePadding.y);
        note(name, 1, ImGui::GetStyleColorVec4(ImGuiCol_Text));  // some are longer than the column is wide
        ImGui::PopID();
    }
    if (!gone.empty()) s.mix.erase(gone);
}

}  // namespace

void load_gauge(ImDrawList& draw, const ImVec2& centre, float radius, const OnBrush& on_brush) {
    draw.AddCircleFilled(centre, radius, IM_COL32(30, 30, 30, 150), 32);
    const auto part = static_cast<float>(std::clamp(on_brush.fill, 0.0, 1.0));
    if (part > 0) {
        const Rgb c = Transfer{Transfer::Kind::srgb}.encode(on_brush.colour);
        const auto pi = std::numbers::pi_v<float>;
        draw.PathLineTo(centre);
        draw.PathArcTo(centre, radius, -0.5f * pi, (2 * part - 0.5f) * pi, 32);
        draw.PathFillConvex(ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1}));
    }
    draw.AddCircle(centre, radius, IM_COL32(255, 255, 255, 200), 32, 1);
}

void brush(WindowState& s) {
    if (ImGui::BeginCombo("Brush", s.brush_name.c_str())) {
        for (const auto& [name, settings] : s.brushes)
            if (ImGui::Selectable(name.c_str(), name == s.brush_name)) {
                s.use_brush(name);
                s.tool = Tool::paint;
            }
        ImGui::EndCombo();
    }
    const auto slider = [](const char* label, double& value, float low, float high, const char* format) {
        slide(label, value, low, high, format);
    };
    slide("Size", s.brush.size_mm, 0.2f, 100, length(s, "%.1f").c_str(),
          {.logarithmic = true, .typed_high = kLargestBrush_mm});
    slider("Load", s.brush.load_mm, 0, 6, length(s, "%.2f").c_str());
    slide("Pressure", s.pressure, 0.02f, 1, "%.2f");
    if (!ImGui::TreeNode("Bristles")) return;
    slider("Deposit", s.brush.deposit, 0, 3, "%.2f");
    slider("Pick up", s.brush.pickup, 0, 3, "%.2f");
    slider("Push", s.brush.push, 0, 1, "%.2f");
    slider("Bristle variation", s.brush.groove_mm, 0, 1, length(s, "%.2f").c_str());
    slider("Bristle spacing", s.brush.bristle_mm, 0.05f, 2, length(s, "%.2f").c_str());
    slide("Stabiliser", s.stabiliser_mm, 0, 20, length(s, "%.1f").c_str());
    ImGui::Checkbox("Follows the stroke", &s.brush.follow);
    ImGui::Checkbox("Dirty brush", &s.dirty_brush);
    tip("Not washed between strokes");
    ImGui::TreePop();
}

void palette(WindowState& s) {
    ImGui::TextDisabled("%s", s.palette.name.c_str());
    ImGui::SameLine();
    if (ImGui::SmallButton("Other paints …")) s.ask.palette_dialog = true;
    tip("A paint box of your own: a palette file, as tangipaint palette makes it. The painting is opened "
        "again "
        "with it");
    paint_buttons(s);
    gloss_of_mixture(s);
    ImGui::Checkbox("Mixing palette", &s.board.open);
    finish(s);
    parts_of_mixture(s);
}

}  // namespace tangi::panels
