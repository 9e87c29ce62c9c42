#include "paint/brush/brush_settings.h"

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace {

// Each preset differs from another by these settings.

// Hog bristles: tufts of them differ much in paint and in length, which makes streaks.
BrushSettings round_brush() {
    BrushSettings brush;
    brush.load_mm = 4.5;
    brush.load_variation = 0.9;
    brush.pickup = 2.2;
    brush.groove_mm = 0.32;
    brush.gap_mm = 0.08;
    brush.load_reach = 0.2;
    return brush;
}

BrushSettings flat_of(BrushSettings brush) {
    brush.shape = BrushShape::flat;
    brush.size_mm = 12;
    brush.thickness = 0.35;
    brush.follow = true;
    brush.bend = 0.1;
    return brush;
}

BrushSettings filbert_of(BrushSettings brush) {
    brush.shape = BrushShape::filbert;
    brush.size_mm = 10;
    brush.thickness = 0.45;
    return brush;
}

BrushSettings fan_of(BrushSettings brush) {
    brush.shape = BrushShape::fan;
    brush.size_mm = 22;
    brush.thickness = 0.16;
    brush.load_mm = 1.4;
    brush.hold_mm = 3;
    brush.load_variation = 0.8;
    brush.groove_mm = 0.4;
    brush.bristle_mm = 0.9;
    return brush;
}

// A blade: no bristles, hardly any room under it, and what it meets goes where it goes. Its leading edge is
// high: paint wells up under it, and what the blade does not let through leaves by its ends.
BrushSettings knife_of(BrushSettings brush) {
    brush.shape = BrushShape::knife;
    brush.size_mm = 18;
    brush.thickness = 0.25;
    brush.load_mm = 5;
    brush.hold_mm = 12;
    brush.load_variation = 0.3;
    brush.deposit = 0.4;
    brush.pickup = 0.4;
    brush.push = 1;
    brush.spread = 1;
    brush.gap_mm = 0.28;
    brush.groove_mm = 0.06;
    brush.bristle_mm = 1;
    brush.depth_mm = 0.7;
    brush.splay = 0;
    brush.bend = 0;
    brush.lift = 2;
    brush.reach_mm = 0.08;
    brush.load_reach = 0.25;
    brush.film_mm = 0.004;
    brush.grain = 0.02;
    return brush;
}

// Cloth: takes much, gives little, touches the crests.
BrushSettings rag_of(BrushSettings brush) {
    brush.shape = BrushShape::rag;
    brush.size_mm = 25;
    brush.load_mm = 0;
    brush.load_variation = 0.35;
    brush.deposit = 0.1;
    brush.pickup = 2.5;
    brush.push = 0.15;
    brush.gap_mm = 0.01;
    brush.groove_mm = 0.12;
    brush.bristle_mm = 1.5;
    brush.depth_mm = 0.5;
    brush.bend = 0;
    brush.lift = 0;
    brush.film_mm = 0.003;
    brush.grain = 0.5;
    return brush;
}

BrushSettings smudge_of(BrushSettings brush) {
    brush.load_mm = 0;
    brush.deposit = 1.2;
    brush.pickup = 1.2;
    brush.push = 0.8;
    brush.groove_mm = 0.08;
    brush.gap_mm = 0.05;
    return brush;
}

BrushSettings scrape_of(BrushSettings brush) {
    brush.load_mm = 0;
    brush.hold_mm = 100;
    brush.depth_mm = 1.5;
    brush.lift = 0.9;
    brush.spread = 0.3;
    brush.deposit = 0.02;
    brush.pickup = 3;
    brush.gap_mm = 0.004;
    brush.groove_mm = 0.005;
    brush.film_mm = 0.002;
    brush.reach_mm = 0.06;
    return brush;
}

// Takes all wet paint away.
BrushSettings eraser_of(BrushSettings brush) {
    brush.erases = true;
    brush.shape = BrushShape::round;
    brush.size_mm = 10;
    brush.hold_mm = 1000;
    brush.deposit = 0;
    brush.pickup = 20;
    brush.push = 0;
    brush.gap_mm = 0;
    brush.groove_mm = 0;
    brush.film_mm = 0;
    brush.grain = 0;
    brush.reach_mm = 1;
    return brush;
}

// Takes height only: a film stays, which has the paint's colour as far as paint so thin hides what is below.
BrushSettings height_eraser_of(BrushSettings brush) {
    brush.film_mm = 0.03;
    return brush;
}

std::map<std::string, BrushSettings> make_presets() {
    const BrushSettings round = round_brush(), flat = flat_of(round), knife = knife_of(flat),
                        rag = rag_of(round), eraser = eraser_of(rag);
    return {{"round", round},
            {"flat", flat},
            {"filbert", filbert_of(flat)},
            {"fan", fan_of(flat)},
            {"knife", knife},
            {"rag", rag},
            {"smudge", smudge_of(round)},
            {"scrape", scrape_of(knife)},
            {"eraser", eraser},
            {"height eraser", height_eraser_of(eraser)}};
}

std::string listed(const std::map<std::string, BrushSettings>& presets) {
    std::string names;
    for (const auto& [key, unused] : presets) names += (names.empty() ? "" : ", ") + key;
    return names;
}

template <class T>
void read_field(const nlohmann::json& value, const std::string& where, const FieldInfo& info, T& into) {
    const bool fits = std::is_same_v<T, bool> ? value.is_boolean() : value.is_number();
    if (!fits)
        fail("{}: '{}' is {}, not {}", where, info.name, shown(value),
             std::is_same_v<T, bool> ? "true or false" : "a number");
    into = value.get<T>();
    if constexpr (!std::is_same_v<T, bool>)
        if (!(into >= info.minimum && into <= info.maximum))
            fail("{}: '{}' is {}, outside [{}, {}]{}", where, info.name, shown(value), info.minimum,
                 info.maximum, info.unit == "1" ? "" : fmt::format(" {}", info.unit));
}

}  // namespace

