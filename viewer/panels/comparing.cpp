// comparing.cpp: the panel Photographs, and the photograph beside the relit painting on the canvas.
#include <fmt/format.h>
#include <imgui.h>

#include <cmath>
#include <utility>

#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

constexpr ImU32 kInk = IM_COL32(235, 235, 235, 255), kBack = IM_COL32(0, 0, 0, 170);

void label(ImDrawList* draw, ImVec2 at, const std::string& text, bool from_right = false) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    if (from_right) at.x -= size.x;
    draw->AddRectFilled({at.x - 6, at.y - 4}, {at.x + size.x + 6, at.y + size.y + 4}, kBack, 4);
    draw->AddText(at, kInk, text.c_str());
}

// Where pictures of the painting are drawn; columns are the window's.
class PictureArea {
public:
    PictureArea(const WindowState& s, Extent screen)
        : left(s.canvas_left),
          right(s.canvas_left + static_cast<float>(screen.width)),
          middle(s.canvas_left + static_cast<float>(pane(s, screen).width)),
          bottom(static_cast<float>(screen.height)),
          place_(placement_of(s, screen)),
          painting_(s.painting) {}

    // A picture where the painting lies, `shifted` to the right of where the canvas begins; what is between
    // two columns of it is seen.
    void picture(unsigned texture, float shifted, float from, float to) const {
        const auto corner = [&](double x, double y) {
            const glm::dvec2 at = place_.to_screen({x, y});
            return ImVec2(static_cast<float>(at.x) + shifted, static_cast<float>(at.y));
        };
        const double x1 = painting_.width - 0.5, y1 = painting_.height - 0.5;
        draw->PushClipRect({from, 0}, {to, ImGui::GetIO().DisplaySize.y}, true);
        draw->AddImageQuad(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)),
                           corner(-0.5, -0.5), corner(x1, -0.5), corner(x1, y1), corner(-0.5, y1));
        draw->PopClipRect();
    }
    void whole(unsigned texture) const { picture(texture, left, left, right); }
    void line(float column, ImU32 colour, float width) const {
        draw->AddLine({column, 0}, {column, bottom}, colour, width);
    }

    ImDrawList* const draw = ImGui::GetBackgroundDrawList();
    const float left, right, middle, bottom;  // middle: where the second of two beside each other begins

private:
    const Placement place_;
    const Extent painting_;
};

constexpr float kLabelTop = 12;

// What is compared, and what it is called.
struct Compared {
    unsigned photo, relit;  // textures
    std::string name{}, other = "relit";
};

Compared compared(const Comparing& c, unsigned photo, unsigned relit) {
    Compared both{photo, relit};
    if (c.pair) {
        both.name = c.pair->left;
        both.other = c.pair->right;
        return both;
    }
    both.name = c.news.book->entries()[static_cast<std::size_t>(c.news.held->index)].name;
    if (c.news.held->reduced > 1) both.name += fmt::format(" (at 1/{})", c.news.held->reduced);
    return both;
}

void legend(ImDrawList* draw, const ColourScale& scale, const std::string& unit, ImVec2 at) {
    constexpr float kWide = 220, kHigh = 12;
    draw->AddRectFilled({at.x - 8, at.y - 6}, {at.x + kWide + 8, at.y + kHigh + 24}, kBack, 4);
    const auto count = static_cast<float>(scale.colours_srgb.size());
    for (std::size_t i = 0; i < scale.colours_srgb.size(); ++i) {
        const Rgb c = 255.0f * scale.colours_srgb[i];
        const float x = at.x + kWide * static_cast<float>(i) / count;
        draw->AddRectFilled(
            {x, at.y}, {x + kWide / count + 0.5f, at.y + kHigh},
            IM_COL32(static_cast<int>(c.r), static_cast<int>(c.g), static_cast<int>(c.b), 255));
    }
    const bool is_signed = scale.lowest < 0;
    const std::string begin = fmt::format("{:.0f}", scale.lowest);
    const std::string end = fmt::format("{}{:.0f}{}", is_signed ? "+" : "", scale.highest, unit);
    draw->AddText({at.x, at.y + kHigh + 2}, kInk, begin.c_str());
    draw->AddText({at.x + kWide - ImGui::CalcTextSize(end.c_str()).x, at.y + kHigh + 2}, kInk, end.c_str());
}

