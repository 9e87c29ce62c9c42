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

nlohmann::json run_replay(const ReplayArguments& a) {
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
    const std::string& strokes = a.files.back();
    if (lower_extension(strokes) == ".exr")
        throw UsageError(fmt::format("{}: is a painting; the journal of strokes comes last", strokes));
    std::vector<fs::path> inputs(a.files.begin(), a.files.end());
    for (const std::string& file : {a.palette, a.brushes})
        if (!file.empty()) inputs.emplace_back(file);
    for (const fs::path& file : a.substrate.inputs()) inputs.push_back(file);
    refuse_to_overwrite(a.out, inputs);
    if (!a.board.empty()) refuse_to_overwrite(a.board, inputs, "--board");
    if (!a.frames.video.empty()) refuse_to_overwrite(a.frames.video, inputs, "--video");
    for (const std::string& file : {a.out, a.board})
        if (!file.empty() && lower_extension(file) != ".exr") fail("{}: a painting is an .exr file", file);
    if (!a.board.empty() && fs::weakly_canonical(a.board) == fs::weakly_canonical(a.out))
        throw UsageError(fmt::format("--board {}: is where the painting goes; give another name", a.board));
    const Progress progress = console_progress();
    std::vector<std::string> warnings = a.substrate.warnings();
    const auto brushes = a.brushes.empty() ? brush_presets() : read_brush_presets(a.brushes, &warnings);
    const Journal journal = a.recover ? recovered_journal(strokes, brushes) : read_journal(strokes, brushes);
    AtomicFile out(a.out);  // that it can be written is known before the work
    std::optional<AtomicFile> board;
    if (!a.board.empty()) board.emplace(a.board);
    if (!a.palette.empty()) refuse_palette(journal);
    Session session(canvas_of(a, progress), a.palette.empty() ? artist_acrylics() : read_palette(a.palette));
    session.masks_from(masks_beside(strokes, session.canvas().width(), session.canvas().height()));
    if (!a.substrate.given()) read_tools(a.files.front(), session, progress);
    if (!session.canvas().dry().scale_known && !a.mm_per_pixel && session.canvas().mm_per_pixel() == 1)
        warnings.push_back(fmt::format(
            "{}: its scale is unknown: a pixel is taken for one mm; give --mm-per-pixel", a.files.front()));
    const std::string dry_hash = hash_of(session.canvas().dry());
    if (!a.substrate.given() && !journal.head.on.empty() &&
        journal.head.on != hash_of(session.canvas(), dry_hash))
        warnings.push_back(
            fmt::format("{}: goes on from another painting than {} is, as its first line says; its strokes "
                        "are laid all the "
                        "same",
                        strokes, a.files.front()));
    const auto start = std::chrono::steady_clock::now();
    std::optional<TimeLapse> frames;
    if (a.frames.given()) frames.emplace(a.frames, journal, session);
    for (std::string& warning : replay(session, journal, progress)) warnings.push_back(std::move(warning));
    if (frames) frames->complete();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const Canvas& canvas = session.canvas();
    std::vector<PartToWrite> further;  // goes with the dry layer, which painting does not change
    if (!a.substrate.given()) further = parts_beside_paint(a.files.front(), progress);
    if (board && !session.board()) {  // no reason to lose the painting
        warnings.push_back(fmt::format(
            "--board {}: is not written: nothing was done on the palette, so there is none", a.board));
        board.reset();
    }
    // What a run makes belongs together: all of it is written before any of it takes its place.
    fill_canvas(out, canvas, progress, with_tools(std::move(further), session));
    if (board) fill_canvas(*board, *session.board(), progress, {});
    OutputSet set;
    set.add(out);
    if (board) set.add(*board);
    if (frames) frames->add_to(set);
    set.commit();

    nlohmann::json layers = nlohmann::json::array();
    for (const DriedLayer& layer : canvas.dried()) layers.push_back(layer.name);
    return {{"painting", a.out},
            {"width", canvas.width()},
            {"height", canvas.height()},
            {"mm_per_pixel", canvas.mm_per_pixel()},
            {"strokes", session.totals().strokes},
            {"points", session.totals().points},
            {"steps", session.totals().steps},
            {"bristle_pixels", session.totals().bristle_pixels},
            {"seconds", seconds.count()},
            {"volumes_mm3", volumes_by_name(canvas.ingredients(), canvas.volumes_mm3())},
            {"layers", layers},
            {"dry_hash", dry_hash},
            {"frames", frames ? frames->frames() : 0},
            {"warnings", told(warnings)}};
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
