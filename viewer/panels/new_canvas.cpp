// new_canvas.cpp: the panel in which a new canvas is chosen.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <limits>

#include "viewer/model/substrate_preview.h"
#include "viewer/panels/number_field.h"
#include "viewer/panels/panels.h"

namespace tangi::panels {

namespace {

void ground(NewCanvas& n, WindowState& s) {
    SubstrateChoice& c = n.choice;
    const bool is_file = !n.picture.empty() && c.which == n.picture;
    const std::string now = is_file ? std::filesystem::path(c.which).filename().string() : c.which;
    if (ImGui::BeginCombo("Ground", now.c_str())) {
        for (const std::string& name : substrate_names())
            if (ImGui::Selectable(name.c_str(), c.which == name)) c.which = name;
        if (!n.kept.empty()) ImGui::Separator();
        for (const std::string& name : n.kept)
            if (ImGui::Selectable(fmt::format("{} (kept)", name).c_str(), c.which == name)) {
                c.which = name;
                n.size = {};
            }
        ImGui::EndCombo();
    }
    ImGui::SameLine();
    if (ImGui::Button("A file …")) s.ask.substrate_dialog = true;
    tip("A picture (PNG, TIFF, JPEG), or the dry layer of a painting");
}

// Of a procedure's piece, or of a picture's pixels.
void size(NewCanvas& n, WindowState& s) {
    SubstrateChoice& c = n.choice;
    const bool is_piece = substrate_named(c.which).has_value();
    if (is_piece) {
        type_number("Width, mm", c.piece.width_mm, 1, 1e5, "%.1f");
        type_number("Height, mm", c.piece.height_mm, 1, 1e5, "%.1f");
    }
    if (is_piece || is_picture(c.which)) {
        type_number("Pixel, mm", c.piece.pixel_mm, 0.005, 100, "%.3f");
        tip("Fine bristles and weave need 0.1 to 0.2 mm");
    }
    if (is_piece) {
        int seed = static_cast<int>(c.piece.seed);
        if (type_number("Variation (seed)", seed, 0, std::numeric_limits<int>::max()))
            c.piece.seed = static_cast<std::uint64_t>(seed);
        tip("Each number is another piece of the same cloth");
    } else if (is_picture(c.which)) {
        type_number("Relief, mm", c.picture.relief_mm, 0, 100, "%.2f");
        const bool other = c.height_from != "luminance" && c.height_from != "none";
        const std::string from =
            other ? std::filesystem::path(c.height_from).filename().string() : c.height_from;
        if (ImGui::BeginCombo("Relief from", from.c_str())) {
            for (const char* name : {"luminance", "none"})
                if (ImGui::Selectable(name, c.height_from == name)) c.height_from = name;
            if (ImGui::Selectable("a height map …", other)) s.ask.height_dialog = true;
            ImGui::EndCombo();
        }
    }
    const glm::dvec2 pixels = n.pixels();
    note(pixels.x > 0 ? fmt::format("{:.0f} × {:.0f} pixels, {:.0f} MB to paint on", pixels.x, pixels.y,
                                    1e-6 * n.bytes())
                      : "");
}

// One that has a value of its own where none is chosen.
void own_or(const char* label, std::optional<double>& value, double start, float low, float high) {
    bool chosen = value.has_value();
    ImGui::PushID(label);
    if (ImGui::Checkbox("##chosen", &chosen)) value = chosen ? std::optional(start) : std::nullopt;
    ImGui::SameLine();
    auto v = static_cast<float>(value.value_or(start));
    ImGui::BeginDisabled(!chosen);
    if (slide(label, v, low, high, chosen ? "%.3f" : "its own")) value = v;
    ImGui::EndDisabled();
    ImGui::PopID();
}

void finish(SubstrateFinish& f) {
    const Transfer srgb{Transfer::Kind::srgb};
    Rgb tint = srgb.encode(f.tint);
    if (colour_field("Ground tone", tint)) {
        for (int i = 0; i < 3; ++i) f.tint[i] = srgb.decode(std::clamp(tint[i], 0.0f, 1.0f));
    }
    tip("Toned: its colour is multiplied by this");
    own_or("Gloss", f.specular, 0.03, 0, 0.2f);
    own_or("Roughness", f.roughness, 0.3, 0.03f, 0.6f);
}

}  // namespace

void new_canvas(WindowState& s) {
    NewCanvas& n = s.new_canvas;
    if (!n.open) return;
    ImGui::SetNextWindowPos({width(s) + 40 * s.scale, 40 * s.scale}, ImGuiCond_Appearing);
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x, screen.y - 40 * s.scale});
    if (ImGui::Begin("New canvas", &n.open,
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                         ImGuiWindowFlags_NoCollapse)) {
        ImGui::PushItemWidth(170 * s.scale);
        ground(n, s);
        size(n, s);
        finish(n.choice.finish);
        const ImVec2 room(s.scale * SubstratePreview::kWidth, s.scale * SubstratePreview::kHeight),
            corner = ImGui::GetCursorScreenPos();
        ImGui::Dummy(room);
        tip("A piece of it, pixel by pixel, under the light as it stands");
        if (n.texture != 0)
            ImGui::GetWindowDrawList()->AddImage(
                reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(n.texture)), corner,
                {corner.x + s.scale * static_cast<float>(n.preview.width),
                 corner.y + s.scale * static_cast<float>(n.preview.height)});
        ImGui::InputText("Save as preset", &n.choice.keep_as);
        tip("A name under which this ground is there for the next canvas; empty: it is not kept");
        if (ImGui::InputText("File", &n.name)) n.complaint.clear();
        ImGui::TextDisabled("in %s", n.folder.string().c_str());
        if (ImGui::Button("Create")) s.ask.begin_canvas = true;
        ImGui::SameLine();
        if (ImGui::Button("Cancel (Esc)")) n.open = false;
        note(n.complaint, 3, kWarning);  // below what is clicked
        ImGui::PopItemWidth();
    }
    ImGui::End();
}

}  // namespace tangi::panels
