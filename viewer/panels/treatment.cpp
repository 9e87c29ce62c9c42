// treatment.cpp: the panels of a treatment: how it begins, its steps, its record.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

bool number(const char* label, double& value, float low, float high, const char* format,
            bool logarithmic = false) {
    return slide(label, value, low, high, format, {.logarithmic = logarithmic});
}

template <class Value, std::size_t N>
void choice(const char* label, Value& value, const std::array<std::pair<Value, const char*>, N>& all) {
    const auto now = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.first == value; });
    if (!ImGui::BeginCombo(label, now == all.end() ? "" : now->second)) return;
    for (const auto& [one, name] : all)
        if (ImGui::Selectable(name, one == value)) value = one;
    ImGui::EndCombo();
}

// What is under way, and what is not in the log yet: below the panels, with its room there all the time.
float footer_height() {
    return ImGui::GetTextLineHeightWithSpacing() + 2 * ImGui::GetFrameHeightWithSpacing();
}

void footer(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    if (!t.checking && !t.usable)
        note("The treatment is not as its log says: Record", 1, kFault);
    else
        note(t.edits > 0
                 ? fmt::format("{} correction{} of the map not in the log", t.edits, t.edits == 1 ? "" : "s")
                 : "",
             1, kWarning);
    idle_while(t.edits == 0, "Corrections of the damage map", [&] {
        if (ImGui::Button("Record step##damage")) t.ask.keep = true;
        tip(s.keys.text(Action::keep_damage));
        ImGui::SameLine();
        if (ImGui::Button("Discard##edits")) t.ask.drop_edits = true;
    });
    if (!t.job) return;
    const std::string stage =
        t.job->stage.empty() ? t.job_title : fmt::format("{}: {}", t.job_title, t.job->stage);
    ImGui::ProgressBar(static_cast<float>(t.job->fraction), {-50 * s.scale, 0}, stage.c_str());
    ImGui::SameLine();
    if (t.job->stopping)
        ImGui::TextDisabled("stops");
    else if (ImGui::SmallButton("Stop"))
        t.ask.stop = true;
}

// Which damage steps work on.
void works_on(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    std::string names;
    for (const DamageClass damage : t.where)
        names += (names.empty() ? "" : ", ") + std::string(title_of(damage));
    ImGui::BeginDisabled(s.painter.unsaved);
    if (ImGui::BeginCombo("Area", names.empty() ? "choose damage" : names.c_str())) {
        for (const DamageRow& row : t.damage) {
            if (!row.there) continue;
            bool on = t.where.contains(row.damage);
            if (!ImGui::Checkbox(title_of(row.damage), &on)) continue;
            if (on)
                t.where.insert(row.damage);
            else
                t.where.erase(row.damage);
        }
        ImGui::EndCombo();
    }
    ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
        ImGui::SetTooltip("%s", s.painter.unsaved
                                    ? "What was painted is to be entered in the log (Ctrl+S) before "
                                      "you go on elsewhere"
                                    : "The damage that is filled, isolated and retouched. Only what "
                                      "is on the damage map can be chosen");
}

void fill(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    using Texture = std::pair<FillTexture, const char*>;
    choice("Surface", t.texture,
           std::array<Texture, 3>{Texture(FillTexture::surroundings, "as its surroundings"),
                                  Texture(FillTexture::weave, "as the weave"),
                                  Texture(FillTexture::smooth, "smooth")});
    tip("Where the relief of the fill comes from");
    number("Level", t.fill.offset_mm, -0.5f, 0.2f, length(s, "%.2f").c_str());
    tip("Above the level of the surroundings; below 0, the fill lies lower");
    idle_while(t.texture != FillTexture::weave, "Of a surface as the weave",
               [&] { number("Threads", t.fill.weave_mm, 0.1f, 5, (length(s, "%.2f") + " apart").c_str()); });
    colour_field("Colour", t.fill_srgb);
    if (ImGui::Button("Fill")) t.ask.fill = true;
    tip(s.keys.text(Action::fill_losses) + ": a layer of its own, which comes off again");
}

