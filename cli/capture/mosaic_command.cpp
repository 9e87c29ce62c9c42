// mosaic_command.cpp: tangipaint mosaic POSITION… --out WALL.exr: many positions of one painting to one.
#include <algorithm>
#include <filesystem>

#include "cli/arguments.h"
#include "cli/capture/fit_folder.h"
#include "cli/command_list.h"
#include "cli/result_summary.h"
#include "fit/mosaic/mosaic_report.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_output.h"
#include "surface/painting_file/painting_reader.h"
#include "surface/provenance/fit_doubts.h"
#include "surface/provenance/provenance.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct MosaicArguments {
    std::vector<std::string> positions;
    std::string out, layout, report, picture;
    MosaicOptions options;
};

// A position as it was named, and the painting that is read of it.
struct NamedPosition {
    std::string name;
    fs::path painting;
};

// "wall/r0_c1.exr" and "wall/r0_c1/" are r0_c1.
std::string name_of(const fs::path& path) {
    const fs::path plain = path.has_filename() ? path : path.parent_path();
    return fs::is_directory(path) && !names_painting(path) ? plain.filename().string()
                                                           : plain.stem().string();
}

struct MosaicFiles {
    explicit MosaicFiles(const MosaicArguments& a) : painting(a.out) {
        if (!a.report.empty()) page.emplace(a.report);
        if (!a.picture.empty()) picture.emplace(a.picture);
    }
    PaintingOutput painting;
    std::optional<AtomicFile> page, picture;
};

void require_sound(const MosaicArguments& a) {
    require_painting_ending(a.out);
    if (!a.report.empty()) require_ending(a.report, {".html"}, "a page is an .html file", "--report");
    if (!a.picture.empty())
        require_ending(a.picture, {".svg"}, "the layout's picture is an .svg file", "--picture");
    if (a.positions.size() < 2)
        throw UsageError(
            fmt::format("give two positions or more; {} alone is a painting already, or becomes one "
                        "by tangipaint fit",
                        a.positions[0]));
    std::vector<fs::path> inputs(a.positions.begin(), a.positions.end());
    if (!a.layout.empty()) inputs.emplace_back(a.layout);
    for (const std::string& output : {a.out, a.report, a.picture})
        if (!output.empty()) refuse_to_overwrite(output, inputs);
}

// Whether a painting is the fit of a stack as it is now.
bool is_fit_of(const fs::path& painting, const fs::path& stack) {
    const nlohmann::json made = json_or_discarded(open_painting(painting)->header().provenance);
    if (!made.is_object() || made.value("command", "") != "fit" || !made.contains("inputs")) return false;
    std::vector<fs::path> inputs;
    for (const nlohmann::json& record : made.at("inputs")) inputs.push_back(stack / record.value("file", ""));
    return !inputs.empty() && !changed_since(made.at("inputs"), inputs);
}

// Fits a stack, in a folder of the wall's fits, where that was not done before: the work of hours stays.
fs::path fitted(const fs::path& stack, const fs::path& out, std::vector<std::string>& warnings,
                const Progress& progress) {
    fs::path folder = out;
    folder.replace_extension(".fits");
    MadeFolders made;  // gone again where the fit does not come about
    made.make(folder);
    fs::path painting = folder / (name_of(stack) + ".exr");
    if (fs::exists(painting) && is_painting(painting) && is_fit_of(painting, stack)) {
        warnings.push_back(fmt::format("{}: {} is taken, which was fitted before; remove it to fit it again",
                                       stack.string(), painting.string()));
        return painting;
    }
    if (fs::exists(painting) && !is_painting(painting))
        fail("{}: is to become the fit of {}, but is something else; move it away", painting.string(),
             stack.string());
    fit_folder(stack, painting, progress);
    made.keep();
    return painting;
}

NamedPosition position_named(const std::string& text, const fs::path& out, std::vector<std::string>& warnings,
                             const Progress& progress) {
    fs::path path = fs::path(text).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();  // as shells complete names of folders
    if (path == "." || path.filename() == "..") path = fs::canonical(path);
    if (!fs::exists(path)) fail("{}: no such file or folder; name a painting (.exr) or a stack", text);
    if (names_painting(path) && is_painting(path)) return {name_of(path), path};
    if (fs::is_directory(path)) return {name_of(path), fitted(path, out, warnings, progress)};
    fail(
        "{}: is neither a painting (.exr, .tangi) nor a folder of photographs; fit it first, or name its "
        "folder",
        text);
}

MosaicPosition read_position(const NamedPosition& named, const Progress& progress) {
    auto surface = std::make_shared<const Surface>(read_painting(named.painting, progress));
    std::shared_ptr<const FitErrors> errors;
    if (has_errors(named.painting))
        errors = std::make_shared<const FitErrors>(read_errors(named.painting, progress));
    const std::string hash = hash_of(*surface);
    return position_of(named.name, std::move(surface), std::move(errors), hash);
}

nlohmann::json places_in(const std::optional<LayoutHint>& hint, const std::vector<std::string>& names) {
    nlohmann::json places = nlohmann::json::array();
    if (hint)
        for (std::size_t i = 0; i < names.size(); ++i)
            places.push_back({{"name", names[i]}, {"column", hint->places[i].x}, {"row", hint->places[i].y}});
    return places;
}

