// damage.cpp: the panel Damage of a treatment, and the damage map over the painting.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

// Cells that the map is drawn in, along a side: within one, perspective is as good as straight.
constexpr int kCells = 24;

// Number, area and share of a class, as they are with the corrections that are not in the log.
void counted(const DamageRow& row, bool scale_known) {
    const DamageCount& now = row.corrected ? *row.corrected : row.logged;
    const bool any = row.there || row.corrected;
    const ImVec4 colour = row.corrected ? kWarning : ImGui::GetStyleColorVec4(ImGuiCol_Text);
    const auto column = [&](const std::string& text) {
        ImGui::TableNextColumn();
        if (!any) return;
        ImGui::TextColored(colour, "%s", text.c_str());
        if (row.corrected)
            tip(row.there ? fmt::format("With corrections that are not in the log, which has {}, {:.2f} %",
                                        row.logged.count, row.logged.percent)
                          : "Not in the log yet");
    };
    column(fmt::format("{}", now.count));
    column(scale_known ? fmt::format("{:.2f} cm²", now.area_cm2) : "");
    column(fmt::format("{:.2f} %", now.percent));
}

void legend(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    if (!ImGui::BeginTable("legend", 4, ImGuiTableFlags_SizingFixedFit)) return;
    ImGui::TableSetupColumn("class", ImGuiTableColumnFlags_WidthStretch);
    for (DamageRow& row : t.damage) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        const char* title = title_of(row.damage);
        ImGui::PushID(title);
        const Rgb c = legend_colour_srgb(row.damage);
        ImGui::PushStyleColor(ImGuiCol_CheckMark, {c.r, c.g, c.b, 1});
        ImGui::Checkbox("##shown", &row.shown);
        ImGui::PopStyleColor();
        tip("Shown on the map");
        ImGui::SameLine();
        ImGui::ColorButton("##colour", {c.r, c.g, c.b, 1}, ImGuiColorEditFlags_NoTooltip,
                           {14 * s.scale, 14 * s.scale});
        ImGui::SameLine();
        if (ImGui::RadioButton(title, t.current == row.damage)) {
            t.current = row.damage;
            s.tool = Tool::damage;
        }
        tip("Drawn on with the tool Damage");
        ImGui::PopID();
        counted(row, t.scale_known);
    }
    ImGui::EndTable();
    if (!t.scale_known) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        ImGui::TextWrapped("scale unknown: no areas in cm²; a pixel counts as one mm");
        ImGui::PopStyleColor();
    }
}

void map(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    ImGui::Checkbox(fmt::format("Map ({})", s.keys.text(Action::damage_map)).c_str(), &t.map);
    ImGui::SameLine();
    int style = static_cast<int>(t.style);
    ImGui::PushItemWidth(90 * s.scale);
    if (ImGui::Combo("##style", &style, "filled\0hatched\0outlined\0"))
        t.style = static_cast<MapStyle>(style);
    ImGui::SameLine();
    slide("##opacity", t.opacity, 0.05f, 1, "%.2f");
    ImGui::PopItemWidth();
    tip("Opacity of the map");
}

void drawing(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    int tool = static_cast<int>(t.mask_tool);
    ImGui::Text("Draw %s", title_of(t.current));
    for (const auto& [index, name] : {std::pair(0, "Brush"), {1, "Polygon"}, {2, "Wand"}, {3, "Area"}}) {
        if (index > 0) ImGui::SameLine();
        if (ImGui::RadioButton(name, &tool, index)) s.tool = Tool::damage;
    }
    t.mask_tool = static_cast<MaskTool>(tool);
    ImGui::BeginDisabled(t.mask_tool == MaskTool::area);
    ImGui::Checkbox("Erase", &t.erase);
    ImGui::EndDisabled();
    tip("Takes away from the damage; Ctrl does so for once");
    // One row, of whatever tool.
    if (t.mask_tool == MaskTool::brush)
        slide("Size", t.brush_mm, 0.2f, 100, length(s, "%.1f").c_str(), {.logarithmic = true});
    if (t.mask_tool == MaskTool::polygon || t.mask_tool == MaskTool::area) ImGui::AlignTextToFramePadding();
    if (t.mask_tool == MaskTool::polygon)
        ImGui::TextDisabled("click corners; Enter closes, Backspace takes one back");
    if (t.mask_tool == MaskTool::area) ImGui::TextDisabled("a click takes a whole area away");
    if (t.mask_tool == MaskTool::wand) {
        int by = static_cast<int>(t.wand_by);
        ImGui::PushItemWidth(90 * s.scale);
        if (ImGui::Combo("##by", &by, "colour\0height\0gloss\0")) t.wand_by = static_cast<WandBy>(by);
        ImGui::PopItemWidth();
        ImGui::SameLine();
        float& tolerance = t.tolerance[static_cast<std::size_t>(by)];
        if (t.wand_by == WandBy::colour) slide("##tolerance", tolerance, 1, 50, "ΔE %.0f");
        if (t.wand_by == WandBy::height)
            slide("##tolerance", tolerance, 0.005f, 2, length(s, "%.3f").c_str(), {.logarithmic = true});
        if (t.wand_by == WandBy::gloss) slide("##tolerance", tolerance, 0.05f, 3, "%.2f");
        tip("How far what is connected may be from the place that is clicked");
    }
    if (ImGui::Button("Undo##mask")) t.ask.undo = true;
    tip(s.keys.text(Action::undo) + ", with the tool Damage");
    ImGui::SameLine();
    if (ImGui::Button("Redo##mask")) t.ask.redo = true;
}

