// window_state.h: everything that the window's panels show and change. No OpenGL, no GLFW.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "paint/brush_settings.h"
#include "paint/journal.h"
#include "paint/palette.h"
#include "viewer/look.h"
#include "viewer/painter.h"
#include "viewer/tilt.h"
#include "viewer/view.h"

namespace tangi {

enum class Tool { tilt, light, pan, paint, pick, ruler };

struct ToolName {
    Tool tool;
    const char* name;
    char key;
    const char* help;
};
inline constexpr std::array<ToolName, 6> kTools = {
    {{Tool::tilt, "Tilt", 'T', "drag: tilt the painting; the light stays (right button: with any tool)"},
     {Tool::light, "Light", 'L', "drag: move the light, as on a dome over the painting"},
     {Tool::pan, "Pan", 'H', "drag: move the painting (middle button: with any tool)"},
     {Tool::paint, "Paint", 'B', "drag: paint; Alt-click: take a paint up; Shift-drag: brush size"},
     {Tool::pick, "Pick", 'I', "click: mix what lies there"},
     {Tool::ruler, "Ruler", 'M', "drag: measure"}}};

struct Lamp {
    Angles angles{135, 50};
    float gain = 1;
    bool on = true;
    bool near = false;      // at a distance, instead of far away
    float distance = 1.5f;  // in widths of the painting
};

struct WindowState {
    WindowState();

    // The painting, as opened.
    std::string title;
    Extent painting;
    double mm_per_pixel = 1;         // of its heights
    double stroke_mm_per_pixel = 1;  // of strokes and brushes: where no scale is known, one can be given
    bool scale_known = false;
    ReflectanceLaw law{};
    float lowest_mm = 0, highest_mm = 1;

    // Looking.
    View view;
    Tilt tilt;
    bool flat = false;
    std::vector<Lamp> lamps{Lamp{}};
    std::size_t lamp = 0;  // that is moved
    bool sweeping = false;
    float ambient = 0.03f, exposure_stops = 0, shoulder = 0.15f, light_radius_deg = 1.5f;
    bool shadows = true;
    WardModel model = WardModel::bounded;
    LookMode mode = LookMode::painting;
    float strength = 0.7f, sharpness = 40;
    bool loupe = false, probing = true;

    // Painting.
    Tool tool = Tool::tilt;
    Palette palette;
    std::map<std::string, BrushSettings> brushes;
    std::string brush_name = "flat";
    BrushSettings brush;
    float pressure = 0.6f, stabiliser_mm = 0;
    bool dirty_brush = false;
    std::map<std::string, float> mix;  // parts of paints on the brush
    std::vector<Rgb> paint_colours;    // [sRGB] of the palette's paints, opaque

    // What the painter told, and the user.
    PainterState painter;
    std::optional<Probe> probe;
    std::string message;
    double message_until_s = 0;
    int left_over_strokes = 0;                               // that a crash left: recover or discard
    bool closing = false;                                    // with unsaved strokes: asked what to do
    std::optional<std::pair<glm::dvec2, glm::dvec2>> ruler;  // [pixels of the painting]
    double frame_ms = 0;
    bool help = false;

    // What the panels ask for; the window does it and clears them.
    struct Requests {
        bool fit = false, one_to_one = false, straighten = false, undo = false, redo = false, save = false,
             dry = false, snapshot = false, recover = false, discard = false, close = false,
             close_unsaved = false;
        std::string lift;  // name of a layer
    } ask;

    void use_brush(const std::string& name);
    // The mixture on the brush as linear Rec. 709, laid on thickly.
    Rgb mixed_colour() const;
    StrokeEvent stroke(std::uint64_t seed) const;
    void take_up(const Probe& picked);
};

// The lamps and settings as the renderer takes them.
Scene scene_of(const WindowState& state, const Placement& placement);

}  // namespace tangi
