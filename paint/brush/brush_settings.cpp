#include "paint/brush/brush_settings.h"

#include <algorithm>
#include <array>

#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

namespace {

constexpr std::array<const char*, 6> kShapes = {"round", "flat", "filbert", "fan", "knife", "rag"};

std::map<std::string, BrushSettings> make_presets() {
    std::map<std::string, BrushSettings> all;
    // Hog bristles: tufts of them differ much in paint and in length, which makes streaks.
    BrushSettings round;
    round.load_mm = 4.5;
    round.load_variation = 0.9;
    round.pickup = 2.2;
    round.groove_mm = 0.32;
    round.gap_mm = 0.08;
    round.load_reach = 0.2;
    all["round"] = round;

    BrushSettings flat = round;
    flat.shape = "flat";
    flat.size_mm = 12;
    flat.thickness = 0.35;
    flat.follow = true;
    flat.bend = 0.1;
    all["flat"] = flat;

    BrushSettings filbert = flat;
    filbert.shape = "filbert";
    filbert.size_mm = 10;
    filbert.thickness = 0.45;
    all["filbert"] = filbert;

    BrushSettings fan = flat;
    fan.shape = "fan";
    fan.size_mm = 22;
    fan.thickness = 0.16;
    fan.load_mm = 1.4;
    fan.hold_mm = 3;
    fan.load_variation = 0.8;
    fan.groove_mm = 0.4;
    fan.bristle_mm = 0.9;
    all["fan"] = fan;

    // A blade: no bristles, hardly any room under it, and what it meets goes where it goes. Its leading edge
    // is high: paint wells up under it, and what the blade does not let through leaves by its ends.
    BrushSettings knife = flat;
    knife.shape = "knife";
    knife.size_mm = 18;
    knife.thickness = 0.25;
    knife.load_mm = 5;
    knife.hold_mm = 12;
    knife.load_variation = 0.3;
    knife.deposit = 0.4;
    knife.pickup = 0.4;
    knife.push = 1;
    knife.spread = 1;
    knife.gap_mm = 0.28;
    knife.groove_mm = 0.06;
    knife.bristle_mm = 1;
    knife.depth_mm = 0.7;
    knife.splay = 0;
    knife.bend = 0;
    knife.lift = 2;
    knife.reach_mm = 0.08;
    knife.load_reach = 0.25;
    knife.film_mm = 0.004;
    knife.grain = 0.02;
    all["knife"] = knife;

    // Cloth: takes much, gives little, touches the crests.
    BrushSettings rag = round;
    rag.shape = "rag";
    rag.size_mm = 25;
    rag.load_mm = 0;
    rag.load_variation = 0.35;
    rag.deposit = 0.1;
    rag.pickup = 2.5;
    rag.push = 0.15;
    rag.gap_mm = 0.01;
    rag.groove_mm = 0.12;
    rag.bristle_mm = 1.5;
    rag.depth_mm = 0.5;
    rag.bend = 0;
    rag.lift = 0;
    rag.film_mm = 0.003;
    rag.grain = 0.5;
    all["rag"] = rag;

    BrushSettings smudge = round;
    smudge.load_mm = 0;
    smudge.deposit = 1.2;
    smudge.pickup = 1.2;
    smudge.push = 0.8;
    smudge.groove_mm = 0.08;
    smudge.gap_mm = 0.05;
    all["smudge"] = smudge;

    BrushSettings scrape = knife;
    scrape.load_mm = 0;
    scrape.hold_mm = 100;
    scrape.depth_mm = 1.5;
    scrape.lift = 0.9;
    scrape.spread = 0.3;
    scrape.deposit = 0.02;
    scrape.pickup = 3;
    scrape.gap_mm = 0.004;
    scrape.groove_mm = 0.005;
    scrape.film_mm = 0.002;
    scrape.reach_mm = 0.06;
    all["scrape"] = scrape;

    // Takes all wet paint away.
    BrushSettings eraser = rag;
    eraser.erases = true;
    eraser.shape = "round";
    eraser.size_mm = 10;
    eraser.hold_mm = 1000;
    eraser.deposit = 0;
    eraser.pickup = 20;
    eraser.push = 0;
    eraser.gap_mm = 0;
    eraser.groove_mm = 0;
    eraser.film_mm = 0;
    eraser.grain = 0;
    eraser.reach_mm = 1;
    all["eraser"] = eraser;

    // Takes height only: a film stays, which has the paint's colour as far as paint so thin hides what is
    // below.
    BrushSettings leveller = eraser;
    leveller.film_mm = 0.03;
    all["height eraser"] = leveller;
    return all;
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
            const auto is_it = [&value = value](const char* shape) { return value == shape; };
            if (std::none_of(kShapes.begin(), kShapes.end(), is_it))
                fail("{}: 'shape' is {}, not one of round, flat, filbert, fan, knife, rag", where,
                     shown(value));
            settings.shape = value.get<std::string>();
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
    result["shape"] = settings.shape;
    return result;
}

std::map<std::string, BrushSettings> read_brush_presets(const std::filesystem::path& path,
                                                        std::vector<std::string>* warnings) {
    const std::string text = read_text_file(path);
    nlohmann::json root;
    try {
        root = parse_json(text, path.string());
    } catch (const nlohmann::json::parse_error& error) {
        fail("{}:{}: is not JSON as files of brushes are: {}", path.string(), line_of(text, error.byte),
             why_no_json(text, error.byte));
    }
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
