// looking.cpp: the panels Light and Look.
#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cmath>

#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

constexpr const char* kComparing =
    "What is compared is lit as the photograph was; Compare, under Photographs, goes back to the painting";

// The dome from above: drag the light.
void dome(WindowState& s) {
    const float radius = 59 * s.scale;  // beside it, the lights have room in the column
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 centre(corner.x + radius + 2, corner.y + radius + 2);
    ImGui::InvisibleButton("dome", {2 * radius + 4, 2 * radius + 4});
    if (ImGui::IsItemActive() && !s.comparing.on) {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        s.lights[s.light].angles = light_at({(mouse.x - centre.x) / radius, (centre.y - mouse.y) / radius});
        s.sweeping = false;
    }
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddCircleFilled(centre, radius, IM_COL32(40, 40, 44, 255), 64);
    for (const double elevation : {0.0, 30.0, 60.0})
        draw->AddCircle(centre, radius * static_cast<float>(std::cos(elevation * 3.14159265 / 180)),
                        IM_COL32(90, 90, 96, 255), 64);
    for (std::size_t i = 0; i < s.lights.size(); ++i) {
        const glm::dvec2 at = place_of(s.lights[i].angles);
        const ImVec2 spot(centre.x + radius * static_cast<float>(at.x),
                          centre.y - radius * static_cast<float>(at.y));
        const int shade = s.lights[i].on ? 255 : 110;
        draw->AddCircleFilled(spot, (i == s.light ? 7.0f : 5.0f) * s.scale,
                              IM_COL32(shade, shade * 220 / 255, shade / 2, 255));
    }
    if (!s.comparing.on) return;
    float y = centre.y - ImGui::GetTextLineHeight();
    for (const char* line : s.comparing.pair ? std::array{"two states", "in one light"}
                                             : std::array{"lit as the", "photograph"}) {
        const float wide = ImGui::CalcTextSize(line).x;
        draw->AddText({centre.x - wide / 2, y}, IM_COL32(255, 205, 80, 255), line);
        y += ImGui::GetTextLineHeight();
    }
}

void presets(ViewLight& light) {
    struct Preset {
        const char* name;
        double azimuth_deg, elevation_deg;
    };
    constexpr Preset kPresets[] = {{"Raking left 10", 180, 10}, {"Raking right 10", 0, 10},
                                   {"Raking top 10", 90, 10},   {"Raking left 25", 180, 25},
                                   {"Gallery 45", 90, 45},      {"Straight on", 90, 90}};
    if (!ImGui::BeginCombo("Presets", "choose")) return;
    for (const Preset& preset : kPresets)
        if (ImGui::Selectable(
                fmt::format("{} ({:.0f}°, {:.0f}°)", preset.name, preset.azimuth_deg, preset.elevation_deg)
                    .c_str()))
            light.angles = {preset.azimuth_deg, preset.elevation_deg};
    ImGui::EndCombo();
}

// What the false colours mean: the scale under the numbers at its ends and in its middle.
void scale_of_colours(const WindowState& s) {
    const auto number = [](double value) { return fmt::format("{:.3g}", value); };
    const MapScale& scale = traits_of(s.mode).scale;
    if (scale.curve == MapScale::Curve::none || scale.curve == MapScale::Curve::diverging) return;
    ScaleEnds ends = scale.fixed;
    std::string unit;
    if (scale.ends == MapScale::Ends::heights) {
        ends = {static_cast<double>(s.lowest_mm) * s.height_unit_mm(),
                static_cast<double>(s.highest_mm) * s.height_unit_mm()};
        unit = s.scale_known ? " mm" : " px";
    }
    const auto meaning = [](const std::string& words) { return words.empty() ? "" : ": " + words; };
    const std::array<std::string, 3> labels = {
        number(value_at(scale, ends, 0)) + meaning(scale.lowest_means), number(value_at(scale, ends, 0.5)),
        number(value_at(scale, ends, 1)) + unit + meaning(scale.highest_means)};
    constexpr int kScaleCells = 48;
    const float line = ImGui::GetTextLineHeight(), wide = ImGui::CalcItemWidth();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy({wide, 2 * line});
    ImDrawList* draw = ImGui::GetWindowDrawList();
    for (int i = 0; i < kScaleCells; ++i) {
        const Rgb c =
            Transfer{Transfer::Kind::srgb}.encode(false_colour((static_cast<float>(i) + 0.5f) / kScaleCells));
        draw->AddRectFilled({at.x + wide * static_cast<float>(i) / kScaleCells, at.y + line},
                            {at.x + wide * static_cast<float>(i + 1) / kScaleCells, at.y + 2 * line},
                            ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1}));
    }
    for (std::size_t i = 0; i < labels.size(); ++i) {
        const float room = wide - ImGui::CalcTextSize(labels[i].c_str()).x;
        draw->AddText({at.x + room * static_cast<float>(i) / 2, at.y}, IM_COL32(200, 200, 200, 255),
                      labels[i].c_str());
    }
}

