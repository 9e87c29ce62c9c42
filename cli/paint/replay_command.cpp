// replay_command.cpp: tangipaint replay [PAINTING.exr | --substrate NAME] STROKES.jsonl --out OUT.exr
#include <algorithm>
#include <chrono>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/paint/substrate_arguments.h"
#include "cli/paint/time_lapse.h"
#include "paint/canvas/canvas_hash.h"
#include "paint/files/canvas_file.h"
#include "paint/files/palette_part.h"
#include "paint/session/session.h"
#include "retouch/treatment/confining_mask.h"
#include "surface/base/error.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct ReplayArguments {
    std::vector<std::string> files;
    std::string out, board, palette, brushes;
    std::optional<double> mm_per_pixel;
    bool recover = false;
    SubstrateArguments substrate;
    TimeLapseArguments frames;
};

Canvas canvas_of(const ReplayArguments& a, const Progress& progress) {
    if (!a.substrate.given()) return read_canvas(a.files.front(), progress, a.mm_per_pixel);
    return Canvas(std::make_shared<Surface>(a.substrate.make(progress)));
}

// A journal that says which paints it is painted with is not painted with others.
void refuse_palette(const Journal& journal) {
    const auto first = std::ranges::find_if(journal.entries, [](const Journal::Entry& entry) {
        return names_paints(entry.event) || std::holds_alternative<PaintsEvent>(entry.event);
    });
    if (first != journal.entries.end() && std::holds_alternative<PaintsEvent>(first->event))
        throw UsageError(fmt::format(
            "--palette: {}:{} says which paints the strokes are of; leave the flag out, or that line",
            journal.source, first->line));
}

std::vector<fs::path> inputs_of(const ReplayArguments& a) {
    std::vector<fs::path> inputs(a.files.begin(), a.files.end());
    for (const std::string& file : {a.palette, a.brushes})
        if (!file.empty()) inputs.emplace_back(file);
    for (const fs::path& file : a.substrate.inputs()) inputs.push_back(file);
    return inputs;
}

void require_sound_inputs(const ReplayArguments& a) {
    const std::size_t expected = !a.substrate.given() ? 2 : 1;
    if (a.files.size() != expected)
        throw UsageError(
            !a.substrate.given()
                ? "give a painting to paint on and a journal: replay PAINTING.exr STROKES.jsonl; or a "
                  "substrate: replay --substrate linen STROKES.jsonl"
                : "with --substrate, give the journal only: replay --substrate linen STROKES.jsonl");
    if (a.substrate.given() && a.mm_per_pixel)
        throw UsageError("--mm-per-pixel is of a painting; the pixels of a substrate are --pixel-mm");
    a.substrate.refuse_useless();
    a.frames.refuse_useless();
    if (lower_extension(a.files.back()) == ".exr")
        throw UsageError(fmt::format("{}: is a painting; the journal of strokes comes last", a.files.back()));
}

void require_sound_outputs(const ReplayArguments& a) {
    const std::vector<fs::path> inputs = inputs_of(a);
    refuse_to_overwrite(a.out, inputs);
    if (!a.board.empty()) refuse_to_overwrite(a.board, inputs, "--board");
    if (!a.frames.video.empty()) refuse_to_overwrite(a.frames.video, inputs, "--video");
    if (!a.out.empty()) require_painting_ending(a.out);
    if (!a.board.empty()) require_ending(a.board, {".exr"}, "a palette is an .exr file", "--board");
    if (!a.board.empty() && fs::weakly_canonical(a.board) == fs::weakly_canonical(a.out))
        throw UsageError(fmt::format("--board {}: is where the painting goes; give another name", a.board));
}

// What the command writes, put in place together.
struct ReplayFiles {
    explicit ReplayFiles(const ReplayArguments& a) : painting(a.out) {
        if (!a.board.empty()) board.emplace(a.board);
    }
    PaintingOutput painting;
    std::optional<AtomicFile> board;
};

// Masks that strokes name, and the tools that an earlier sitting left with the painting.
void prepare(Session& session, const ReplayArguments& a, const Progress& progress) {
    session.masks_from(masks_beside(a.files.back(), session.canvas().width(), session.canvas().height()));
    if (!a.substrate.given()) read_tools(a.files.front(), session, progress);
}

// Of a painting and a journal that may not belong together.
void warn_of_painting(const ReplayArguments& a, const Canvas& canvas, const Journal& journal,
                      const std::string& dry_hash, std::vector<std::string>& warnings) {
    if (!canvas.dry().scale_known && !a.mm_per_pixel && canvas.mm_per_pixel() == 1)
        warnings.push_back(fmt::format(
            "{}: its scale is unknown: a pixel is taken for one mm; give --mm-per-pixel", a.files.front()));
    if (!a.substrate.given() && !journal.head.on.empty() && journal.head.on != hash_of(canvas, dry_hash))
        warnings.push_back(
            fmt::format("{}: goes on from another painting than {} is, as its first line says; its strokes "
                        "are laid all the "
                        "same",
                        a.files.back(), a.files.front()));
}