// "smallest patch, mm²" of smallest_patch_mm2.
std::string option_label(const FieldInfo& info) {
    std::string label(info.name);
    const std::string ending = "_" + std::string(info.unit);
    if (label.ends_with(ending))
        label.replace(label.size() - ending.size(), ending.size(),
                      info.unit == "mm2" ? ", mm²" : fmt::format(", {}", info.unit));
    std::replace(label.begin(), label.end(), '_', ' ');
    return label;
}

template <class Options>
void options_of(Options& options, float scale) {
    Options::fields(options, [&](const FieldInfo& info, auto& value) {
        auto v = static_cast<double>(value);
        ImGui::PushItemWidth(90 * scale);
        if (type_number(option_label(info).c_str(), v, info.minimum, info.maximum, "%.3g"))
            value = static_cast<std::remove_reference_t<decltype(value)>>(v);
        ImGui::PopItemWidth();
        tip(std::string(info.help));
    });
}

// What was suggested; its room is there before it is.
void suggested(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    ShownSuggestion nothing;
    ShownSuggestion& shown = t.suggestion ? *t.suggestion : nothing;
    std::string found, replaces;
    if (t.suggestion)
        found = fmt::format("{}: {} of {}{}", shown.title, shown.shown, shown.regions,
                            t.scale_known ? fmt::format(", {:.2f} cm²", shown.area_cm2) : "");
    note(found, 1, {0.95f, 0.4f, 0.8f, 1});
    note(shown.measured, 2, ImGui::GetStyleColorVec4(ImGuiCol_Text));
    ImGui::BeginDisabled(!t.suggestion);
    slide("Minimum confidence", shown.threshold, 0, 1, "%.2f and more");
    tip("Only areas of which the program is at least so sure");
    if (ImGui::BeginCombo("As", t.suggestion ? title_of(shown.as) : "")) {
        for (const DamageClass damage : kDamageClasses)
            if (ImGui::Selectable(title_of(damage), damage == shown.as)) shown.as = damage;
        ImGui::EndCombo();
    }
    const auto there = std::ranges::find(t.damage, shown.as, &DamageRow::damage);
    if (shown.stale)
        replaces = "looked for with other settings: suggest again";
    else if (shown.shown > 0 && there != t.damage.end() && there->there && there->logged.count > 0)
        replaces = fmt::format("takes the place of {} mapped area{}", there->logged.count,
                               there->logged.count == 1 ? "" : "s");
    note(replaces, 1, kWarning);
    ImGui::BeginDisabled(shown.shown == 0 || shown.stale);
    if (ImGui::Button("Accept")) t.ask.accept = true;
    ImGui::EndDisabled();
    tip(s.keys.text(Action::accept) + ": takes the place of what this class has, and is entered in the log");
    ImGui::SameLine();
    if (ImGui::Button("Discard##suggestion")) t.ask.drop_suggestion = true;
    ImGui::EndDisabled();
}

void suggesting(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    int what = static_cast<int>(t.suggesting);
    if (ImGui::Combo("Look for", &what,
                     "losses\0craquelure\0other gloss\0old fills\0overpaint\0stains\0abrasion (seldom sure)\0"
                     "flaking\0"))
        t.suggesting = static_cast<Suggesting>(what);
    if (ImGui::Button("Suggest")) t.ask.suggest = true;
    tip(s.keys.text(Action::suggest) + ": beside the window; nothing changes before you accept it");
    suggested(s);
}