void draw_aside(const PictureArea& area, const Compared& both) {
    area.picture(both.photo, area.left, area.left, area.middle);
    area.picture(both.relit, area.middle, area.middle, area.right);
    area.line(area.middle, kBack, 3);
    label(area.draw, {area.left + 14, kLabelTop}, both.name);
    label(area.draw, {area.middle + 14, kLabelTop}, both.other);
}

void draw_wipe(const PictureArea& area, const Compared& both, float divider) {
    area.picture(both.photo, area.left, area.left, divider);
    area.picture(both.relit, area.left, divider, area.right);
    area.line(divider, IM_COL32(0, 0, 0, 255), 3);
    area.line(divider, kInk, 1);
    label(area.draw, {divider - 14, kLabelTop}, both.name, true);
    label(area.draw, {divider + 14, kLabelTop}, both.other);
}

// In false colour, with its legend.
void draw_difference(const PictureArea& area, const Compared& both, const Comparing& c) {
    const bool colour = c.way == CompareWay::delta_e;
    ColourScale scale = colour ? c.news.book->delta_e_scale() : c.news.book->difference_scale();
    if (!colour) {
        scale.lowest *= 100;
        scale.highest *= 100;
    }
    area.whole(both.photo);
    label(area.draw, {area.left + 14, kLabelTop},
          colour ? both.name + ": CIEDE2000" : both.name + ": relit - photograph");
    legend(area.draw, scale, colour ? " dE" : " %", {area.left + 20, kLabelTop + 34});
}

// Three lines, whatever there is to be told.
void numbers(const std::string& what, const Likeness* likeness, const std::string& otherwise) {
    constexpr int kLines = 3;
    if (!likeness)
        note(otherwise, kLines);
    else if (likeness->pixels == 0)
        note(what + ": nothing was measured there", kLines);
    else
        note(fmt::format("{} ({} pixels)\n  PSNR {:.1f} dB   SSIM {:.3f}\n  ΔE2000 {:.2f}, 95 % below {:.2f}",
                         what, likeness->pixels, likeness->psnr_db, likeness->ssim, likeness->delta_e_2000,
                         likeness->delta_e_2000_p95),
             kLines, ImGui::GetStyleColorVec4(ImGuiCol_Text));
}

void list(WindowState& s) {
    Comparing& c = s.comparing;
    ImGui::BeginChild("photos", {0, 6.2f * ImGui::GetTextLineHeightWithSpacing()}, true);
    if (!c.news.book) {
        ImGui::TextDisabled("opening %s", c.folder.c_str());
        ImGui::ProgressBar(static_cast<float>(c.news.fraction), {-1, 0}, c.news.stage.c_str());
        ImGui::EndChild();
        return;
    }
    const auto& entries = c.news.book->entries();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const auto index = static_cast<int>(i);
        const auto broken = c.news.broken.find(index);
        const bool whole = broken == c.news.broken.end();
        const std::string name = fmt::format("{}{}##{}", entries[i].name,
                                             !whole              ? " (rejected)"
                                             : entries[i].fitted ? ""
                                                                 : " (held out)",
                                             i);
        if (ImGui::Selectable(name.c_str(), index == c.news.wanted,
                              whole ? ImGuiSelectableFlags_None : ImGuiSelectableFlags_Disabled)) {
            s.ask.photo = index;
            c.on = true;
        }
        // Once, when it is chosen: else nobody could scroll away from it.
        if (index == c.news.wanted && std::exchange(c.scrolled_to, index) != index && !ImGui::IsItemVisible())
            ImGui::SetScrollHereY();
        if (!whole && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
            ImGui::SetTooltip("%s", broken->second.c_str());
    }
    ImGui::EndChild();
}

}  // namespace