// Those of the light that is moved.
void light_of(WindowState& s) {
    dome(s);
    ImGui::SameLine();
    ImGui::BeginGroup();
    // What more lights bring has its room all the time.
    for (std::size_t i = 0; i < kMostViewLights; ++i) {
        if (i > 0) ImGui::SameLine(0, 2);
        ImGui::BeginDisabled(i >= s.lights.size());
        if (ImGui::RadioButton(fmt::format("{}", i + 1).c_str(), s.light == i)) s.light = i;
        ImGui::EndDisabled();
        tip(fmt::format("Light {}", i + 1));
    }
    idle_while(s.lights.size() >= kMostViewLights, "There are four at most", [&] {
        if (!ImGui::SmallButton("Add a light")) return;
        s.lights.push_back({.angles = {-45, 30}, .gain = 0.4f});
        s.light = s.lights.size() - 1;
    });
    idle_while(s.lights.size() < 2, nullptr, [&] {
        if (!ImGui::SmallButton("Remove")) return;
        s.lights.erase(s.lights.begin() + static_cast<std::ptrdiff_t>(s.light));
        s.light = std::min(s.light, s.lights.size() - 1);
    });
    ImGui::Checkbox("Sweep", &s.sweeping);
    if (ImGui::SmallButton("Film …") && !s.film) s.ask.film_dialog = true;
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("%s: a video of this view, while this light goes once round at its elevation",
                          s.keys.text(Action::film).c_str());
    ImGui::EndGroup();
    ViewLight& light = s.lights[s.light];
    auto azimuth = static_cast<float>(light.angles.azimuth_deg),
         elevation = static_cast<float>(light.angles.elevation_deg);
    if (slide("Azimuth", azimuth, -180, 180, "%.1f°")) light.angles.azimuth_deg = azimuth;
    if (slide("Elevation", elevation, 2, 90, "%.1f°")) light.angles.elevation_deg = elevation;
    presets(light);
    slide("Strength", light.gain, 0, 4, "%.2f");
    ImGui::Checkbox("On", &light.on);
    ImGui::SameLine();
    ImGui::Checkbox("Near", &light.near);
    ImGui::SameLine();
    ImGui::Checkbox(with_key(s, "Shadows", Action::shadows).c_str(), &s.shadows);
    idle_while(!light.near, "Of a near light",
               [&] { slide("Distance", light.distance, 0.2f, 5, "%.2f widths"); });
    idle_while(!s.shadows, "Of shadows", [&] { slide("Softness", s.light_radius_deg, 0, 15, "%.1f°"); });
    slide("Ambient", s.ambient, 0, 0.5f, "%.2f");
}

void look_of(WindowState& s) {
    if (ImGui::BeginCombo("Show", traits_of(s.mode).name)) {
        for (const ViewModeTraits& mode : view_modes())
            if (ImGui::Selectable(mode.name, mode.mode == s.mode)) s.mode = mode.mode;
        ImGui::EndCombo();
    }
    const ViewModeTraits& mode = traits_of(s.mode);
    if (mode.strongest > 0) slide("Effect", s.strength, 0, 1, "%.2f");
    if (mode.gloss_exponent) slide("Sharpness", s.sharpness, 2, 200, "%.0f");
    scale_of_colours(s);
    if (mode.scale.ends == MapScale::Ends::heights)
        drag_ends("Heights", s.lowest_mm, s.highest_mm, 0.005f, "%.3f");
    if (mode.scale.ends == MapScale::Ends::curvature) {
        const auto unit = static_cast<float>(s.height_unit_mm());
        float most = s.most_curvature / unit;
        if (slide("Curvature", most, 0.005f, 50, s.scale_known ? "± %.3g /mm" : "± %.3g /px",
                  {.logarithmic = true}))
            s.most_curvature = most * unit;
        tip("Orange: bumps; blue: hollows, cracks, the edges of losses");
    }
    if (ImGui::BeginCombo(with_key(s, "Illuminant", Action::illuminant).c_str(),
                          light_named(s.illuminant_now()))) {
        for (const LightName& light : kLights)
            if (ImGui::Selectable(light.name, light.illuminant == s.illuminant)) s.see_in(light.illuminant);
        ImGui::EndCombo();
    }
    tip("What their light is made of: paints that match in one can differ in another. What is below the "
        "paint is seen by a reflectance guessed from its colour");
    slide("Exposure", s.exposure_stops, -4, 4, "%.1f stops");
    slide("Highlight compression", s.shoulder, 0, 0.9f, "%.2f");
    int model = static_cast<int>(s.model);
    leave_room_for("Ward model (expert)");
    const auto label_of = [](void*, int i, const char** label) {
        *label = kWardModels[static_cast<std::size_t>(i)].label;
        return true;
    };
    if (ImGui::Combo("Ward model (expert)", &model, label_of, nullptr, static_cast<int>(kWardModels.size())))
        s.model = static_cast<WardModel>(model);
    ImGui::Checkbox("Probe", &s.probing);
    ImGui::SameLine();
    ImGui::Checkbox(with_key(s, "Loupe", Action::loupe).c_str(), &s.loupe);
}

}  // namespace

void light(WindowState& s) {
    idle_while(s.comparing.on, kComparing, [&] { light_of(s); });
}

void look(WindowState& s) {
    idle_while(s.comparing.on, kComparing, [&] { look_of(s); });
}

}  // namespace tangi::panels
