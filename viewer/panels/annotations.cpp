// annotations.cpp: the panel Annotations, and what lies over the painting of them.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <glm/common.hpp>
#include <utility>

#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

using Act = AnnotationAct::Kind;

constexpr int kRowsOfList = 6, kRowsOfText = 3;

void kinds(WindowState& s) {
    AnnotationState& a = s.annotations;
    for (const AnnotationKind kind :
         {AnnotationKind::point, AnnotationKind::line, AnnotationKind::polygon, AnnotationKind::text}) {
        if (kind != AnnotationKind::point) ImGui::SameLine();
        if (ImGui::RadioButton(name_of(kind), s.tool == Tool::annotate && a.kind == kind)) {
            a.kind = kind;
            a.draft.reset();
            s.tool = Tool::annotate;
        }
        tip(fmt::format("{}: the next of these", s.keys.text(Action::annotation_kind)));
    }
}

void list_of_annotations(WindowState& s) {
    AnnotationState& a = s.annotations;
    ImGui::BeginChild("list", {0, kRowsOfList * ImGui::GetTextLineHeightWithSpacing()}, true);
    if (a.items.empty()) ImGui::TextDisabled("none yet");
    for (std::size_t i = 0; i < a.items.size(); ++i) {
        const Annotation& item = *a.items[i];
        ImGui::PushID(item.id.c_str());
        if (ImGui::Selectable(fmt::format("{} · {}", i + 1, title_of(item)).c_str(), item.id == a.chosen))
            a.choose(item.id == a.chosen ? std::string() : item.id);
        if (item.id == a.chosen && a.scrolled_to != a.chosen) ImGui::SetScrollHereY();
        ImGui::PopID();
    }
    a.scrolled_to = a.chosen;
    ImGui::EndChild();
}

// The text of the chosen one. Enter ends it, so that one who draws by keys goes on with the next.
void text_field(WindowState& s) {
    AnnotationState& a = s.annotations;
    ImGui::PushID(a.chosen.c_str());  // else what is in the field would go to the next one that is chosen
    // Again and again: a press on the painting in the same frame takes the keyboard away.
    if (a.until_typed > 0) {
        ImGui::SetScrollHereY();
        ImGui::SetKeyboardFocusHere();
    }
    const float high = (kRowsOfText + 0.5f) * ImGui::GetTextLineHeight();
    const bool changed =
        ImGui::InputTextMultiline("##text", &a.typed, {-1, high}, ImGuiInputTextFlags_CtrlEnterForNewLine);
    if (ImGui::IsItemActivated()) a.typing = false;
    if (ImGui::IsItemActive()) a.until_typed = std::min(a.until_typed, AnnotationState::kFramesToKnow);
    if (changed) {
        // What Escape takes back is a step of its own, so that undo brings it again.
        const bool goes_on = a.typing && ImGui::IsItemActive();
        a.acts.push_back({Act::text, a.chosen, {}, a.typed, goes_on});
        a.typing = true;
    }
    if (!ImGui::IsItemActive()) a.typing = false;
    ImGui::PopID();
    tip("What is to be seen here. Enter ends it, Ctrl+Enter begins a new line");
}

void chosen_annotation(WindowState& s) {
    const bool none = s.annotations.chosen.empty();
    idle_while(none, "Of the annotation that is chosen", [&] {
        text_field(s);
        if (ImGui::Button("Keep this view")) s.ask.keep_view = true;
        tip(s.keys.text(Action::annotation_view) +
            ": it shows the light, view and look of now whenever it is chosen");
        ImGui::SameLine();
        if (ImGui::Button("Delete")) s.ask.remove_annotation = true;
        tip(s.keys.text(Action::delete_annotation));
    });
}

