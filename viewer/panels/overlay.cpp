// overlay.cpp: what lies over the painting: the brush's outline, the ruler, the probe, the status line.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/image/colour.h"
#include "surface/report/html_report.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

void brush_outline(const WindowState& s, const Placement& placement, const glm::dvec2& cursor, float left) {
    glm::dvec2 centre;
    if (!placement.to_painting(cursor, centre)) return;
    const double radius = s.brush.size_mm / 2 / s.stroke_mm_per_pixel;
    std::vector<ImVec2> points;
    const HeldBrush held = held_over(s.pen, s.view.turn_deg, s.brush.follow);
    const double turned = -glm::radians(held.rotation_deg);  // rows run downwards
    for (int i = 0; i < 40; ++i) {
        const double a = 2 * std::numbers::pi * i / 40, u = std::cos(a), v = s.brush.thickness * std::sin(a);
        const glm::dvec2 rim(std::cos(turned) * u - std::sin(turned) * v,
                             std::sin(turned) * u + std::cos(turned) * v);
        points.push_back(in_window(placement.to_screen(centre + radius * rim), left));
    }
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddPolyline(points.data(), 40, IM_COL32(0, 0, 0, 180), ImDrawFlags_Closed, 2.5f);
    draw->AddPolyline(points.data(), 40, IM_COL32(255, 255, 255, 220), ImDrawFlags_Closed, 1);
    if (glm::length(held.tilt) > 0.05) {  // to where the handle leans
        const glm::dvec2 lean(1.6 * held.tilt.x, -1.6 * held.tilt.y);
        const ImVec2 foot = in_window(cursor, left),
                     end = in_window(placement.to_screen(centre + radius * lean), left);
        draw->AddLine(foot, end, IM_COL32(0, 0, 0, 180), 3);
        draw->AddLine(foot, end, IM_COL32(255, 255, 255, 220), 1.5f);
    }
    // Beside it, so that what is painted is seen.
    float right = points[0].x, top = points[0].y;
    for (const ImVec2& p : points) right = std::max(right, p.x), top = std::min(top, p.y);
    const float size = 7 * s.scale;
    load_gauge(*draw, {right + size, top - 0.3f * size}, size, s.on_brush());
}

void ruler(const WindowState& s, const Placement& placement, float left) {
    if (!s.ruler) return;
    const auto& [from, to] = *s.ruler;
    const ImVec2 a = in_window(placement.to_screen(from), left), b = in_window(placement.to_screen(to), left);
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddLine(a, b, IM_COL32(0, 0, 0, 200), 4);
    draw->AddLine(a, b, IM_COL32(255, 230, 90, 255), 2);
    const double pixels = glm::length(to - from);
    const std::string text = s.scale_known ? fmt::format("{:.2f} mm", pixels * s.stroke_mm_per_pixel)
                                           : fmt::format("{:.1f} px (scale unknown)", pixels);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str()), screen = ImGui::GetIO().DisplaySize;
    const ImVec2 at(std::clamp(b.x + 8, 0.0f, std::max(screen.x - size.x - 8, 0.0f)),
                    std::clamp(b.y + 8, 0.0f, std::max(screen.y - size.y - 30, 0.0f)));
    draw->AddRectFilled({at.x - 4, at.y - 2}, {at.x + size.x + 4, at.y + size.y + 2}, IM_COL32(0, 0, 0, 190));
    draw->AddText(at, IM_COL32(255, 230, 90, 255), text.c_str());
}

void region(const WindowState& s, const Placement& placement, float left) {
    if (!s.region) return;
    const Region& r = *s.region;
    std::vector<ImVec2> points;
    for (const glm::dvec2 corner :
         {glm::dvec2(r.x0, r.y0), glm::dvec2(r.x1, r.y0), glm::dvec2(r.x1, r.y1), glm::dvec2(r.x0, r.y1)})
        points.push_back(in_window(placement.to_screen(corner - 0.5), left));
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddPolyline(points.data(), 4, IM_COL32(0, 0, 0, 200), ImDrawFlags_Closed, 3);
    draw->AddPolyline(points.data(), 4, IM_COL32(120, 220, 255, 255), ImDrawFlags_Closed, 1.5f);
}

