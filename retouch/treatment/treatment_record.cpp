// treatment_record.cpp: of a treatment: how a step, with its layers, masks and files, gets into it and the
// log.
#include <algorithm>

#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "retouch/treatment/confining_mask.h"
#include "retouch/treatment/removed_layers.h"
#include "retouch/treatment/treatment.h"
#include "retouch/treatment/treatment_folder.h"
#include "retouch/treatment/treatment_pending.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/sha256.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_tiles.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

// Where the mask that a line of the log wrote is kept when another takes its place.
std::string kept_mask(const std::string& name, int line) {
    return fmt::format("{}/earlier/{}.{}.png", kTreatmentMasks, name, line);
}

// Layers as they lie on the canvas, with the roles that the treatment or the step gives them.
json layers_on(const Canvas& canvas, const Treatment& treatment, const TreatmentStep& step) {
    std::vector<TreatmentLayer> all = treatment.layers();
    for (const auto& [name, role] : step.added) {
        if (std::any_of(all.begin(), all.end(),
                        [&name = name](const TreatmentLayer& l) { return l.name == name; }))
            fail("{}: there is a layer '{}' already; give another name", treatment.folder().string(), name);
        all.push_back({name, role, {}});
    }
    json layers = json::array();
    for (const DriedLayer& layer : canvas.dried()) {
        const auto about = std::find_if(all.begin(), all.end(),
                                        [&](const TreatmentLayer& l) { return l.name == layer.name; });
        if (about == all.end())
            fail(
                "{}: has a layer '{}' that the log does not know; tangipaint treatment retouch takes in "
                "what was painted in the window",
                treatment.painting().string(), layer.name);
        layers.push_back({{"name", layer.name},
                          {"role", name_of(about->role)},
                          {"sha256", sha256_of(canvas, layer.paint)}});
    }
    TP_REQUIRE(layers.size() >= step.added.size(), "layers that were added are on the canvas");
    return layers;
}

// What strokes began with, as a painting of one pixel that has their palette and brush.
void write_start(AtomicFile& file, const Surface& dry, const std::vector<PartToWrite>& tools) {
    write_painting(file, cut(dry, {0, 0, 1, 1}), tools);
}

// Keeps strokes with all that painting them again needs. Returns the names of the files, and says in `about`
// which they are; `beside`, what the painting's file has beside its paint, gets their tools.
std::vector<std::string> keep_strokes(const PendingStep& pending, const TreatmentStrokes& strokes,
                                      const Treatment& treatment, const Surface& dry,
                                      std::vector<PartToWrite>& beside, json& about) {
    std::string stem = "strokes/" + treatment.new_layer_name(LayerRole::retouch);
    std::ranges::replace(stem, ' ', '_');
    std::vector<std::string> names;
    const auto keep = [&](const char* what, const std::string& name, const std::string& text) {
        write_text_file(pending.file(name), text);
        names.push_back(name);
        if (what) about[what] = name;
    };
    keep("journal", stem + ".jsonl", strokes.journal);
    for (const auto& [name, png] : strokes.masks) keep(nullptr, confining_mask_file(name), png);
    if (!strokes.tools) return names;
    std::vector<PartToWrite> before = tools_among(beside);
    if (!before.empty()) {
        names.push_back(stem + ".start.exr");
        about["start"] = names.back();
        AtomicFile file(pending.file(names.back()));
        write_start(file, dry, before);
    }
    beside = with_tools(std::move(beside), *strokes.tools);
    return names;
}

// Layers that a step takes off; says in `entry` where. Returns the name of the file.
std::string keep_removed(const PendingStep& pending, const TreatmentStep& step, int line, json& entry,
                         const Progress& progress) {
    const std::string name = fmt::format("{}/{}.exr", kTreatmentRemoved, line);
    AtomicFile file(pending.file(name));
    write_removed(file, *step.canvas, step.removed, progress);
    entry["kept"][kRemovedLayers] = name;
    return name;
}

// The painting with its layers, and what is kept with them. Returns the names of the files beside it.
std::vector<std::string> keep_canvas(const PendingStep& pending, const TreatmentStep& step,
                                     const Treatment& treatment, json& entry, const Progress& progress) {
    std::vector<std::string> names;
    std::vector<PartToWrite> further = parts_beside_paint(treatment.painting(), progress);
    if (step.strokes)
        names = keep_strokes(pending, *step.strokes, treatment, step.canvas->dry(), further,
                             entry["parameters"]["strokes"]);
    if (!step.removed.empty()) {
        const int line = treatment.log().entries().back().line + 1;
        names.push_back(keep_removed(pending, step, line, entry, progress));
    }
    AtomicFile file(pending.file(kTreatmentPainting));
    write_canvas(file, *step.canvas, progress, further);
    return names;
}