// What a run makes belongs together: all of it is written before any of it takes its place.
void save(ReplayFiles& files, const ReplayArguments& a, const Session& session, TimeLapse* frames,
          const Progress& progress) {
    std::vector<PartToWrite> further;  // goes with the dry layer, which painting does not change
    if (!a.substrate.given()) further = parts_beside_paint(a.files.front(), progress);
    fill_canvas(files.painting, session.canvas(), progress, with_tools(std::move(further), session));
    if (files.board) fill_canvas(*files.board, *session.board(), progress, {});
    OutputSet set;
    files.painting.add_to(set);
    if (files.board) set.add(*files.board);
    if (frames) frames->add_to(set);
    set.commit();
}

nlohmann::json result_of(const Session& session) {
    const Canvas& canvas = session.canvas();
    nlohmann::json layers = nlohmann::json::array();
    for (const DriedLayer& layer : canvas.dried()) layers.push_back(layer.name);
    return {{"width", canvas.width()},
            {"height", canvas.height()},
            {"mm_per_pixel", canvas.mm_per_pixel()},
            {"strokes", session.totals().strokes},
            {"points", session.totals().points},
            {"steps", session.totals().steps},
            {"bristle_pixels", session.totals().bristle_pixels},
            {"volumes_mm3", volumes_by_name(canvas.ingredients(), canvas.volumes_mm3())},
            {"layers", layers}};
}

nlohmann::json run_replay(const ReplayArguments& a) {
    require_sound_inputs(a);
    require_sound_outputs(a);
    const Progress progress = console_progress();
    std::vector<std::string> warnings = a.substrate.warnings();
    const auto brushes = a.brushes.empty() ? brush_presets() : read_brush_presets(a.brushes, &warnings);
    const Journal journal =
        a.recover ? recovered_journal(a.files.back(), brushes) : read_journal(a.files.back(), brushes);
    ReplayFiles files(a);  // that they can be written is known before the work
    if (!a.palette.empty()) refuse_palette(journal);
    Session session(canvas_of(a, progress), a.palette.empty() ? artist_acrylics() : read_palette(a.palette));
    prepare(session, a, progress);
    const std::string dry_hash = hash_of(session.canvas().dry());
    warn_of_painting(a, session.canvas(), journal, dry_hash, warnings);

    const auto start = std::chrono::steady_clock::now();
    std::optional<TimeLapse> frames;
    if (a.frames.given()) frames.emplace(a.frames, journal, session);
    for (std::string& warning : replay(session, journal, progress)) warnings.push_back(std::move(warning));
    if (frames) frames->complete();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (files.board && !session.board()) {  // no reason to lose the painting
        warnings.push_back(fmt::format(
            "--board {}: is not written: nothing was done on the palette, so there is none", a.board));
        files.board.reset();
    }
    save(files, a, session, frames ? &*frames : nullptr, progress);

    nlohmann::json result = result_of(session);
    result["painting"] = a.out, result["dry_hash"] = dry_hash;
    result["seconds"] = seconds.count();
    result["frames"] = frames ? frames->frames() : 0;
    result["warnings"] = told(warnings);
    return result;
}

}  // namespace

Command replay_command() {
    return {
        "replay", "paint the strokes of a journal on a painting or a substrate", [](Flags& flags) {
            auto a = std::make_shared<ReplayArguments>();
            flags.option("FILES", a->files, "[PAINTING.exr] STROKES.jsonl: what to paint on, and the journal")
                .required();
            flags.option("--out", a->out, "painting file to write (.exr)").required();
            flags.option("--board", a->board,
                         "painting file for the palette with what was mixed on it (.exr)");
            a->substrate.add_to(flags);
            a->frames.add_to(flags);
            flags.option("--palette", a->palette,
                         "palette file (.json) with the paints that strokes name, where the journal does not "
                         "say them");
            flags.option("--brushes", a->brushes,
                         "presets file (.json) with further brushes that strokes name");
            flags.flag("--recover", a->recover,
                       "leave out lines of a damaged journal that cannot be read, with a warning for each");
            flags
                .option("--mm-per-pixel", a->mm_per_pixel,
                        "size of the painting's pixels where the file does not say")
                .check(within(1e-4, 1e3));
            return [a] { return run_replay(*a); };
        }};
}

}  // namespace tangi