const std::map<std::string, BrushSettings>& brush_presets() {
    static const auto presets = make_presets();
    return presets;
}

BrushSettings brush_from_json(const nlohmann::json& brush, const std::string& where,
                              const std::map<std::string, BrushSettings>& presets) {
    if (!brush.is_object()) fail("{}: a brush is a JSON object, not {}", where, shown(brush));
    BrushSettings settings;
    if (const auto preset = brush.find("preset"); preset != brush.end()) {
        const auto found = preset->is_string() ? presets.find(preset->get<std::string>()) : presets.end();
        if (found == presets.end())
            fail("{}: there is no brush preset {}; there are: {}", where, shown(*preset), listed(presets));
        settings = found->second;
    }
    for (const auto& [key, value] : brush.items()) {
        if (key == "preset") continue;
        if (key == "shape") {
            const auto shape = value.is_string() ? brush_shape_named(value.get<std::string>()) : std::nullopt;
            if (!shape) fail("{}: 'shape' is {}, not one of {}", where, shown(value), brush_shape_names());
            settings.shape = *shape;
            continue;
        }
        bool known = false;
        BrushSettings::fields(settings, [&, &key = key, &value = value](const FieldInfo& info, auto& field) {
            if (info.name != key) return;
            known = true;
            read_field(value, where, info, field);
        });
        if (!known) fail("{}: a brush has no setting '{}'", where, shortened(key));
    }
    return settings;
}

nlohmann::json brush_to_json(const BrushSettings& settings) {
    nlohmann::json result = to_json(settings);
    result["shape"] = traits_of(settings.shape).name;
    return result;
}

std::map<std::string, BrushSettings> read_brush_presets(const std::filesystem::path& path,
                                                        std::vector<std::string>* warnings) {
    const nlohmann::json root = read_json(read_text_file(path), path.string());
    if (!root.is_object() || root.value("format", nlohmann::json()) != "tangipaint brushes")
        fail("{}: is not a file of brushes; it must have \"format\": \"tangipaint brushes\"", path.string());
    if (!root.contains("version")) fail("{}: has no \"version\"; it must be 1", path.string());
    if (root["version"] != 1)
        fail("{}: has version {}, but this program reads version 1", path.string(), shown(root["version"]));
    if (!root.contains("brushes") || !root["brushes"].is_object())
        fail("{}: has no object \"brushes\"", path.string());
    auto presets = brush_presets();
    for (const auto& [key, value] : root.items())
        if (warnings && key != "format" && key != "version" && key != "brushes")
            warnings->push_back(fmt::format(
                "{}: '{}' is not a field of a file of brushes, and is not looked at; brushes are in "
                "\"brushes\"",
                path.string(), shortened(key)));
    for (const auto& [key, value] : root["brushes"].items()) {
        if (key.empty()) fail("{}: a brush in it has no name; strokes call it by one", path.string());
        if (!is_one_line(key) || key.size() > kMostOfName)
            fail(
                "{}: brush '{}': its name is to be in one line, without control characters, {} bytes at most",
                path.string(), shortened(key), kMostOfName);
        if (warnings && presets.contains(key))
            warnings->push_back(
                fmt::format("{}: its brush '{}' takes the place of the preset of that name; strokes that "
                            "name it are of the "
                            "file's",
                            path.string(), key));
        const std::string where = fmt::format("{}: brush '{}'", path.string(), shortened(key));
        const BrushSettings& brush = presets[key] = brush_from_json(value, where, brush_presets());
        if (warnings && brush.load_mm > brush.hold_mm)
            warnings->push_back(fmt::format(
                "{}: its load_mm {} is more than its hold_mm {}: freshly loaded, it has more on it than its "
                "bristles hold, and takes nothing up",
                where, brush.load_mm, brush.hold_mm));
    }
    return presets;
}

}  // namespace tangi
