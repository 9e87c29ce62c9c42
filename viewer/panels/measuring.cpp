// measuring.cpp: the height along the ruler, and what a region is like.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

void profile(WindowState& s) {
    const HeightProfile& p = *s.profile;
    const char* unit = p.scale_known ? "mm" : "px";
    const auto [low, high] = std::minmax_element(p.height_mm.begin(), p.height_mm.end());
    const double length = static_cast<double>(p.height_mm.size() - 1) * p.step_mm;
    ImGui::Text("%.2f %s long, heights from %.3f to %.3f %s", length, unit, static_cast<double>(*low),
                static_cast<double>(*high), unit);
    ImGui::PlotLines("##heights", p.height_mm.data(), static_cast<int>(p.height_mm.size()), 0, nullptr, *low,
                     std::max(*high, *low + 1e-6f), {ImGui::GetContentRegionAvail().x, 110 * s.scale});
    if (ImGui::Button("Copy as CSV")) ImGui::SetClipboardText(csv_of(p).c_str());
}

void statistics(const WindowState& s) {
    const RegionStatistics& r = *s.statistics;
    ImGui::Text("%d × %d pixels at %d %d", r.region.width(), r.region.height(), r.region.x0, r.region.y0);
    if (r.pixels == 0) {
        ImGui::TextDisabled("nothing was measured there");
        return;
    }
    const auto named = [&](const char* name, const std::string& value) {
        ImGui::TextUnformatted(name);
        ImGui::SameLine(110 * s.scale);
        ImGui::TextUnformatted(value.c_str());
    };
    const auto line = [&](const char* name, const MeanAndSpread& value) {
        named(name, fmt::format("{:.4f} ± {:.4f}", value.mean, value.deviation));
    };
    named("colour ρd", fmt::format("L*a*b* {:.1f} {:.1f} {:.1f}, spread ΔE2000 {:.1f}", r.lab_of_mean.l,
                                   r.lab_of_mean.a, r.lab_of_mean.b, r.colour_spread));
    line("gloss ρs", r.specular);
    line("roughness α", r.roughness);
    line(s.scale_known ? "height mm" : "height px", r.height_mm);
    named("rms slope", fmt::format("{:.4f}", r.rms_slope));
    line("confidence", r.confidence);
    ImGui::TextDisabled("mean ± standard deviation of the pixels");
}

}  // namespace

void measurements(WindowState& s) {
    const auto begin = [&](const char* name, float from_bottom, bool& open) {
        const ImVec2 size = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos({size.x - 12, size.y - from_bottom}, ImGuiCond_Appearing, {1, 1});
        ImGui::SetNextWindowSize({430 * s.scale, 0});
        ImGui::Begin(name, &open,
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings |
                         ImGuiWindowFlags_NoFocusOnAppearing);
    };
    if (s.profile && s.profile->height_mm.size() >= 2) {
        bool open = true;
        // Whichever comes second lies above the other one.
        begin("Height along the ruler", (s.statistics && s.region ? 250 : 40) * s.scale, open);
        profile(s);
        ImGui::End();
        if (!open) {
            s.profile.reset();
            s.ruler.reset();
        }
    }
    if (s.statistics && s.region) {
        bool open = true;
        begin("Region", (s.profile ? 250 : 40) * s.scale, open);
        statistics(s);
        ImGui::End();
        if (!open) {
            s.statistics.reset();
            s.region.reset();
        }
    }
}

}  // namespace tangi::panels