void varnish(const WindowState& s, VarnishOptions& v) {
    number("Thickness", v.thickness_mm, 0.002f, 0.2f, length(s, "%.3f").c_str(), true);
    number("Gloss", v.specular, 0, 0.1f, "ρs %.3f");
    tip("How much is reflected as gloss: ρs, 0.04 of a resin");
    number("Roughness", v.roughness, 0.03f, 0.5f, "α %.2f");
    tip("Width of the highlight: 0.05 is glossy, 0.3 matt");
    number("Yellowing", v.yellowing, 0, 20, s.scale_known ? "%.1f /mm" : "%.1f /px");
}

void by_hand(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    idle_while(s.painter.unsaved, "What was painted is to be entered in the log first", [&] {
        ImGui::Checkbox("Paint stops at the damage", &t.confined);
        tip("Brushes neither give nor take paint outside of it");
        slide("Feather", t.feather_mm, 0, 5, length(s, "%.1f").c_str());
        tip("Width over which paint fades out within the damage; it never goes beyond it");
    });
    if (ImGui::Button("Retouch with the brush")) {
        s.tool = Tool::paint;
        t.map = false;  // else one would paint below it
    }
    tip(s.keys.text(Action::tool_paint));
    ImGui::SameLine();
    idle_while(!s.painter.unsaved, "Nothing was painted that is not in the log", [&] {
        if (ImGui::Button("Record step")) s.ask.save = true;
        tip(s.keys.text(Action::save) +
            ": what was painted becomes a layer of dry paint, with its strokes in the log");
    });
    const bool painted = s.painter.painted_px > 0;
    note(painted ? fmt::format("{} pixels painted", s.painter.painted_px) : "", 1,
         ImGui::GetStyleColorVec4(ImGuiCol_Text));
    note(painted ? fmt::format("{} pixels of it on original", s.painter.outside_px) : "", 1,
         s.painter.outside_px > 0 ? kFault : kGood);
    note(t.confined && t.edits > 0 && t.no_strokes.empty()
             ? fmt::format("brushes stop at the damage map as it is in the log, without the corrections that "
                           "are not ({})",
                           s.keys.text(Action::keep_damage))
             : t.no_strokes,
         3, ImGui::GetStyleColorVec4(ImGuiCol_Text));
}

// What a retouch that is previewed is like, in a room of its own.
void previewed(const std::optional<ShownRetouch>& preview) {
    constexpr float kLines = 7;
    ImGui::BeginChild("previewed", {0, kLines * ImGui::GetTextLineHeightWithSpacing()});
    if (!preview) {
        ImGui::TextDisabled("no preview");
        ImGui::EndChild();
        return;
    }
    const ShownRetouch& p = *preview;
    if (p.stale) ImGui::TextColored(kWarning, "laid with other settings: preview again");
    ImGui::Text("ΔE2000 from the surroundings' colour");
    std::string lights;
    for (std::size_t light = 0; light < kIlluminants; ++light)
        lights += fmt::format("{}{} {:.1f}", light ? "  " : "", name_of(static_cast<Illuminant>(light)),
                              p.delta_e[light]);
    ImGui::TextWrapped("%s", lights.c_str());
    if (!p.lines.empty()) ImGui::TextWrapped("%s", p.lines.c_str());
    if (p.outside_px > 0) ImGui::TextColored(kFault, "%d pixels on original", p.outside_px);
    for (const std::string& pile : p.piles) ImGui::TextWrapped("%s", pile.c_str());
    ImGui::EndChild();
}

