#include "retouch/treatment/treatment_strokes.h"

#include <set>

#include "paint/canvas/canvas_hash.h"
#include "paint/files/palette_part.h"
#include "paint/session/journal.h"
#include "paint/session/session.h"
#include "surface/base/error.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// Of a line of the log: its layers by name, with their hashes.
std::map<std::string, std::string> layers_of_line(const LogEntry& entry) {
    std::map<std::string, std::string> layers;
    for (const json& layer : entry.content.value("layers", json::array()))
        layers[layer.at("name").get<std::string>()] = layer.at("sha256").get<std::string>();
    return layers;
}

// The canvas with these layers and nothing else; nothing where one of them is not there any more.
std::optional<Canvas> with_only(const Canvas& canvas, const std::map<std::string, std::string>& layers) {
    Canvas only = canvas;
    only.confine({});
    only.writable_wet() = PaintLayer(canvas.width(), canvas.height());
    std::erase_if(only.writable_dried(),
                  [&](const DriedLayer& layer) { return !layers.contains(layer.name); });
    if (only.dried().size() != layers.size()) return {};
    return only;
}

// A file that a line of the log names; empty where it names none.
fs::path kept_file(const Treatment& treatment, const LogEntry& entry, const char* what) {
    const json parameters = entry.content.value("parameters", json::object()),
               strokes = parameters.value("strokes", json::object()),
               name = strokes.is_object() ? strokes.value(what, json()) : json();
    if (!name.is_string() || !entry.content.value("outputs", json::object()).contains(name)) return {};
    return treatment.folder() / name.get<std::string>();
}

// Which of the layers that a line brought are not what its strokes make; empty where all are.
std::string differs(const Treatment& treatment, const LogEntry& entry, Canvas start, const Journal& journal,
                    const std::map<std::string, std::string>& before, const Progress& progress) {
    const fs::path tools = kept_file(treatment, entry, "start");
    Session session(std::move(start), artist_acrylics());
    session.masks_from(masks_beside(journal.source, session.canvas().width(), session.canvas().height()));
    if (!tools.empty()) read_tools(tools, session);
    replay(session, journal, progress);
    Canvas& made = session.canvas();
    std::map<std::string, std::string> layers;
    for (const DriedLayer& layer : made.dried()) layers[layer.name] = sha256_of(made, layer.paint);
    const std::string wet = sha256_of(made, made.wet());
    for (const auto& [name, sha256] : layers_of_line(entry)) {
        if (before.contains(name)) continue;
        const auto dried = layers.find(name);
        if (dried == layers.end() ? made.wet().empty() || wet != sha256 : dried->second != sha256)
            return name;
    }
    return {};
}

}  // namespace

TreatmentStrokes strokes_within(const ConfiningMask& mask, const Journal& journal, const Session& session) {
    std::string lines = journal_line(paints_event(session.palette())) + journal_line(ConfineEvent{mask.name});
    for (const Journal::Entry& entry : journal.entries) lines += journal_line(entry.event);
    const Canvas& canvas = session.canvas();
    return {journal_text({hash_of(canvas, hash_of(canvas.dry())), {}}, lines), {{mask.name, mask.png}}};
}

std::vector<std::string> strokes_that_cannot_be_repeated(const Treatment& treatment) {
    std::set<std::string> journals;
    for (const LogEntry& entry : treatment.log().entries())
        if (const auto outputs = entry.content.find("outputs"); outputs != entry.content.end())
            for (const auto& [name, hash] : outputs->items())
                if (name.starts_with("strokes/") && name.ends_with(".jsonl")) journals.insert(name);
    std::vector<std::string> faults;
    for (const std::string& name : journals) {
        const fs::path path = treatment.folder() / name;
        std::error_code unknown;
        if (!fs::exists(path, unknown)) continue;
        try {
            require_in_order(read_journal(path));
        } catch (const Error& error) {
            faults.emplace_back(error.what());
        }
    }
    return faults;
}

StrokesRepeated repeat_strokes(const Treatment& treatment, const Canvas& canvas, const Progress& progress) {
    StrokesRepeated repeated;
    const std::string dry_hash = hash_of(canvas.dry());
    std::map<std::string, std::string> before;  // the layers when a step began
    for (const LogEntry& entry : treatment.log().entries()) {
        if (const fs::path path = kept_file(treatment, entry, "journal"); !path.empty()) {
            std::map<std::string, std::string> all = before;
            all.merge(layers_of_line(entry));
            std::optional<Canvas> start = with_only(canvas, all) ? with_only(canvas, before) : std::nullopt;
            const Journal journal = read_journal(path);
            if (start && hash_of(*start, dry_hash) == journal.head.on) {
                const std::string layer =
                    differs(treatment, entry, std::move(*start), journal, before, progress);
                if (layer.empty())
                    ++repeated.painted_again;
                else
                    repeated.faults.push_back(
                        fmt::format("{}: its strokes do not make the layer '{}' that line {} of the log has",
                                    path.string(), layer, entry.line));
            } else {
                ++repeated.not_repeated;
            }
        }
        if (entry.content.contains("layers")) before = layers_of_line(entry);
    }
    return repeated;
}

}  // namespace tangi
