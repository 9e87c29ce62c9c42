// journal_event.h: what happens at a canvas, as journals have it (docs/reference/journal-format.md: the
// format).
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "paint/brush/brush_settings.h"
#include "paint/optics/palette.h"
#include "paint/optics/pigment.h"
#include "paint/stroke/stroke.h"

namespace tangi {

enum class BrushStart {
    clean,  // washed, then loaded
    dirty,  // what is on it stays and is filled up
    same    // goes on with what is on it
};

using PaintParts = std::vector<std::pair<std::string, double>>;  // name in the palette, part

// {"event": "stroke", "brush": {"preset": "flat", "size_mm": 12}, "paint": {"Titanium White": 3, ...}, ...}
struct StrokeEvent {
    BrushSettings brush;
    Place on = Place::painting;
    PaintParts paint;    // empty: none is loaded
    PaintFinish finish;  // of the paint that is loaded
    double load = 1;     // [1] of a full brush
    BrushStart start = BrushStart::clean;
    StrokeOptions options;
    std::uint64_t seed = 0;
};
struct PointEvent {  // {"event": "point", "t": 0.1, "x": 3, "y": -4, "p": 0.5}: [s], [mm], [1]
    StrokePoint point;
};
struct EndEvent {};   // {"event": "end"}: the brush leaves the canvas
struct UndoEvent {};  // {"event": "undo"}
struct RedoEvent {};
struct DryEvent {  // {"event": "dry", "layer": "first sitting", "part": 1}
    std::string layer;
    double part = 1;
    CanvasPart where =
        WholeCanvas{};  // "circle": {"x": 3, "y": 4, "radius_mm": 10} or "polygon": [[x, y], ...]
};
struct LiftEvent {  // {"event": "lift", "layer": "first sitting"}
    std::string layer;
};
// A pile of paint, as squeezed from a tube: a dome.
// {"event": "pile", "paint": {"Titanium White": 1}, "x": -80, "y": 60, "size_mm": 20, "height_mm": 1.5}
struct PileEvent {
    Place on = Place::palette;
    PaintParts paint;
    PaintFinish finish;
    PointMm at;                            // its middle
    double size_mm = 20, height_mm = 1.5;  // width, and height in the middle
};
// The palette wiped clean, and piles of paints laid out along its rim (mixing_board.h).
// {"event": "palette", "width_mm": 200, "height_mm": 150, "paints": ["Titanium White", "Bone Black"]}
struct PaletteEvent {
    std::optional<double> width_mm, height_mm;  // before it is used first; its size does not change
    std::vector<std::string> paints;
    bool all_paints = false;  // "paints": "all": those of the palette file, in its order
};
// Brushes stop at a mask from here on (Canvas::confine()), or at none. It is not undone.
// {"event": "confine", "mask": "9f86d0…"}: the SHA-256 of its file
struct ConfineEvent {
    std::string mask;  // 64 hex digits; empty: none
};
// The paints that names mean from here on, as their palette file had them: whatever becomes of that file, the
// journal paints the same. It is not undone.
// {"event": "paints", "palette": {"format": "tangipaint palette", ...}}
struct PaintsEvent {
    std::shared_ptr<const Palette> palette;  // null, and no "palette": artist_acrylics()
};
struct WashEvent {};  // {"event": "wash"}: nothing is on the brush any more
using Event = std::variant<StrokeEvent, PointEvent, EndEvent, UndoEvent, RedoEvent, DryEvent, LiftEvent,
                           PileEvent, PaletteEvent, ConfineEvent, PaintsEvent, WashEvent>;

PaintsEvent paints_event(const Palette& palette);
// Whether it does nothing to painting and palette, but changes what later events do.
bool is_setting(const Event& event);
bool names_paints(const Event& event);

std::string_view name_of(const Event& event);  // "stroke", "point", …
nlohmann::json to_json(const Event& event);
// `presets`: those that strokes name. Throws Error that names `where`: not an object, an unknown event, field
// or brush, values of the wrong kind.
Event event_from_json(const nlohmann::json& json, const std::string& where,
                      const std::map<std::string, BrushSettings>& presets = brush_presets());

}  // namespace tangi
