// treatment_undo.cpp: of the steps of a treatment: which is undone next, and how.
#include <fmt/ranges.h>

#include <algorithm>

#include "retouch/treatment/removed_layers.h"
#include "retouch/treatment/treatment_folder.h"
#include "retouch/treatment/treatment_steps.h"
#include "surface/base/error.h"
#include "surface/file/sha256.h"

namespace tangi {

using nlohmann::json;

namespace {

// A step that can be undone: what it laid and is still there, the masks that it changed, whether it kept the
// painting as it was earlier, what it took off.
struct Undoable {
    const LogEntry* entry = nullptr;
    std::vector<std::string> layers, masks;
    bool earlier = false;
    std::vector<std::string> removed;
};

std::string action_of(const LogEntry& entry) { return entry.content.at("action").get<std::string>(); }

bool draws(const LogEntry& entry) {
    return action_of(entry) == "draw damage" || action_of(entry) == "suggest damage";
}

// Names of the masks that a line wrote: "stain", "stain.confidence".
std::vector<std::string> masks_of(const LogEntry& entry) {
    std::vector<std::string> names;
    const json outputs = entry.content.value("outputs", json::object());
    for (const auto& [path, hash] : outputs.items())
        if (const std::filesystem::path p(path); p.parent_path() == "masks")
            names.push_back(p.stem().string());
    return names;
}

json layers_of_entry(const LogEntry& entry) { return entry.content.value("layers", json::array()); }

// Layers as they lay, bottom up, before a line of the log.
json layers_before(const Treatment& treatment, const LogEntry& line) {
    json layers = json::array();
    for (const LogEntry& entry : treatment.log().entries())
        if (entry.line < line.line && entry.content.contains("layers")) layers = layers_of_entry(entry);
    return layers;
}

// Of those before a line that took some off: the layers that it no longer has.
std::vector<std::string> taken_off(const json& before, const LogEntry& entry) {
    std::set<std::string> stay;
    for (const json& layer : layers_of_entry(entry)) stay.insert(layer.at("name").get<std::string>());
    std::vector<std::string> gone;
    for (const json& layer : before)
        if (auto name = layer.at("name").get<std::string>(); !stay.contains(name))
            gone.push_back(std::move(name));
    return gone;
}

std::set<int> undone_lines(const Treatment& treatment) {
    std::set<int> undone;
    for (const LogEntry& entry : treatment.log().entries())
        if (action_of(entry) == "undo")
            undone.insert(entry.content.at("parameters").at("step").at("line").get<int>());
    return undone;
}

// The step that brought a layer is the first that has it: the last line where one of those that are still
// there appears, that changed the map, that kept the earlier painting, or that took layers off.
Undoable last_undoable(const Treatment& treatment) {
    std::set<std::string> there, known;
    for (const TreatmentLayer& layer : treatment.layers()) there.insert(layer.name);
    const std::set<int> undone = undone_lines(treatment);
    Undoable last;
    json before = json::array();
    for (const LogEntry& entry : treatment.log().entries()) {
        Undoable step{&entry, {}, {}, false, {}};
        for (const json& layer : layers_of_entry(entry))
            if (const auto name = layer.at("name").get<std::string>();
                known.insert(name).second && there.contains(name))
                step.layers.push_back(name);
        if (!undone.contains(entry.line)) {
            if (draws(entry)) step.masks = masks_of(entry);
            step.earlier = action_of(entry) == "keep earlier state";
            if (action_of(entry) == "remove") step.removed = taken_off(before, entry);
        }
        if (entry.content.contains("layers")) before = layers_of_entry(entry);
        if (!step.layers.empty() || !step.masks.empty() || step.earlier || !step.removed.empty())
            last = std::move(step);
    }
    return last;
}

// What a mask was before a line of the log wrote another in its place; empty coverage where there was none.
Mask mask_before(const Treatment& treatment, const std::string& name, const LogEntry& entry) {
    const json none = json::object(), kept = entry.content.value("kept", none),
               outputs = entry.content.value("outputs", none);
    if (kept.contains(name)) {
        const auto path = kept[name].get<std::string>();
        const std::filesystem::path file = treatment.folder() / path;
        if (!std::filesystem::exists(file) || sha256_of_file(file) != outputs.value(path, ""))
            fail("{}: is not the mask that line {} of the log kept; take it from a backup", file.string(),
                 entry.line);
        return read_mask(file, treatment.width(), treatment.height());
    }
    for (const LogEntry& earlier : treatment.log().entries())
        if (earlier.line < entry.line &&
            earlier.content.value("outputs", none).contains("masks/" + name + ".png"))
            fail(
                "{}: line {} of the log was written by an earlier version, which did not keep the '{}' "
                "before; correct the map with tangipaint damage --edit",
                treatment.folder().string(), entry.line, name);
    return Mask(treatment.width(), treatment.height());
}

// The file where a line kept what it took off; empty where it kept nothing.
std::string removed_file(const LogEntry& entry) {
    const json kept = entry.content.value("kept", json::object());
    return kept.value(kRemovedLayers, "");
}

std::string nothing_kept(const Undoable& step) {
    return fmt::format(
        "line {} of the log took off {}, and was written by an earlier version, which kept nothing of it: it "
        "cannot be undone, nor what was done before it; a layer that still lies there is taken off by its "
        "name",
        step.entry->line, fmt::join(step.removed, ", "));
}

// Above the nearest of those that lay below it and are there; at the bottom where there is none.
void put_back(Canvas& canvas, DriedLayer layer, const json& before) {
    auto& dried = canvas.writable_dried();
    auto place = dried.begin();
    for (const json& lower : before) {
        if (lower.at("name") == layer.name) break;
        const auto found = std::ranges::find(dried, lower.at("name").get<std::string>(), &DriedLayer::name);
        if (found != dried.end()) place = std::next(found);
    }
    for (const TileIndex at : layer.paint.painted()) canvas.mark_dirty(at);
    dried.insert(place, std::move(layer));
}

// Puts on the canvas what a line took off, and says so in `step`.
void bring_back(const Treatment& treatment, Canvas& canvas, const Undoable& last, TreatmentStep& step,
                const Progress& progress) {
    const std::string name = removed_file(*last.entry);
    if (name.empty()) fail("{}: {}", treatment.folder().string(), nothing_kept(last));
    const std::filesystem::path file = treatment.folder() / name;
    require_logged(file, last.entry->content.at("outputs").value(name, ""), last.entry->line);
    const json before = layers_before(treatment, *last.entry);
    for (DriedLayer& layer : read_removed(file, canvas, progress)) {
        const auto logged = std::ranges::find_if(
            before, [&](const json& l) { return l.at("name").get<std::string>() == layer.name; });
        if (logged == before.end() || sha256_of(canvas, layer.paint) != logged->at("sha256"))
            fail("{}: holds a layer '{}' that is not the one that was taken off; take the file from a backup",
                 file.string(), layer.name);
        step.added.emplace_back(
            layer.name, layer_role_named(logged->at("role").get<std::string>()).value_or(LayerRole::fill));
        put_back(canvas, std::move(layer), before);
    }
    step.parameters["brought_back"] = last.removed;
    step.canvas = &canvas;
}

// "draw stain" of "draw damage": what a line did to the map.
std::string words_of_masks(const Undoable& step) {
    std::vector<std::string> classes;
    for (std::string name : step.masks)
        if (damage_class_named(name)) {
            std::ranges::replace(name, '_', ' ');
            classes.push_back(std::move(name));
        }
    const bool drawn = action_of(*step.entry) == "draw damage";
    return fmt::format("{} {}", drawn ? "draw" : "suggest",
                       classes.empty() ? "damage" : fmt::format("{}", fmt::join(classes, ", ")));
}

}  // namespace

NextUndo next_undo(const Treatment& treatment) {
    const Undoable last = last_undoable(treatment);
    if (!last.entry) return {};
    if (!last.removed.empty())
        return {fmt::format("take off {}", fmt::join(last.removed, ", ")),
                removed_file(*last.entry).empty() ? nothing_kept(last) : ""};
    if (!last.layers.empty()) return {fmt::format("lay {}", fmt::join(last.layers, ", ")), ""};
    return {last.earlier ? "keep the earlier state" : words_of_masks(last), ""};
}

json undo_step(Treatment& treatment, Canvas& canvas, const Author& author, const Progress& progress) {
    const Undoable last = last_undoable(treatment);
    if (!last.entry)
        fail(
            "{}: there is no step to undo: nothing lies on the painting, no damage was mapped, and no "
            "earlier state was kept",
            treatment.folder().string());
    const json undone = {{"line", last.entry->line},
                         {"action", last.entry->content.at("action")},
                         {"sha256", last.entry->sha256}};
    TreatmentStep step{.action = "undo", .parameters = {{"step", undone}, {"layers", last.layers}}};
    for (const std::string& layer : last.layers) lift_off(canvas, layer);
    if (!last.layers.empty()) step.canvas = &canvas;
    if (!last.removed.empty()) bring_back(treatment, canvas, last, step, progress);
    for (const std::string& name : last.masks) step.masks[name] = mask_before(treatment, name, *last.entry);
    if (!last.masks.empty()) step.parameters["masks"] = last.masks;
    if (last.earlier) treatment.take_back_earlier(*last.entry, step);
    json result = {{"undone", undone},
                   {"removed", last.layers},
                   {"brought_back", last.removed},
                   {"restored", last.masks}};
    if (last.earlier) result["earlier_state"] = step.withdrawn.empty() ? "the one before" : "none";
    treatment.record(step, author, progress);
    return result;
}

}  // namespace tangi