// Pairs that it rules out are never compared: who gave the names for another reason is to know before the
// work.
void tell_layout_of_names(const LayoutHint& hint, const std::vector<std::string>& names) {
    constexpr std::size_t kMostTold = 6;  // a line or two
    std::string places;
    for (std::size_t i = 0; i < std::min(names.size(), kMostTold); ++i)
        places += fmt::format("{}{} in row {}, column {}", i > 0 ? "; " : "", names[i], hint.places[i].y,
                              hint.places[i].x);
    tell(
        fmt::format("layout by the last two numbers of the names: {}{}; only neighbours are compared, "
                    "--layout FILE says who they are where that is wrong",
                    places, names.size() > kMostTold ? "; …" : ""));
}

std::optional<LayoutHint> hint_of(const MosaicArguments& a, const std::vector<std::string>& names) {
    if (!a.layout.empty()) return read_layout_hint(a.layout, names);
    std::optional<LayoutHint> hint = layout_hint_of(names);
    if (hint) tell_layout_of_names(*hint, names);
    return hint;
}

void save(MosaicFiles& files, const std::vector<MosaicPosition>& positions, const Mosaic& mosaic,
          const MosaicOptions& options, const Progress& progress) {
    std::vector<PartToWrite> parts;
    if (!mosaic.errors.slope.empty()) parts.push_back(part_of(mosaic.errors));
    files.painting.fill(mosaic.surface, std::move(parts), progress);
    OutputSet set;
    files.painting.add_to(set);
    if (files.page) {
        files.page->write(
            mosaic_page(positions, mosaic.report, options, files.painting.target().filename().string()));
        set.add(*files.page);
    }
    if (files.picture) {
        files.picture->write(layout_picture(positions, mosaic.report, options));
        set.add(*files.picture);
    }
    set.commit();
}

nlohmann::json run_mosaic(const MosaicArguments& a) {
    require_sound(a);
    MosaicFiles files(a);
    const Progress progress = console_progress();
    std::vector<std::string> warnings, names;
    std::vector<fs::path> paintings;
    std::vector<MosaicPosition> positions;
    for (const std::string& text : a.positions) {
        const NamedPosition named = position_named(text, a.out, warnings, progress);
        if (std::ranges::find(names, named.name) != names.end())
            fail("{}: two positions are called {}; rename one", text, named.name);
        positions.push_back(read_position(named, progress));
        names.push_back(named.name), paintings.push_back(named.painting);
    }
    const std::optional<LayoutHint> hint = hint_of(a, names);
    Mosaic mosaic = make_mosaic(positions, hint, a.options, progress);
    std::vector<std::string>& own = mosaic.report.warnings;
    own.insert(own.begin(), warnings.begin(), warnings.end());
    nlohmann::json options = to_json(a.options);
    if (!a.layout.empty()) options["layout"] = portable_path(a.layout, fs::path(a.out).parent_path());
    const nlohmann::json provenance = provenance_of("mosaic", options, records_of(paintings));
    mosaic.surface.provenance = with_doubts(json_line(provenance), mosaic.report.poor, own);
    save(files, positions, mosaic, a.options, progress);
    nlohmann::json result = to_json(positions, mosaic.report);
    result["painting"] = a.out;
    result["layout_hint"] = !a.layout.empty() ? "file" : hint ? "names" : "none";
    result["layout"] = places_in(hint, names);
    result["options"] = options;
    result["inputs"] = provenance.at("inputs");
    result["warnings"] = told(own);
    result["poor"] = mosaic.report.poor;
    return result;
}

std::vector<std::string> mosaic_in_words(const nlohmann::json& result) {
    const std::size_t left_out = result.at("left_out").size(), all = result.at("positions").size();
    return {fmt::format("{}: {} × {} pixels, of {}{}", result.at("painting").get<std::string>(),
                        result.at("width").get<int>(), result.at("height").get<int>(),
                        counted(all - left_out, "position"),
                        left_out > 0 ? fmt::format(" ({} left out)", left_out) : ""),
            fmt::format("overlaps fit to {:.2f} pixels: {}", result.at("residual_px").get<double>(),
                        verdict_in_words(result))};
}

}  // namespace

Command mosaic_command() {
    return {
        "mosaic", "join fitted paintings of overlapping parts to one painting",
        [](Flags& flags) {
            auto a = std::make_shared<MosaicArguments>();
            flags
                .option(
                    "POSITION", a->positions,
                    "paintings (.exr) of parts that overlap, or folders of photographs, which are fitted; "
                    "the first one's pixels and scale are the wall's")
                .required();
            flags
                .option("--out", a->out,
                        "painting to write (.exr, or .tangi, a folder, of one larger than memory)")
                .required();
            flags.option("--layout", a->layout,
                         "which positions are beside each other: JSON or CSV with name, column, row (else by "
                         "numbers in their names, or all are tried)");
            flags.option("--report", a->report, "page to write: layout, overlaps, seams (.html)");
            flags.option("--picture", a->picture, "picture of the layout to write (.svg)");
            flags.fields(a->options);
            return [a] { return run_mosaic(*a); };
        },
        mosaic_in_words};
}

}  // namespace tangi