// Last: each kind has its own.
void how_it_is_looked_for(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    if (!ImGui::TreeNode("Detection settings")) return;
    if (t.suggesting == Suggesting::loss) options_of(t.loss, s.scale);
    if (t.suggesting == Suggesting::craquelure) options_of(t.craquelure, s.scale);
    if (t.suggesting == Suggesting::gloss) options_of(t.gloss, s.scale);
    if (t.suggesting > Suggesting::gloss) options_of(t.areas, s.scale);
    ImGui::TreePop();
}

void outline(const std::vector<ImVec2>& points, bool closed, ImU32 colour) {
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    const auto flags = closed ? ImDrawFlags_Closed : ImDrawFlags_None;
    const int count = static_cast<int>(points.size());
    draw->AddPolyline(points.data(), count, IM_COL32(0, 0, 0, 200), flags, 3);
    draw->AddPolyline(points.data(), count, colour, flags, 1.5f);
}

void picture(const WindowState& s, const Placement& place, float left, float from, float to) {
    const auto w = static_cast<double>(s.painting.width), h = static_cast<double>(s.painting.height);
    std::vector<ImVec2> corners;
    for (int y = 0; y <= kCells; ++y)
        for (int x = 0; x <= kCells; ++x)
            corners.push_back(in_window(place.to_screen({w * x / kCells - 0.5, h * y / kCells - 0.5}), left));
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->PushClipRect({from, 0}, {to, ImGui::GetIO().DisplaySize.y}, true);
    const auto texture =
        reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(s.treatment_state.map_texture));
    const auto alpha = static_cast<int>(255 * s.treatment_state.opacity);
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x) {
            const auto at = [&](int u, int v) {
                return corners[static_cast<std::size_t>((y + v) * (kCells + 1) + x + u)];
            };
            const auto uv = [&](int u, int v) {
                return ImVec2(static_cast<float>(x + u) / kCells, static_cast<float>(y + v) / kCells);
            };
            draw->AddImageQuad(texture, at(0, 0), at(1, 0), at(1, 1), at(0, 1), uv(0, 0), uv(1, 0), uv(1, 1),
                               uv(0, 1), IM_COL32(255, 255, 255, alpha));
        }
    draw->PopClipRect();
}

void tool(const WindowState& s, const Placement& place, float left, const glm::dvec2& cursor) {
    const TreatmentState& t = s.treatment_state;
    const Rgb c = t.erase ? Rgb(1) : legend_colour_srgb(t.current);
    const ImU32 ink = ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1});
    glm::dvec2 centre;
    if (!place.to_painting(cursor, centre)) return;
    std::vector<ImVec2> points;
    if (t.mask_tool == MaskTool::polygon) {
        for (const glm::dvec2& corner : t.polygon) points.push_back(in_window(place.to_screen(corner), left));
        if (points.empty()) return;
        points.push_back(in_window(cursor, left));
        outline(points, points.size() > 2, ink);
    } else if (t.mask_tool == MaskTool::brush) {
        const double radius = 0.5 * static_cast<double>(t.brush_mm) / t.mm_per_pixel;
        for (int i = 0; i < 40; ++i) {
            const double a = 2 * std::numbers::pi * i / 40;
            points.push_back(
                in_window(place.to_screen(centre + radius * glm::dvec2(std::cos(a), std::sin(a))), left));
        }
        outline(points, true, ink);
    }
}

}  // namespace

void damage(WindowState& s) {
    legend(s);
    map(s);
    ImGui::Separator();
    suggesting(s);
    ImGui::Separator();
    drawing(s);
    ImGui::Separator();
    how_it_is_looked_for(s);
}

void damage_map(const WindowState& s, const Placement& placement, Extent screen, const glm::dvec2& cursor,
                bool cursor_over) {
    const TreatmentState& t = s.treatment_state;
    if (!t.on) return;
    const auto wide = static_cast<float>(screen.width);
    if (t.map_texture && (t.map || t.additions) && !s.comparing.shows())
        picture(s, placement, s.canvas_left, s.canvas_left, s.canvas_left + wide);
    if (cursor_over && s.tool == Tool::damage && !s.comparing.on) tool(s, placement, s.canvas_left, cursor);
}

}  // namespace tangi::panels