void photographs(WindowState& s) {
    Comparing& c = s.comparing;
    if (!c.loaded) {
        if (!s.from_photographs) {
            ImGui::TextWrapped("This painting was not fitted to photographs.");
            return;
        }
        if (ImGui::Button("Compare with photographs …")) s.ask.photos_dialog = true;
        ImGui::TextDisabled("or drop their folder on the window");
        return;
    }
    ImGui::Checkbox(fmt::format("Compare ({})", s.keys.text(Action::compare)).c_str(), &c.on);
    ImGui::SameLine();
    if (ImGui::SmallButton("Close##photographs")) s.ask.put_photos_away = true;
    list(s);
    std::string warned;
    if (c.news.book)
        for (const std::string& warning : c.news.book->warnings())
            warned += (warned.empty() ? "" : "; ") + warning;
    note(warned, 1, kWarning);
    ImGui::BeginDisabled(!c.news.book);
    if (ImGui::ArrowButton("previous", ImGuiDir_Left)) s.ask.step_photo = -1;
    ImGui::SameLine();
    if (ImGui::ArrowButton("next", ImGuiDir_Right)) s.ask.step_photo = 1;
    ImGui::SameLine();
    ImGui::PushItemWidth(-1);
    if (ImGui::BeginCombo("##way", kCompareWays[static_cast<std::size_t>(c.way)].name)) {
        for (const CompareWayName& way : kCompareWays)
            if (ImGui::Selectable(way.name, way.way == c.way)) c.way = way.way;
        ImGui::EndCombo();
    }
    ImGui::PopItemWidth();
    idle_while(c.way != CompareWay::blink, "Of the way Blink",
               [&] { slide("Blink", c.blink_s, 0.15f, 3, "%.2f s"); });
    numbers("Whole", c.news.held ? &c.news.held->whole : nullptr, "measuring …");
    const bool part = c.news.part && c.news.held && c.news.part->index == c.news.held->index && s.region;
    numbers("Region", part ? &c.news.part->likeness : nullptr,
            fmt::format("Region tool ({}): numbers of a part", s.keys.text(Action::tool_region)));
    if (c.news.reporting) {
        ImGui::ProgressBar(static_cast<float>(c.news.fraction), {-60 * s.scale, 0}, "report");
        ImGui::SameLine();
        if (ImGui::Button("Stop")) s.ask.stop_report = true;
    } else {
        if (ImGui::Button("Report …")) s.ask.report_dialog = true;
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s: compare.html, compare.json and pictures of all photographs",
                              s.keys.text(Action::report).c_str());
    }
    ImGui::EndDisabled();
}

void held_photo(const WindowState& s, unsigned photo, unsigned relit, Extent screen) {
    const Comparing& c = s.comparing;
    const PictureArea area(s, screen);
    const Compared both = compared(c, photo, relit);
    switch (c.way) {
        case CompareWay::aside:
            draw_aside(area, both);
            break;
        case CompareWay::wipe:
            draw_wipe(area, both, area.left + std::round(c.divider * static_cast<float>(screen.width)));
            break;
        case CompareWay::blink:
            area.whole(c.blink_photo ? photo : relit);
            label(area.draw, {area.left + 14, kLabelTop}, c.blink_photo ? both.name : both.other);
            break;
        case CompareWay::difference:
        case CompareWay::delta_e:
            draw_difference(area, both, c);
            break;
    }
    if (c.news.busy && !c.pair)
        label(area.draw, {area.left + static_cast<float>(screen.width) / 2, area.bottom - 60}, "measuring …");
}

}  // namespace tangi::panels
