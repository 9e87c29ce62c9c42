// journal_json.cpp: events of a journal as JSON, and back.
#include <array>
#include <set>

#include "paint/session/journal.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"

namespace tangi {

namespace {

using nlohmann::json;

// The fields of one event. Each is asked for by name; those that nobody asked for are mistakes.
class Fields {
public:
    Fields(const json& object, const std::string& where) : object_(object), where_(where) {
        asked_.insert("event");
    }

    const json* find(const char* name) {
        asked_.insert(name);
        const auto found = object_.find(name);
        return found == object_.end() ? nullptr : &*found;
    }
    double number(const char* name, std::optional<double> otherwise = {}) {
        const json* value = find(name);
        if (!value && otherwise) return *otherwise;
        if (!value) fail("{}: has no '{}'", where_, name);
        if (!value->is_number()) fail("{}: '{}' is {}, not a number", where_, name, shown(*value));
        return value->get<double>();
    }
    double number_within(const char* name, double minimum, double maximum,
                         std::optional<double> otherwise = {}) {
        const double value = number(name, otherwise);
        if (!(value >= minimum && value <= maximum))
            fail("{}: '{}' = {} is outside [{}, {}]", where_, name, value, minimum, maximum);
        return value;
    }
    std::string text(const char* name) {
        const json* value = find(name);
        if (!value) fail("{}: has no '{}'", where_, name);
        if (!value->is_string() || value->get<std::string>().empty())
            fail("{}: '{}' is {}; it must be a text that is not empty", where_, name, shown(*value));
        return value->get<std::string>();
    }
    void end() const {
        for (const auto& [key, value] : object_.items())
            if (!asked_.contains(key))
                fail("{}: has a field '{}' that this event does not have", where_, shortened(key));
    }

private:
    const json& object_;
    const std::string& where_;
    std::set<std::string> asked_;
};

BrushStart start_of(const json* value, const std::string& where) {
    if (!value || *value == "clean") return BrushStart::clean;
    if (*value == "dirty") return BrushStart::dirty;
    if (*value == "same") return BrushStart::same;
    fail("{}: 'start' is {}, not clean, dirty or same", where, shown(*value));
}

constexpr double kMostParts = 1e6;  // of one paint beside one of another

PaintParts paint_from(Fields& fields, const std::string& where) {
    PaintParts parts;
    const json* paint = fields.find("paint");
    if (!paint) return parts;
    if (!paint->is_object())
        fail("{}: 'paint' is {}, not an object of names and parts", where, shown(*paint));
    for (const auto& [name, part] : paint->items()) {
        if (!part.is_number() || !(part.get<double>() > 0) || !(part.get<double>() <= kMostParts))
            fail("{}: 'paint' has {} parts of {}; a part is a number above 0, {} at most", where, shown(part),
                 shortened(name), kMostParts);
        parts.emplace_back(name, part.get<double>());
    }
    return parts;
}

PaintFinish finish_from(Fields& fields) {
    PaintFinish finish;
    PaintFinish::fields(finish, [&](const FieldInfo& info, auto& value) {
        const std::string name(info.name);
        if (fields.find(name.c_str())) value = fields.number_within(name.c_str(), info.minimum, info.maximum);
    });
    return finish;
}

Place place_from(Fields& fields, const std::string& where, Place otherwise) {
    const json* value = fields.find("on");
    if (!value) return otherwise;
    if (*value == "painting") return Place::painting;
    if (*value == "palette") return Place::palette;
    fail("{}: 'on' is {}, not painting or palette", where, shown(*value));
}

constexpr double kFarthest_mm = 1e6;  // any canvas is smaller

PointMm corner_from(const json& value, const std::string& where) {
    const bool pair = value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
    if (!pair) fail("{}: 'polygon' has a corner {}, not [x, y] in mm", where, shown(value));
    const PointMm corner{value[0].get<double>(), value[1].get<double>()};
    if (!(std::abs(corner.x) <= kFarthest_mm && std::abs(corner.y) <= kFarthest_mm))
        fail("{}: 'polygon' has a corner {} beyond {} mm", where, shown(value), kFarthest_mm);
    return corner;
}

CanvasPart part_from(Fields& fields, const std::string& where) {
    const json *circle = fields.find("circle"), *polygon = fields.find("polygon");
    if (circle && polygon) fail("{}: has both 'circle' and 'polygon'; give one", where);
    if (circle) {
        if (!circle->is_object()) fail("{}: 'circle' is {}, not an object", where, shown(*circle));
        const std::string inside = where + ": 'circle'";
        Fields of(*circle, inside);
        CirclePart result;
        result.centre = {of.number_within("x", -kFarthest_mm, kFarthest_mm),
                         of.number_within("y", -kFarthest_mm, kFarthest_mm)};
        result.radius_mm = of.number_within("radius_mm", 1e-3, kFarthest_mm);
        of.end();
        return result;
    }
    if (!polygon) return WholeCanvas{};
    if (!polygon->is_array() || polygon->size() < 3 || polygon->size() > 10000)
        fail("{}: 'polygon' must be a list of 3 to 10000 corners [x, y]", where);
    PolygonPart result;
    for (const json& corner : *polygon) result.corners.push_back(corner_from(corner, where));
    return result;
}

Event dry_from(Fields& fields, const std::string& where) {
    DryEvent event;
    event.layer = fields.text("layer");
    if (!is_one_line(event.layer))
        fail("{}: 'layer' is a name in one line, without control characters", where);
    if (event.layer.size() > kMostOfName)
        fail("{}: 'layer' is a name of {} bytes; {} at most", where, event.layer.size(), kMostOfName);
    event.part = fields.number_within("part", 1e-6, 1, 1);
    event.where = part_from(fields, where);
    return event;
}

Event pile_from(Fields& fields, const std::string& where) {
    PileEvent event;
    event.on = place_from(fields, where, event.on);
    event.paint = paint_from(fields, where);
    if (event.paint.empty()) fail("{}: a pile needs 'paint'", where);
    event.finish = finish_from(fields);
    event.at = {fields.number_within("x", -kFarthest_mm, kFarthest_mm),
                fields.number_within("y", -kFarthest_mm, kFarthest_mm)};
    event.size_mm = fields.number_within("size_mm", 0.1, 1000, event.size_mm);
    event.height_mm = fields.number_within("height_mm", 1e-3, 50, event.height_mm);
    return event;
}

Event palette_from(Fields& fields, const std::string& where) {
    PaletteEvent event;
    if (fields.find("width_mm")) event.width_mm = fields.number_within("width_mm", 0.1, 1e5);
    if (fields.find("height_mm")) event.height_mm = fields.number_within("height_mm", 0.1, 1e5);
    if (event.width_mm.has_value() != event.height_mm.has_value())
        fail("{}: 'width_mm' and 'height_mm' belong together", where);
    if (const json* paints = fields.find("paints")) {
        event.all_paints = *paints == "all";
        const bool names = paints->is_array() && std::all_of(paints->begin(), paints->end(),
                                                             [](auto& name) { return name.is_string(); });
        if (!event.all_paints && !names)
            fail("{}: 'paints' is {}, not a list of names or \"all\"", where, shown(*paints));
        if (names) event.paints = paints->get<std::vector<std::string>>();
    }
    return event;
}

Event confine_from(Fields& fields, const std::string& where) {
    ConfineEvent event;
    if (fields.find("mask")) event.mask = fields.text("mask");
    const bool is_hash =
        event.mask.size() == 64 && event.mask.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (!event.mask.empty() && !is_hash)
        fail("{}: 'mask' is {}, not a SHA-256 in 64 hex digits", where, shown(json(event.mask)));
    return event;
}

Event paints_from(Fields& fields, const std::string& where) {
    const json* palette = fields.find("palette");
    if (!palette) return PaintsEvent{};
    return PaintsEvent{std::make_shared<Palette>(parse_palette(palette->dump(), where + ": 'palette'"))};
}

Event stroke_from(Fields& fields, const std::string& where,
                  const std::map<std::string, BrushSettings>& presets) {
    StrokeEvent event;
    if (const json* brush = fields.find("brush")) event.brush = brush_from_json(*brush, where, presets);
    event.on = place_from(fields, where, event.on);
    event.paint = paint_from(fields, where);
    event.finish = finish_from(fields);
    event.load = fields.number_within("load", 0, 10, 1);
    event.start = start_of(fields.find("start"), where);
    event.options.stabiliser_mm = fields.number_within("stabiliser_mm", 0, 100, 0);
    event.options.pressure_gamma = fields.number_within("pressure_gamma", 0.1, 10, 1);
    const double seed = fields.number_within("seed", 0, 9e15, 0);
    if (seed != std::floor(seed)) fail("{}: 'seed' is {}, not a whole number", where, seed);
    event.seed = static_cast<std::uint64_t>(seed);
    return event;
}

Event point_from(Fields& fields) {
    StrokePoint p;
    p.time_s = fields.number_within("t", 0, 1e9, 0);
    p.x_mm = fields.number_within("x", -kFarthest_mm, kFarthest_mm);
    p.y_mm = fields.number_within("y", -kFarthest_mm, kFarthest_mm);
    p.pressure = fields.number_within("p", 0, 1, 0.5);
    p.tilt_x = fields.number_within("tx", -1, 1, 0);
    p.tilt_y = fields.number_within("ty", -1, 1, 0);
    p.rotation_deg = fields.number_within("r", -1e5, 1e5, 0);
    return PointEvent{p};
}

json parts_json(const PaintParts& parts) {
    json paint = json::object();
    for (const auto& [name, part] : parts) paint[name] = part;
    return paint;
}

void put_finish(const PaintFinish& finish, json& into) {
    if (finish.specular) into["specular"] = *finish.specular;
    if (finish.roughness) into["roughness"] = *finish.roughness;
    if (finish.medium != 0) into["medium"] = finish.medium;
}

void put_part(const CanvasPart& part, json& into) {
    if (const auto* circle = std::get_if<CirclePart>(&part))
        into["circle"] = {{"x", circle->centre.x}, {"y", circle->centre.y}, {"radius_mm", circle->radius_mm}};
    if (const auto* polygon = std::get_if<PolygonPart>(&part))
        for (const PointMm& corner : polygon->corners) into["polygon"].push_back({corner.x, corner.y});
}

struct ToJson {
    json operator()(const StrokeEvent& e) const {
        static constexpr const char* starts[] = {"clean", "dirty", "same"};
        json result = {{"event", "stroke"},
                       {"brush", brush_to_json(e.brush)},
                       {"paint", parts_json(e.paint)},
                       {"load", e.load},
                       {"start", starts[static_cast<int>(e.start)]},
                       {"stabiliser_mm", e.options.stabiliser_mm},
                       {"pressure_gamma", e.options.pressure_gamma},
                       {"seed", e.seed}};
        if (e.on == Place::palette) result["on"] = "palette";
        put_finish(e.finish, result);
        return result;
    }
    json operator()(const PointEvent& e) const {
        const StrokePoint& p = e.point;
        json result = {{"event", "point"}, {"t", p.time_s}, {"x", p.x_mm}, {"y", p.y_mm}, {"p", p.pressure}};
        if (p.tilt_x != 0) result["tx"] = p.tilt_x;
        if (p.tilt_y != 0) result["ty"] = p.tilt_y;
        if (p.rotation_deg != 0) result["r"] = p.rotation_deg;
        return result;
    }
    json operator()(const EndEvent&) const { return {{"event", "end"}}; }
    json operator()(const UndoEvent&) const { return {{"event", "undo"}}; }
    json operator()(const RedoEvent&) const { return {{"event", "redo"}}; }
    json operator()(const DryEvent& e) const {
        json result = {{"event", "dry"}, {"layer", e.layer}, {"part", e.part}};
        put_part(e.where, result);
        return result;
    }
    json operator()(const LiftEvent& e) const { return {{"event", "lift"}, {"layer", e.layer}}; }
    json operator()(const PileEvent& e) const {
        json result = {{"event", "pile"}, {"paint", parts_json(e.paint)}, {"x", e.at.x},
                       {"y", e.at.y},     {"size_mm", e.size_mm},         {"height_mm", e.height_mm}};
        if (e.on == Place::painting) result["on"] = "painting";
        put_finish(e.finish, result);
        return result;
    }
    json operator()(const PaletteEvent& e) const {
        json result = {{"event", "palette"}};
        if (e.width_mm) result["width_mm"] = *e.width_mm;
        if (e.height_mm) result["height_mm"] = *e.height_mm;
        if (e.all_paints)
            result["paints"] = "all";
        else if (!e.paints.empty())
            result["paints"] = e.paints;
        return result;
    }
    json operator()(const ConfineEvent& e) const {
        json result = {{"event", "confine"}};
        if (!e.mask.empty()) result["mask"] = e.mask;
        return result;
    }
    json operator()(const WashEvent&) const { return {{"event", "wash"}}; }
    json operator()(const PaintsEvent& e) const {
        json result = {{"event", "paints"}};
        if (e.palette) result["palette"] = json_or_discarded(palette_text(*e.palette));
        return result;
    }
};

}  // namespace

std::string_view name_of(const Event& event) {
    static constexpr std::array<std::string_view, std::variant_size_v<Event>> names = {
        "stroke", "point", "end",     "undo",    "redo",   "dry",
        "lift",   "pile",  "palette", "confine", "paints", "wash"};
    return names[event.index()];
}

PaintsEvent paints_event(const Palette& palette) {
    if (palette_text(palette) == palette_text(artist_acrylics())) return {};
    return {std::make_shared<Palette>(palette)};
}

bool is_setting(const Event& event) {
    return std::holds_alternative<ConfineEvent>(event) || std::holds_alternative<PaintsEvent>(event) ||
           std::holds_alternative<WashEvent>(event);
}

bool names_paints(const Event& event) {
    return std::holds_alternative<StrokeEvent>(event) || std::holds_alternative<PileEvent>(event) ||
           std::holds_alternative<PaletteEvent>(event);
}

json to_json(const Event& event) { return std::visit(ToJson{}, event); }

Event event_from_json(const json& object, const std::string& where,
                      const std::map<std::string, BrushSettings>& presets) {
    if (!object.is_object()) fail("{}: an event is a JSON object, not {}", where, shown(object));
    if (!object.contains("event")) fail("{}: has no 'event'", where);
    const json& kind = object["event"];
    Fields fields(object, where);
    Event event;
    if (kind == "stroke")
        event = stroke_from(fields, where, presets);
    else if (kind == "point")
        event = point_from(fields);
    else if (kind == "end")
        event = EndEvent{};
    else if (kind == "undo")
        event = UndoEvent{};
    else if (kind == "redo")
        event = RedoEvent{};
    else if (kind == "dry")
        event = dry_from(fields, where);
    else if (kind == "lift")
        event = LiftEvent{fields.text("layer")};
    else if (kind == "pile")
        event = pile_from(fields, where);
    else if (kind == "palette")
        event = palette_from(fields, where);
    else if (kind == "confine")
        event = confine_from(fields, where);
    else if (kind == "paints")
        event = paints_from(fields, where);
    else if (kind == "wash")
        event = WashEvent{};
    else
        fail(
            "{}: there is no event {}; there are: stroke, point, end, undo, redo, dry, lift, pile, palette, "
            "confine, paints, wash",
            where, shown(kind));
    fields.end();
    return event;
}

}  // namespace tangi
