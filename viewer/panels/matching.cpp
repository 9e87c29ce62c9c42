// matching.cpp: the panel Colour of a treatment: recipes from one's own paints.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

// The colour there, and the recipe beside it without a gap.
void swatches(const Rgb& wanted, const Rgb& recipe, float scale) {
    const ImVec2 at = ImGui::GetCursorScreenPos(), size(130 * scale, 22 * scale);
    ImGui::Dummy(size);
    const auto ink = [](const Rgb& c) { return ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1}); };
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddRectFilled(at, {at.x + size.x / 2, at.y + size.y}, ink(wanted));
    draw->AddRectFilled({at.x + size.x / 2, at.y}, {at.x + size.x, at.y + size.y}, ink(recipe));
    tip("left: the painting's colour, right: the recipe's, under D65");
}

void recipe(WindowState& s, const ShownMatch& match, const ShownRecipe& r) {
    swatches(match.srgb, r.look_srgb, s.scale);
    ImGui::SameLine();
    if (ImGui::Button("Load brush")) {
        s.mix = r.mix;
        s.finish = {};
        s.board.carried = Carried::chosen;
        s.tool = Tool::paint;
    }
    tip("The brush is loaded with this mixture, and paints");
    ImGui::TextWrapped("%s", r.text.c_str());
    std::string lights = "ΔE2000 ";
    for (std::size_t light = 0; light < kIlluminants; ++light)
        lights += fmt::format(" {} {:.1f}", name_of(static_cast<Illuminant>(light)), r.delta_e[light]);
    ImGui::TextUnformatted(lights.c_str());
    tip("Predicted difference from the painting's colour under each light; 1 is about what can just be seen");
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s", r.gloss.c_str());
    ImGui::PopStyleColor();
    ImGui::PushStyleColor(ImGuiCol_Text, kWarning);
    for (const std::string& warning : r.warnings) ImGui::TextWrapped("%s", warning.c_str());
    ImGui::PopStyleColor();
}

// The list of pairs that are kept apart, to be edited.
void pairs(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    if (!ImGui::TreeNode("Incompatible pigments")) return;
    const auto words = [](const std::vector<std::string>& all) {
        return fmt::format("{}", fmt::join(all, ", "));
    };
    for (std::size_t i = 0; i < t.pairs.size(); ++i) {
        const PigmentPair& pair = t.pairs[i];
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::SmallButton("x")) t.ask.drop_pair = static_cast<int>(i);
        tip("No longer kept apart");
        ImGui::SameLine();
        ImGui::TextWrapped("%s | %s", words(pair.first).c_str(), words(pair.second).c_str());
        tip(pair.why + (pair.source.empty() ? "" : "\n" + pair.source));
        ImGui::PopID();
    }
    ImGui::InputText("Of these", &t.new_pair.first);
    tip("Words of the names of paints, or their colour index, with commas between them: azurite, PB30");
    ImGui::InputText("and these", &t.new_pair.second);
    ImGui::InputText("because", &t.new_pair.why);
    if (ImGui::Button("Keep apart")) t.ask.add_pair = true;
    ImGui::SameLine();
    if (ImGui::Button("The usual ones")) t.ask.usual_pairs = true;
    tip("The list that came with the program, in place of yours");
    ImGui::TreePop();
}

}  // namespace

void matching(WindowState& s) {
    TreatmentState& t = s.treatment_state;
    ImGui::TextDisabled("%s, %zu paints", s.palette.name.c_str(), s.palette.paints.size());
    ImGui::SameLine();
    if (ImGui::SmallButton("Other …")) s.ask.palette_dialog = true;
    tip("Another paint box: a palette file (.json). The painting is opened again with it");
    ImGui::TextUnformatted("Matches under");
    for (std::size_t light = 0; light < kIlluminants; ++light) {
        if (light) ImGui::SameLine();
        ImGui::Checkbox(std::string(name_of(static_cast<Illuminant>(light))).c_str(), &t.illuminants[light]);
    }
    slide("Paints", t.most_paints, 1, kMostPaints, "%d at most");
    ImGui::Checkbox("As a thin film", &t.film);
    tip("Over what lies in the damage now, as thick as the retouch; else as paint that hides what is below");
    ImGui::SameLine();
    ImGui::Checkbox("Avoid bad pairs", &t.avoid_pairs);
    tip("Leaves out mixtures of pigments that practice keeps apart; else they are warned of");
    pairs(s);
    if (ImGui::Button("Match surroundings")) t.ask.match_around = true;
    tip("The commonest colour beside the damage that is worked on");
    ImGui::SameLine();
    if (ImGui::Button("Match point")) s.tool = Tool::sample;
    tip(s.keys.text(Action::tool_sample) + ": then click on the painting");
    if (!t.match) return;
    ImGui::Separator();
    const ShownMatch& match = *t.match;
    ImGui::TextWrapped("Colour %s", match.of.c_str());
    ImGui::Text("L*a*b* %.1f %.1f %.1f", match.lab.l, match.lab.a, match.lab.b);
    note(match.stale ? "made with other settings: match again" : "", 1, kWarning);
    for (const ShownRecipe& r : match.recipes) {
        ImGui::PushID(&r);
        ImGui::Separator();
        idle_while(match.stale, "The settings have been changed since it was made",
                   [&] { recipe(s, match, r); });
        ImGui::PopID();
    }
}

}  // namespace tangi::panels
