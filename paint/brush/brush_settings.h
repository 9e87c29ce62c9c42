// brush_settings.h: what kind of brush, knife or rag: everything about a tool that is not its paint.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "paint/brush/brush_shape.h"
#include "surface/base/options.h"

namespace tangi {

struct BrushSettings {
    BrushShape shape = BrushShape::round;
    double size_mm = 8;            // width of the contact at full pressure
    double thickness = 1;          // [1] its other extent over the width
    double load_mm = 2.5;          // paint over the area of the contact, when freshly loaded
    double hold_mm = 8;            // paint that the bristles hold at most; the fuller, the less they take
    double load_variation = 0.35;  // [1] how much the load differs between bristles
    double deposit = 0.35;         // [1] part of the load given over one length of the contact
    double pickup = 1.5;           // [1] part of the wet paint taken over the same length, as a rate
    double push = 0.7;             // [1] part of the paint above the bristles that moves with them
    double spread = 0.6;           // [1] part of the pushing that goes sideways
    double gap_mm = 0.10;          // underside over the canvas when touched lightly; less when pressed
    double groove_mm = 0.15;       // by how much bristles differ in length
    double bristle_mm = 0.35;      // distance between bristles
    double depth_mm = 0.8;         // from the tip's rim to its middle: what pressure flattens
    double splay = 0.15;           // [1] widening at full pressure
    double bend = 0.2;             // [1] how far the tip trails behind the handle, over the size
    double lift = 0.15;            // [1] how much higher the leading edge is, over the depth
    double film_mm = 0.006;        // paint that always stays
    double reach_mm = 0.06;        // gap that bristles without paint still bridge
    double load_reach = 0.25;      // [1] further gap for each mm of load
    double grain = 0.25;           // [1] random variation of the transfer from bristle to bristle
    double yield_slope = 1.2;      // [1] slope that wet paint holds without flowing down
    bool follow = false;           // turns with the stroke, as a hand turns a flat brush
    bool erases = false;           // what it takes is gone; the brush in the hand keeps what is on it

    static constexpr std::string_view name = "brush";
    template <class Self, class Visit>
    static void fields(Self& self, Visit&& visit) {
        visit(FieldInfo{"size_mm", 0.01, 1000, "mm", "width of the contact at full pressure"}, self.size_mm);
        visit(FieldInfo{"thickness", 0.02, 4, "1", "its other extent over the width"}, self.thickness);
        visit(FieldInfo{"load_mm", 0, 20, "mm", "paint on a freshly loaded brush, over its area"},
              self.load_mm);
        visit(FieldInfo{"hold_mm", 0.01, 1000, "mm", "paint that the bristles hold at most, over the area"},
              self.hold_mm);
        visit(FieldInfo{"load_variation", 0, 1, "1", "how much the load differs between bristles"},
              self.load_variation);
        visit(FieldInfo{"deposit", 0, 20, "1", "rate at which load is given, over one length of contact"},
              self.deposit);
        visit(FieldInfo{"pickup", 0, 20, "1", "rate at which wet paint is taken, over one length of contact"},
              self.pickup);
        visit(FieldInfo{"push", 0, 1, "1", "part of the paint above the bristles that moves with them"},
              self.push);
        visit(FieldInfo{"spread", 0, 1, "1", "how much of the pushing goes sideways"}, self.spread);
        visit(FieldInfo{"gap_mm", 0, 10, "mm", "underside over the canvas at a light touch"}, self.gap_mm);
        visit(FieldInfo{"groove_mm", 0, 10, "mm", "by how much bristles differ in length"}, self.groove_mm);
        visit(FieldInfo{"bristle_mm", 0.01, 10, "mm", "distance between bristles"}, self.bristle_mm);
        visit(FieldInfo{"depth_mm", 0.001, 50, "mm", "from the rim of the tip to its middle"}, self.depth_mm);
        visit(FieldInfo{"splay", 0, 1, "1", "widening at full pressure"}, self.splay);
        visit(FieldInfo{"bend", 0, 1, "1", "how far the tip trails behind, over the size"}, self.bend);
        visit(FieldInfo{"lift", 0, 2, "1", "height of the leading edge over the depth"}, self.lift);
        visit(FieldInfo{"film_mm", 0, 1, "mm", "paint that always stays"}, self.film_mm);
        visit(FieldInfo{"reach_mm", 0.001, 10, "mm", "gap that bristles without paint bridge"},
              self.reach_mm);
        visit(FieldInfo{"load_reach", 0, 2, "1", "further gap for each mm of load"}, self.load_reach);
        visit(FieldInfo{"grain", 0, 1, "1", "random variation of the transfer"}, self.grain);
        visit(FieldInfo{"yield_slope", 0.01, 20, "1", "slope that wet paint holds"}, self.yield_slope);
        visit(FieldInfo{"follow", 0, 1, "", "turns with the stroke"}, self.follow);
        visit(FieldInfo{"erases", 0, 1, "", "what it takes is gone"}, self.erases);
    }
    friend bool operator==(const BrushSettings&, const BrushSettings&) = default;
};

// The tools that come with the program, by name: round, flat, filbert, fan, knife, rag, and what is done with
// them: smudge, scrape, eraser, height eraser.
const std::map<std::string, BrushSettings>& brush_presets();

// Settings from JSON: {"preset": "flat", "size_mm": 12, ...}; fields that are not given are the preset's, or
// the defaults. Throws Error that names `where` and the field: unknown, of the wrong kind, outside its
// interval.
BrushSettings brush_from_json(const nlohmann::json& brush, const std::string& where,
                              const std::map<std::string, BrushSettings>& presets = brush_presets());
nlohmann::json brush_to_json(const BrushSettings& settings);

// A presets file: {"format": "tangipaint brushes", "version": 1, "brushes": {"name": {...}, ...}}, and the
// program's own presets where it has none of the same name; where it has, `warnings` says so. Throws Error
// naming the file and the brush.
std::map<std::string, BrushSettings> read_brush_presets(const std::filesystem::path& path,
                                                        std::vector<std::string>* warnings = nullptr);

}  // namespace tangi
