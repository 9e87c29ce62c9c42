#include "viewer/model/window_state.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tangi {

namespace {

auto place_of(Illuminant illuminant) {
    return std::ranges::find(kLights, illuminant, &LightName::illuminant);
}

}  // namespace

const char* light_named(Illuminant illuminant) { return place_of(illuminant)->name; }

Illuminant light_after(Illuminant illuminant) {
    const auto next = place_of(illuminant) + 1;
    return next == kLights.end() ? kLights.front().illuminant : next->illuminant;
}

glm::dvec2 NewCanvas::pixels() const {
    if (!substrate_named(choice.which)) return {size.width, size.height};
    return glm::round(glm::dvec2(choice.piece.width_mm, choice.piece.height_mm) / choice.piece.pixel_mm);
}

double NewCanvas::bytes() const {
    constexpr double kBytesAPixel = 101;  // docs/guide/viewer.md
    return kBytesAPixel * pixels().x * pixels().y;
}

WindowState::WindowState() {
    brushes = brush_presets();
    use_brush("flat");
    use_palette(artist_acrylics());
}

void WindowState::use_palette(Palette other) {
    palette = std::move(other);
    see_in(illuminant);
    std::erase_if(mix, [&](const auto& part) { return palette.find(part.first) < 0; });
    if (mix.empty() && !palette.paints.empty()) mix[palette.paints.front().name] = 1;
}

void WindowState::see_in(Illuminant lit_by) {
    illuminant = lit_by;
    paint_colours.clear();
    for (const Pigment& paint : palette.paints)
        paint_colours.push_back(Transfer{Transfer::Kind::srgb}.encode(
            thick_film(std::span(&paint, 1), std::array{1.0f}, lit_by)));
}

void WindowState::use_brush(const std::string& name) {
    const auto found = brushes.find(name);
    if (found == brushes.end()) return;
    // The size stays the hand's choice where it was made.
    brush_name = name;
    brush = found->second;
}

Rgb WindowState::mixed_colour() const {
    std::vector<Pigment> paints;
    std::vector<float> parts;
    for (const auto& [name, part] : mix)
        if (part > 0) {
            paints.push_back(finished(palette.at(name), finish));
            parts.push_back(part);
        }
    return paints.empty() ? Rgb(0) : thick_film(paints, parts, illuminant);
}

OnBrush WindowState::on_brush() const {
    if (painter.stroking || board.carried == Carried::taken_up) return painter.on_brush;
    // A dirty brush is filled up with the mixture; what it had is told once it paints.
    if (!(brush.load_mm > 0)) return dirty_brush ? painter.on_brush : OnBrush();
    double sum = 0;
    for (const auto& [name, part] : mix) sum += static_cast<double>(part);
    OnBrush full{.fill = 1, .colour = mixed_colour()};
    for (const auto& [name, part] : mix)
        if (part > 0) full.recipe.emplace_back(name, static_cast<double>(part) / sum);
    std::ranges::sort(full.recipe, std::greater(), &std::pair<std::string, double>::second);
    return full;
}

glm::dvec2 WindowState::mixed_gloss() const {
    double specular = 0, roughness = 0, sum = 0;
    for (const auto& [name, part] : mix) {
        const Pigment& paint = palette.at(name);
        specular += part * paint.specular;
        roughness += part * paint.roughness;
        sum += part;
    }
    if (sum <= 0) return {finish.specular.value_or(0), finish.roughness.value_or(1)};
    return {finish.specular.value_or(specular / sum), finish.roughness.value_or(roughness / sum)};
}

StrokeEvent WindowState::stroke(std::uint64_t seed) const {
    StrokeEvent event;
    event.brush = brush;
    if (board.carried == Carried::taken_up) {
        event.start = BrushStart::same;
    } else {
        if (brush.load_mm > 0)
            for (const auto& [name, part] : mix)
                if (part > 0) event.paint.emplace_back(name, part);
        event.finish = finish;
        event.start = dirty_brush ? BrushStart::dirty : BrushStart::clean;
    }
    event.options.stabiliser_mm = stabiliser_mm;
    event.seed = seed;
    return event;
}

StrokeEvent WindowState::board_stroke(std::uint64_t seed) {
    StrokeEvent event = stroke(seed);
    event.on = Place::palette;
    if (board.carried == Carried::nothing) {
        event.paint.clear();
        event.finish = {};
        event.start = dirty_brush ? BrushStart::same : BrushStart::clean;
    }
    board.carried = Carried::taken_up;
    return event;
}

StrokeEvent WindowState::erasing_stroke(std::uint64_t seed) const {
    StrokeEvent event = stroke(seed);
    const auto eraser = brushes.find("eraser");
    if (eraser == brushes.end()) return event;
    event.brush = eraser->second;
    event.brush.size_mm = brush.size_mm;
    event.paint.clear();
    event.finish = {};
    event.start = BrushStart::clean;
    return event;
}

bool WindowState::take_up(const Probe& picked) {
    std::map<std::string, float> found;
    for (const auto& [name, part] : picked.recipe)
        if (palette.find(name) >= 0 && part > 0.005) found[name] = static_cast<float>(part);
    if (found.empty()) return false;
    mix = std::move(found);
    board.carried = Carried::chosen;
    return true;
}

std::string title_of(const std::filesystem::path& painting) {
    const std::filesystem::path name = painting.filename(), folder = painting.parent_path().filename();
    return (folder.extension() == ".treatment" ? folder / name : name).string();
}

Extent pane(const WindowState& state, Extent screen) {
    return {state.comparing.aside() ? std::max(screen.width / 2, 1) : screen.width, screen.height};
}

Placement placement_of(const WindowState& state, Extent screen) {
    Placement::Pose pose{.flat = state.flat};
    if (!state.comparing.on) {  // photographs are held straight
        pose.tilt = state.tilt;
        pose.viewer = state.viewer;
    }
    return Placement(state.view, pose, state.painting, pane(state, screen), state.mm_per_pixel);
}

Scene scene_of(const WindowState& state, const Placement& placement) {
    Scene scene;
    for (const ViewLight& seen : state.lights) {
        if (!seen.on || scene.lights.size() == kMostLights) continue;
        const Vec3 direction =
            placement.in_surface(direction_of(seen.angles.azimuth_deg, seen.angles.elevation_deg));
        Light light = distant_light(direction);
        if (seen.near)
            light = near_light(direction *
                               static_cast<float>(seen.distance * state.painting.width * state.mm_per_pixel));
        light.gain = Rgb(seen.gain);
        scene.lights.push_back(light);
    }
    scene.reflectance_model = state.reflectance_model;
    scene.model = state.model;
    scene.shadows = state.shadows ? Shadows::horizon : Shadows::none;
    scene.light_radius_deg = state.light_radius_deg;
    scene.ambient = state.ambient;
    scene.exposure = glm::mat3(std::exp2(state.exposure_stops));
    scene.shoulder = state.shoulder;
    scene.mode = state.mode;
    const ViewModeTraits& mode = traits_of(state.mode);
    scene.strength = mode.strongest * std::min(state.strength, 1.0f);
    scene.sharpness = mode.coarser_levels > 0 ? static_cast<float>(mode.coarser_levels) : state.sharpness;
    scene.lowest_mm = state.lowest_mm;
    scene.highest_mm = state.highest_mm;
    scene.most_curvature = state.most_curvature;
    return scene;
}

}  // namespace tangi