void files_of_annotations(WindowState& s) {
    AnnotationState& a = s.annotations;
    idle_while(!a.can_undo, nullptr, [&] {
        if (ImGui::Button("Undo")) s.ask.undo_annotation = true;
    });
    ImGui::SameLine();
    idle_while(!a.can_redo, nullptr, [&] {
        if (ImGui::Button("Redo")) s.ask.redo_annotation = true;
    });
    ImGui::SameLine();
    if (ImGui::Button("Load …")) s.ask.load_annotations_dialog = true;
    tip(s.keys.text(Action::load_annotations) +
        ": adds those of a file: of a web page, of a IIIF manifest, of the report of a treatment");
    ImGui::SameLine();
    idle_while(a.items.empty(), "There are none", [&] {
        if (ImGui::Button("Copy to …")) s.ask.copy_annotations_dialog = true;
    });
    tip(s.keys.text(Action::copy_annotations) + ": all of them, in another file");
    if (!a.refused.empty())
        note(a.refused, 1, kWarning);
    else
        note(a.unsaved         ? fmt::format("Not saved yet ({})", s.keys.text(Action::save))
             : a.items.empty() ? ""
                               : "Saved as " + a.file,
             1, a.unsaved ? kWarning : ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
}

// Lines over the painting. What lies behind the eye, where the painting is tilted and near, is left out.
class Over {
public:
    Over(const Placement& placement, float left) : placement_(placement), left_(left) {}

    bool sees(const glm::dvec2& at) const {
        glm::dvec2 back;
        return placement_.to_painting(placement_.to_screen(at), back);
    }
    ImVec2 at(const glm::dvec2& place) const { return in_window(placement_.to_screen(place), left_); }
    void line(glm::dvec2 a, glm::dvec2 b, ImU32 colour, float wide) const {
        if (!sees(a)) std::swap(a, b);
        if (!sees(a)) return;
        if (!sees(b)) b = last_seen(a, b);
        ImGui::GetBackgroundDrawList()->AddLine(at(a), at(b), colour, wide);
    }

private:
    // Towards b, which is not seen.
    glm::dvec2 last_seen(glm::dvec2 a, glm::dvec2 b) const {
        constexpr int kHalvings = 24;  // a pixel of a painting of 16 million a side
        for (int i = 0; i < kHalvings; ++i) (sees(0.5 * (a + b)) ? a : b) = 0.5 * (a + b);
        return a;
    }

    const Placement& placement_;
    float left_;
};

constexpr ImU32 kUnder = IM_COL32(0, 0, 0, 190), kLine = IM_COL32(255, 233, 168, 255),
                kChosen = IM_COL32(120, 220, 255, 255);

void ring_lines(const Over& over, const std::vector<glm::dvec2>& ring, bool closed, ImU32 colour,
                float scale) {
    const std::size_t lines = closed ? ring.size() : ring.size() - 1;
    for (const auto& [drawn, wide] : {std::pair(kUnder, 4.0f), std::pair(colour, 2.0f)})
        for (std::size_t i = 0; i < lines; ++i)
            over.line(ring[i], ring[(i + 1) % ring.size()], drawn, wide * scale);
}

// A word on a dark ground, its upper left corner at a place.
void word(const ImVec2& at, const std::string& text, ImU32 colour) {
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    draw->AddRectFilled({at.x - 3, at.y - 1}, {at.x + size.x + 3, at.y + size.y + 1}, kUnder, 3);
    draw->AddText(at, colour, text.c_str());
}

void mark(const WindowState& s, const Over& over, std::size_t i) {
    const Annotation& item = *s.annotations.items[i];
    const bool chosen = item.id == s.annotations.chosen;
    const ImU32 colour = chosen ? kChosen : kLine;
    const AnnotationKind kind = item.shape.kind;
    if (kind == AnnotationKind::line || kind == AnnotationKind::polygon)
        for (const auto& ring : item.shape.rings)
            ring_lines(over, ring, kind == AnnotationKind::polygon, colour,
                       chosen ? 1.4f * s.scale : s.scale);
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    if (chosen && s.tool == Tool::annotate)
        for (const auto& ring : item.shape.rings)
            for (const glm::dvec2& corner : ring)
                if (over.sees(corner)) draw->AddCircleFilled(over.at(corner), 4 * s.scale, colour);
    const glm::dvec2 first = item.shape.rings.front().front();
    if (!over.sees(first)) return;
    const ImVec2 at = over.at(first);
    const std::string number = fmt::format("{}", i + 1);
    const ImVec2 size = ImGui::CalcTextSize(number.c_str());
    if (kind == AnnotationKind::text) word({at.x + 17 * s.scale, at.y - size.y / 2}, title_of(item), colour);
    draw->AddCircleFilled(at, 11 * s.scale, kUnder);
    draw->AddCircle(at, 11 * s.scale, colour, 0, (chosen ? 3 : 2) * s.scale);
    draw->AddText({at.x - size.x / 2, at.y - size.y / 2}, colour, number.c_str());
}

void drawn_now(const WindowState& s, const Over& over) {
    const AnnotationState& a = s.annotations;
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    if (a.draft) {
        ring_lines(over, a.draft->points, false, kChosen, s.scale);
        for (const glm::dvec2& p : a.draft->points)
            if (over.sees(p)) draw->AddCircleFilled(over.at(p), 5 * s.scale, kChosen);
    }
    if (!a.cross || !over.sees(*a.cross)) return;
    const ImVec2 at = over.at(*a.cross);
    const float from = 4 * s.scale, to = 16 * s.scale;
    for (const auto& [colour, wide] : {std::pair(kUnder, 4.0f), std::pair(kChosen, 2.0f)})
        for (const float side : {-1.0f, 1.0f}) {
            draw->AddLine({at.x + side * from, at.y}, {at.x + side * to, at.y}, colour, wide * s.scale);
            draw->AddLine({at.x, at.y + side * from}, {at.x, at.y + side * to}, colour, wide * s.scale);
        }
}

}  // namespace

void annotations(WindowState& s) {
    kinds(s);
    ImGui::Checkbox(with_key(s, "Show them", Action::show_annotations).c_str(), &s.annotations.shown);
    list_of_annotations(s);
    chosen_annotation(s);
    files_of_annotations(s);
}

void annotations_over(const WindowState& s, const Placement& placement, float left, Extent pane) {
    const Over over(placement, left);
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    draw->PushClipRect({left, 0}, {left + static_cast<float>(pane.width), static_cast<float>(pane.height)});
    for (std::size_t i = 0; s.annotations.shown && i < s.annotations.items.size(); ++i) mark(s, over, i);
    if (s.tool == Tool::annotate) drawn_now(s, over);
    draw->PopClipRect();
}

}  // namespace tangi::panels