// Some light is in front of the painting as it is tilted.
bool lit_from_front(const WindowState& s, const Placement& placement) {
    if (s.comparing.shows()) return true;
    return std::ranges::any_of(s.lights, [&](const ViewLight& light) {
        return light.on &&
               placement.in_surface(direction_of(light.angles.azimuth_deg, light.angles.elevation_deg)).z > 0;
    });
}

// Text over the status line.
void text_above(const std::string& text, float left, float width, float bottom, float wrap) {
    if (text.empty()) return;
    const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddRectFilled({left, bottom - size.y - 8}, {left + width, bottom}, IM_COL32(0, 0, 0, 190));
    draw->AddText(ImGui::GetFont(), ImGui::GetFontSize(), {left + 8, bottom - size.y - 4},
                  IM_COL32(255, 225, 150, 255), text.c_str(), nullptr, wrap);
}

// What the window says, in two lines of the painting at most, unless one asks for all of it: the last thing
// said and, where that is short, the beginning of what was said before.
void message(WindowState& s, float left, float width, float bottom) {
    if (s.message.empty()) s.whole_message = false;
    if (s.message.empty()) return;
    const char* const label = s.whole_message ? "Less###said" : "Details###said";
    const float wrap = width - 32 * s.scale - ImGui::CalcTextSize("Details").x;
    const std::size_t end = s.message.rfind('\n');
    const std::string last = s.message.substr(end == std::string::npos ? 0 : end + 1);
    std::string shown = in_lines(last, wrap, 2);
    if (const bool one = in_lines(last, wrap, 1) == last; one && end != std::string::npos) {
        const std::size_t begin = end == 0 ? std::string::npos : s.message.rfind('\n', end - 1);
        const std::size_t from = begin == std::string::npos ? 0 : begin + 1;
        shown = in_lines(s.message.substr(from, end - from), wrap, 1) + "\n" + last;
    }
    const bool is_cut = shown != s.message;
    text_above(s.whole_message ? s.message : shown, left, width, bottom, wrap);
    if (!is_cut) return;
    ImGui::SetNextWindowPos({left + width, bottom}, ImGuiCond_Always, {1, 1});
    ImGui::Begin("said", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_AlwaysAutoResize |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
    if (ImGui::SmallButton(label)) s.whole_message = !s.whole_message;
    tip("All that was said is under Messages, too");
    ImGui::End();
}

bool on_painting(const WindowState& s, const Placement& placement, const glm::dvec2& cursor) {
    glm::dvec2 at;
    return placement.to_painting(cursor, at) && at.x >= -0.5 && at.y >= -0.5 &&
           at.x < s.painting.width - 0.5 && at.y < s.painting.height - 0.5;
}

// Of the pixel under the pointer.
void probe(const WindowState& s, float right) {
    if (!s.probing || !s.probe) return;
    const Probe& p = *s.probe;
    const Material& m = p.material;
    const Lab lab = lab_from_linear(glm::dvec3(m.diffuse));
    const StandardErrors& e = p.errors;
    const auto unit = static_cast<float>(s.height_unit_mm());
    std::string text = fmt::format(
        "pixel {} {}\ncolour ρd {:.3f} {:.3f} {:.3f}{}\nL*a*b* {:.1f} {:.1f} {:.1f}\ngloss ρs "
        "{:.3f}{}\nroughness α {:.3f}{}\n"
        "normal {:.3f} {:.3f} {:.3f}{}\nheight {:.3f}{} {}\nconfidence {:.2f}",
        p.x, p.y, m.diffuse.r, m.diffuse.g, m.diffuse.b, plus_minus(e.diffuse, 3), lab.l, lab.a, lab.b,
        m.specular, plus_minus(e.specular, 3), m.roughness, plus_minus(e.roughness, 3), m.normal.x,
        m.normal.y, m.normal.z, plus_minus(e.slope, 3), unit * m.height_mm, plus_minus(unit * e.height_mm, 4),
        s.scale_known ? "mm" : "px", m.confidence);
    if (m.specular_colour != Rgb(1))
        text += fmt::format("\nlobe {:.2f} {:.2f} {:.2f}", m.specular_colour.r, m.specular_colour.g,
                            m.specular_colour.b);
    if (m.stretch != Stretch(0)) {
        const LobeAxes axes = axes_of(m.stretch, m.roughness);
        text += fmt::format("\nα {:.3f} along {:.0f}°, {:.3f} across",
                            m.roughness * m.roughness / axes.roughness_v, glm::degrees(axes.tangent),
                            axes.roughness_v);
    }
    if (p.paint_mm > 0) {
        text += fmt::format("\nwet paint {:.3f} {}", p.paint_mm, s.scale_known ? "mm" : "px");
        for (const auto& [name, part] : p.recipe)
            if (part > 0.01) text += fmt::format("\n  {:.0f} % {}", 100 * part, name);
    }
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const ImVec2 at(right - size.x - 16, 12);
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddRectFilled({at.x - 8, at.y - 6}, {at.x + size.x + 8, at.y + size.y + 6}, IM_COL32(0, 0, 0, 170),
                        4);
    draw->AddText(at, IM_COL32(230, 230, 230, 255), text.c_str());
}

}  // namespace