json entry_of(const TreatmentStep& step, const Author& author, const std::string& dry_sha256) {
    json inputs = json::object();
    for (const fs::path& input : step.inputs) {
        const std::string hash = sha256_of_painting(input), name = input.filename().string();
        const bool another = inputs.contains(name) && inputs[name] != hash;
        inputs[another ? input.generic_string() : name] = hash;
    }
    return {{"action", step.action},
            {"time", utc_now()},
            {"who", author.who},
            {"tool", author.tool},
            {"parameters", step.parameters},
            {"results", step.results},
            {"inputs", inputs},
            {"dry_sha256", dry_sha256}};
}

}  // namespace

void Treatment::record(const TreatmentStep& step, const Author& author, const Progress& progress) {
    json entry = entry_of(step, author, dry_sha256()), outputs = json::object();
    PendingStep pending(folder_, log_);
    const auto hash = [&](const std::string& name) { outputs[name] = sha256_of_file(pending.file(name)); };
    told_of(folder_ / kPending, folder_, [&] {  // nobody asked for files there
        if (step.canvas) {
            if (sha256_of(step.canvas->dry()) != dry_sha256())
                fail("{}: the dry layer would change; nothing was written", painting().string());
            entry["layers"] = layers_on(*step.canvas, *this, step);
            for (const std::string& name : keep_canvas(pending, step, *this, entry, progress)) hash(name);
        }
        const auto known = logged_files();
        for (const auto& [name, mask] : step.masks) {
            TP_REQUIRE(mask.width() == width() && mask.height() == height(),
                       "a mask has the painting's size");
            const std::string path = treatment_mask(name).generic_string();
            if (const auto before = known.find(path); before != known.end()) {
                const std::string kept = kept_mask(name, before->second.second);
                write_mask(pending.file(kept), this->mask(name));
                hash(kept);
                entry["kept"][name] = kept;
            }
            write_mask(pending.file(path), mask);
            hash(path);
        }
        for (const auto& [name, text] : step.files) {
            write_text_file(pending.file(name), text);
            hash(name);
        }
        for (const auto& [name, from] : step.copies) {
            copy_whole(from, pending.file(name));
            hash(name);
        }
        entry["outputs"] = outputs;
        if (!step.withdrawn.empty()) entry["withdrawn"] = step.withdrawn;
        if (!step.kept.empty()) entry["kept"].update(step.kept);
    });
    pending.commit(log_, std::move(entry), step.elsewhere);
}

void Treatment::keep_earlier(const fs::path& painting, const Author& author, const Progress& progress) {
    const Surface earlier = read_painted(painting, progress);
    if (earlier.width() != width() || earlier.height() != height())
        fail(
            "{}: has {} x {} pixels, the treatment's painting {} x {}; fit it on the same pixels: tangipaint "
            "calibrate --align-to",
            painting.string(), earlier.width(), earlier.height(), width(), height());
    TreatmentStep step{.action = "keep earlier state",
                       .parameters = {{"painting", painting.filename().string()}},
                       .inputs = {painting},
                       .copies = {{kTreatmentEarlier, painting}}};
    const auto known = logged_files();
    if (const auto before = known.find(kTreatmentEarlier); before != known.end()) {
        const std::string kept = fmt::format("earlier.{}.exr", before->second.second);
        require_logged(folder_ / kTreatmentEarlier, before->second.first, before->second.second);
        step.copies[kept] = folder_ / kTreatmentEarlier;
        step.kept[kTreatmentEarlier] = kept;
    }
    record(step, author, progress);
}

void Treatment::take_back_earlier(const LogEntry& entry, TreatmentStep& step) const {
    const json none = json::object(), kept = entry.content.value("kept", none);
    if (!kept.contains(kTreatmentEarlier)) {
        step.withdrawn.emplace_back(kTreatmentEarlier);
        return;
    }
    const auto file = kept[kTreatmentEarlier].get<std::string>();
    require_logged(folder_ / file, entry.content.at("outputs").value(file, ""), entry.line);
    step.copies[kTreatmentEarlier] = folder_ / file;
}

}  // namespace tangi