void laid(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    using Mode = std::pair<RetouchMode, const char*>;
    choice("Kind", t.mode,
           std::array<Mode, 6>{
               Mode(RetouchMode::mimetic, "Mimetic"), Mode(RetouchMode::tratteggio, "Tratteggio"),
               Mode(RetouchMode::selection, "Selezione cromatica"),
               Mode(RetouchMode::abstraction, "Astrazione cromatica"),
               Mode(RetouchMode::dotting, "Pointillism"), Mode(RetouchMode::neutral, "Neutral tone")});
    number("Film", t.retouch.thickness_mm, 0.005f, 0.3f, (length(s, "%.3f") + " thick").c_str(), true);
    const bool even = t.mode == RetouchMode::mimetic || t.mode == RetouchMode::neutral;
    idle_while(even, "Of lines and dots", [&] {
        const auto pixel = static_cast<float>(t.mm_per_pixel);
        number("Pitch", t.retouch.pitch_mm, std::max(0.1f, 2 * pixel), 10 + 2 * pixel,
               length(s, "%.2f").c_str(), true);
        tip("From the middle of one line or dot to the next");
        number("Width", t.retouch.width_mm, std::max(0.05f, pixel), 10 + pixel, length(s, "%.2f").c_str(),
               true);
    });
    const bool stale = t.preview && t.preview->stale;
    idle_while(t.preview && !stale, "It is as the settings are", [&] {
        if (ImGui::Button("Preview")) t.ask.preview = true;
        tip("Lays it from your paints, to be looked at; nothing is changed");
    });
    ImGui::SameLine();
    const char* why = stale ? "The settings have been changed since it was laid: preview it again" : nullptr;
    idle_while(!t.preview || stale, why, [&] {
        if (ImGui::Button("Apply")) t.ask.apply = true;
        tip(s.keys.text(Action::accept) + ": as a layer, entered in the log");
    });
    ImGui::SameLine();
    idle_while(!t.preview, nullptr, [&] {
        if (ImGui::Button("Discard##preview")) t.ask.drop_preview = true;
    });
    previewed(t.preview);
}

void states(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    if (ImGui::RadioButton("Now", !t.state)) t.state.reset();
    tip(s.keys.text(Action::next_state) + ": the next state");
    for (int i = 0; i < 5; ++i) {
        const auto state = static_cast<TreatmentStage>(i);
        if (state == TreatmentStage::cleaned) continue;  // as it was photographed: one with Before
        if (i != 2) ImGui::SameLine();
        if (ImGui::RadioButton(title_of(state), t.state == state)) t.state = state;
    }
    using State = std::pair<std::optional<TreatmentStage>, const char*>;
    // Before and cleaned differ where the treatment has the painting as it was before (treatment earlier).
    static constexpr std::array<State, 6> kStates = {
        State(TreatmentStage::before, "Before"),       State(TreatmentStage::cleaned, "Cleaned"),
        State(TreatmentStage::filled, "Filled"),       State(TreatmentStage::retouched, "Retouched"),
        State(TreatmentStage::varnished, "Varnished"), State(std::nullopt, "Now")};
    ImGui::PushItemWidth(100 * s.scale);
    choice("##left", t.left, kStates);
    ImGui::SameLine();
    choice("##right", t.right, kStates);
    ImGui::PopItemWidth();
    ImGui::SameLine();
    if (ImGui::Button("Compare")) t.ask.compare_states = true;
    tip(s.keys.text(Action::compare_states) + ": two states under the light, side by side or wiped (" +
        s.keys.text(Action::compare_way) + ")");
    ImGui::Checkbox("Additions in false colour", &t.additions);
    tip(s.keys.text(Action::additions) +
        ": fills green, varnish yellow, retouches blue, red what lies on original");
    ImGui::PushItemWidth(150 * s.scale);
    slide("##distance", t.distance_m, 0.3f, 10, "%.1f m");
    ImGui::PopItemWidth();
    ImGui::SameLine();
    if (ImGui::Button("Viewing distance")) t.ask.see_from = true;
    tip("As the eye has it from this distance: lines that fuse cannot be told apart");
    idle_while(!s.comparing.pair, "While two are compared", [&] {
        if (ImGui::Button(fmt::format("Back to the painting ({})", s.keys.text(Action::compare)).c_str()))
            t.ask.stop_comparing = true;
    });
}

void by(TreatmentState& t) {
    ImGui::InputTextWithHint("By", t.usual_who.c_str(), &t.who);
    tip("Your name, as the log has it");
}

}  // namespace