void opening(const WindowState& s, const std::string& stage, double fraction, Extent screen) {
    const std::string text = stage.empty()
                                 ? fmt::format("opening {}", s.title)
                                 : fmt::format("opening {}: {} {:.0f} %", s.title, stage, 100 * fraction);
    const auto width = static_cast<float>(screen.width);
    text_above(text, s.canvas_left, width, static_cast<float>(screen.height), width - 16);
}

void overlay(WindowState& s, const Placement& placement, Extent screen, const glm::dvec2& cursor,
             bool cursor_over) {
    const float left = s.canvas_left;
    damage_map(s, placement, screen, cursor, cursor_over);
    if (cursor_over && s.tool == Tool::paint && !s.comparing.on) brush_outline(s, placement, cursor, left);
    const auto half = static_cast<float>(pane(s, screen).width);
    for (const float at : {left, left + half}) {
        if (at > left && !s.comparing.aside()) break;
        annotations_over(s, placement, at, pane(s, screen));
        ruler(s, placement, at);
        region(s, placement, at);
    }
    if (!s.comparing.on && cursor_over && on_painting(s, placement, cursor))
        probe(s, left + static_cast<float>(screen.width));
    const ViewLight& light = s.lights[s.light];
    std::string status = fmt::format("{:.0f} %", 100 * s.view.zoom);
    if (s.comparing.on)
        status += s.comparing.pair ? "   two states in one light" : "   lit as the photograph";
    else
        status += fmt::format("   tilt {:.0f}° {:.0f}°   light {:.0f}° {:.0f}°", s.tilt.angle_deg.x,
                              s.tilt.angle_deg.y, light.angles.azimuth_deg, light.angles.elevation_deg);
    if (s.illuminant_now() != Illuminant::d65)
        status += fmt::format("   in {}", light_named(s.illuminant_now()));
    if (!lit_from_front(s, placement)) status += "   it is lit from behind: straighten it, or move them";
    if (s.treatment_state.state)
        status += fmt::format("   as it was: {}", title_of(*s.treatment_state.state));
    if (s.treatment_state.preview)
        status += s.treatment_state.preview->stale ? "   preview of other settings" : "   preview";
    if (s.painter.saving) status += "   saving …";
    if (s.painter.waiting > 20) status += "   painting …";
    if (!s.doubts.empty())
        status += fmt::format("   {} doubt{} of the fit", s.doubts.size(), s.doubts.size() == 1 ? "" : "s");
    const float line = 22 * s.scale, y = static_cast<float>(screen.height) - line;
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->AddRectFilled({left, y}, {left + static_cast<float>(screen.width), y + line},
                        IM_COL32(0, 0, 0, 150));
    draw->AddText({left + 8 * s.scale, y + 4 * s.scale}, IM_COL32(220, 220, 220, 255), status.c_str());
    message(s, left, static_cast<float>(screen.width), y);
}

}  // namespace tangi::panels
