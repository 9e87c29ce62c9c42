// treatment.h: the treatment of one painting: a folder NAME.treatment/ that holds the painting with all that
// was added, as layers that can be taken off; masks of its damage; and the log of every step.
//
//   painting.exr          a copy of the painting; its dry part stays as it is, fills, varnishes and retouches
//                         are dried layers on it (paint/files/canvas_file.h)
//   masks/CLASS.png       coverage by each class of damage; CLASS.confidence.png beside what was suggested
//   earlier.exr           the painting before it was cleaned, where it was photographed then too;
//                         earlier.LINE.exr: another one before it, by the line of the log that wrote it
//   removed/LINE.exr      layers that this line of the log took off (removed_layers.h): undo brings them back
//   strokes/, quality/    what steps kept: journals of strokes, quality maps
//   log.jsonl             the log (treatment_log.h): the layers, masks and files that there are, with hashes
//   pending/              only while a step is written, or where a crash came into one (treatment_folder.h)
//
// docs/reference/treatment-format.md: the format; docs/guide/retouching.md: use.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "paint/canvas/canvas.h"
#include "retouch/mask/damage_class.h"
#include "retouch/mask/mask.h"
#include "retouch/treatment/treatment_log.h"
#include "surface/base/progress.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

// What a layer is to the treatment.
enum class LayerRole { fill, isolating_varnish, retouch, varnish };
std::string_view name_of(LayerRole role);
std::optional<LayerRole> layer_role_named(std::string_view name);

// States of a treatment, in their order; each shows the layers of its role and of those before. `before` and
// `cleaned` are what was photographed: without any layer (the same, unless there is an earlier.exr).
enum class TreatmentStage { before, cleaned, filled, retouched, varnished };
std::string_view name_of(TreatmentStage state);
std::optional<TreatmentStage> treatment_stage_named(std::string_view name);
TreatmentStage shown_from(LayerRole role);  // the first state that shows it

struct TreatmentLayer {
    std::string name;  // of the dried layer in painting.exr: "fill 1"
    LayerRole role = LayerRole::fill;
    std::string sha256;  // of its paint: sha256_of(canvas, layer)
};

// Who did a step, and with what.
struct Author {
    std::string who;   // a person's name
    std::string tool;  // "tangipaint 0.1.0"
};

// Strokes that a step is of: with what is kept of them, they make its layers again by themselves.
struct TreatmentStrokes {
    std::string journal;                         // text, with its paints; its masks are named in it
    std::map<std::string, std::string> masks{};  // name -> file (confining_mask.h)
    // Palette and brush as the strokes left them (palette_part.h), for the painting's file: those that this
    // has are what they went on from, and stay with the journal. Nothing: they began with none, and the
    // file's are as they were.
    std::optional<std::vector<PartToWrite>> tools{};
};

// A step that is to be recorded: what changed, and why.
struct TreatmentStep {
    std::string action;  // "fill", "suggest damage"
    nlohmann::json parameters = nlohmann::json::object();
    nlohmann::json results = nlohmann::json::object();  // areas, counts, recipes: what came out
    std::vector<std::filesystem::path> inputs{};        // files from elsewhere: their hashes are kept
    std::map<std::string, Mask> masks{};                // to write: name in masks/ without ".png" -> mask
    std::map<std::string, std::string> files{};         // to write: path in the folder -> content
    // To write: path in the folder -> the file that it is a copy of.
    std::map<std::string, std::filesystem::path> copies{};
    // To write: the canvas with its layers; `added` says what the new ones among them are. Layers of the
    // treatment that are no longer on the canvas are thereby removed.
    const Canvas* canvas = nullptr;
    std::vector<std::pair<std::string, LayerRole>> added{};
    std::vector<DriedLayer> removed{};  // of the canvas's paints: layers that the step takes off, to be kept
    std::map<std::string, std::string> kept{};  // of these, what others were before: file -> where it stays
    std::optional<TreatmentStrokes> strokes{};
    // Puts in place what belongs to the step and lies elsewhere, when all else is on the disk. What it throws
    // undoes the step.
    std::function<void()> elsewhere{};
    std::vector<std::string> withdrawn{};  // files that the treatment has no more: to be removed
};