void treatment(WindowState& s) {
    ImGui::TextWrapped(
        "A treatment keeps the painting as it is, and all that is done to it as layers and in a log.");
    if (ImGui::Button("New / open treatment")) s.treatment_state.ask.begin = true;
    tip(s.keys.text(Action::treatment) + ": in a folder beside the painting, with a copy of it");
    ImGui::SameLine();
    if (ImGui::Button("Open …")) s.treatment_state.ask.open_dialog = true;
    by(s.treatment_state);
    idle_while(s.scale_known, "The painting's scale is known", [&] {
        type_number("Width", s.treatment_state.width_mm, 0, 1e5, "%.1f mm");
        tip("Of the painting, whose scale is unknown; without it, a pixel counts as one mm");
    });
}

void steps(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    works_on(s);
    folding("States", true, [&] { states(s); });
    folding("Fill", false, [&] { fill(s); });
    folding("Isolating varnish", false, [&] {
        varnish(s, t.isolating);
        if (ImGui::Button("Isolate")) t.ask.isolate = true;
        tip(s.keys.text(Action::isolate) + ": between original and retouch, where one works");
    });
    folding("Retouch by hand", true, [&] { by_hand(s); });
    folding("Automatic retouching", false, [&] { laid(s); });
    folding("Varnish", false, [&] {
        varnish(s, t.varnish);
        if (ImGui::Button("Varnish all")) t.ask.varnish = true;
        tip(s.keys.text(Action::varnish));
    });
    folding("Layers", true, [&] { treatment_layers(s); });  // last: there are more with each step
}

void record(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    by(t);
    if (ImGui::Button("Check again")) t.ask.check = true;
    tip("Compares masks, layers and the original with the log");
    ImGui::SameLine();
    if (ImGui::Button("Report …")) t.ask.report_wanted = true;
    tip(s.keys.text(Action::treatment_report) + ": a page to print, with annotations and masks beside it");
    ImGui::TextWrapped("%s", std::filesystem::path(t.folder).filename().string().c_str());
    tip(t.folder);
    if (t.checking)
        ImGui::TextDisabled("is being checked …");
    else if (t.faults.empty())
        ImGui::TextColored(kGood, "is as its log of %zu lines says", t.log.size());
    for (const std::string& fault : t.faults) {
        ImGui::PushStyleColor(ImGuiCol_Text, kFault);
        ImGui::TextWrapped("%s", fault.c_str());
        ImGui::PopStyleColor();
    }
    const auto hash = [&](const char* of, const std::string& sha256) {
        ImGui::TextDisabled("%s", of);
        ImGui::SameLine(70 * s.scale);
        ImGui::TextDisabled("%.16s …", sha256.c_str());
    };
    hash("original", t.dry_sha256);
    tip("SHA-256 of the dry layer, which never changes: " + t.dry_sha256);
    if (!t.log.empty()) {
        hash("log", t.log.front().sha256);
        tip("SHA-256 of the last line of the log, which a report names: " + t.log.front().sha256);
    }
    ImGui::Separator();
    for (const LogRow& row : t.log) {
        ImGui::TextWrapped("%d  %s", row.line, row.action.c_str());
        tip(row.sha256);
        ImGui::TextDisabled("    %s, %s", row.time.c_str(), row.who.c_str());
    }
}

void treatment_parts(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    if (ImGui::BeginTabBar("parts")) {
        const auto tab = [&](const char* name, void (*panel)(WindowState&)) {
            const bool forward = std::string_view(name) == t.forward;
            if (forward) t.forward = "";
            if (!ImGui::BeginTabItem(name, nullptr, forward ? ImGuiTabItemFlags_SetSelected : 0)) return;
            ImGui::BeginChild(name, {0, -footer_height()});
            ImGui::PushItemWidth(-90 * s.scale);
            panel(s);
            ImGui::PopItemWidth();
            ImGui::EndChild();
            ImGui::EndTabItem();
        };
        tab("Damage", damage);
        tab("Steps", steps);
        tab("Colour", matching);
        tab("Record", record);
        ImGui::EndTabBar();
    }
    footer(s);
}

void treatment_column(WindowState& s, float height) {
    const float wide = treatment_width(s);
    if (wide == 0) return;
    ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - wide, 0});
    ImGui::SetNextWindowSize({wide, height});
    ImGui::Begin("treatment", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    treatment_parts(s);
    ImGui::End();
}

}  // namespace tangi::panels