class Treatment {
public:
    // Makes the folder and copies the painting. Throws Error where the folder holds a treatment already.
    // `mm_per_pixel` as in Canvas.
    static Treatment begin(const std::filesystem::path& folder, const std::filesystem::path& painting,
                           const Author& author, std::optional<double> mm_per_pixel = {},
                           const Progress& progress = {});
    // Reads and checks the log; first, a step that a crash came into is finished where it is in the log, and
    // forgotten where it is not. Throws Error naming file and line where the log was edited or cut.
    static Treatment open(const std::filesystem::path& folder);

    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path painting() const { return folder_ / "painting.exr"; }
    const TreatmentLog& log() const { return log_; }
    int width() const;
    int height() const;
    double mm_per_pixel() const;
    bool scale_known() const;
    std::string dry_sha256() const;              // of the dry layer when the treatment began
    std::vector<TreatmentLayer> layers() const;  // bottom up
    // A name that no layer has or had: "fill 3"; of what was made up, "proposal fill 1".
    std::string new_layer_name(LayerRole role, bool proposal = false) const;

    // The painting with its layers. Throws Error where the dry layer is not the one that the treatment began
    // with, or a layer is not what the log says. Wet paint is not looked at: it is work in progress.
    Canvas read_canvas(const Progress& progress = {}) const;

    // Masks by name; a class of which none was made is empty coverage. Throws Error where a mask's file is
    // not the one that was logged.
    std::vector<std::string> mask_names() const;
    Mask mask(const std::string& name) const;
    Mask mask(DamageClass damage) const { return mask(std::string(name_of(damage))); }
    bool has_mask(DamageClass damage) const;

    // The painting as it was photographed before the treatment began, as before cleaning: a copy of it is
    // kept, and shown as the state `before`; of one that was kept before, `earlier.LINE.exr` stays, so that
    // undo brings it back. Throws Error where it has another size.
    void keep_earlier(const std::filesystem::path& painting, const Author& author,
                      const Progress& progress = {});
    bool has_earlier() const;
    // Makes earlier.exr what it was before `entry`, the line of the log that kept it, and says so in `step`.
    void take_back_earlier(const LogEntry& entry, TreatmentStep& step) const;
    Surface read_earlier(const Progress& progress = {}) const;

    // Writes what the step says and the log: all of it or, where it throws or the machine stops, nothing. The
    // dry layer is checked before. Throws Error where another program wrote to the log since open().
    void record(const TreatmentStep& step, const Author& author, const Progress& progress = {});

    // All that is not as it was logged, a line each: masks, kept files, layers and their order. Reads
    // everything.
    std::vector<std::string> check(const Progress& progress = {}) const;
    // What lies on the canvas and the log does not know, a line each: dried layers, wet paint.
    std::vector<std::string> unlogged(const Canvas& canvas) const;

private:
    Treatment(std::filesystem::path folder, TreatmentLog log)
        : folder_(std::move(folder)), log_(std::move(log)) {}
    // Hash and line of the last entry that wrote each file.
    std::map<std::string, std::pair<std::string, int>> logged_files() const;
    std::vector<std::string> layer_faults(const Canvas& canvas) const;

    std::filesystem::path folder_;
    TreatmentLog log_;
};

// SHA-256 over the maps of a surface: that the dry layer has not changed.
std::string sha256_of(const Surface& surface);
// Over a layer's paint: tile by tile, which paints and how much of each.
std::string sha256_of(const Canvas& canvas, const PaintLayer& layer);

// The canvas as it was in a state: without wet paint and the layers of later roles.
Canvas in_state(const Canvas& canvas, const std::vector<TreatmentLayer>& layers, TreatmentStage state);

// What the painting looks like in a state, with its maps: `before` as it was photographed earlier, if it was.
Surface surface_in_state(const Treatment& treatment, const Canvas& canvas, TreatmentStage state,
                         const Progress& progress = {});

// Where there is any paint, 1; else 0: of one layer, or of all that was added to the dry surface.
Mask additions(const PaintLayer& layer);
Mask additions(const Canvas& canvas);

// All that is mapped, of any class: what lies outside of it is original.
Mask mapped_damage(const Treatment& treatment);

// Paint beside the area where it belongs. What lies on `allowed` in part counts for the rest of its pixel.
struct OnOriginal {
    int pixels = 0;        // that hold paint and of which any part is outside of `allowed`
    int whole_pixels = 0;  // of these, that are outside of it as a whole, not only its rim
    double area_mm2 = 0;
    double volume_mm3 = 0;
};
OnOriginal on_original(const PaintLayer& layer, const Mask& allowed, double mm_per_pixel);
nlohmann::json to_json(const OnOriginal& paint);

// Masks of a step that is still to be recorded, by name.
using MasksToCome = std::map<std::string, Mask>;
// A class's mask, as the step will have it; nothing where there is none.
std::optional<Mask> mask_with(const MasksToCome& to_come, const Treatment& treatment, DamageClass damage);

// Everything that is known about damage: class, count, area, percent; a class without any is left out.
nlohmann::json damage_table(const Treatment& treatment, const MasksToCome& to_come = {});

}  // namespace tangi
