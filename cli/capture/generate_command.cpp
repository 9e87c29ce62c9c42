// generate_command.cpp: tangipaint generate --out DIR: photographs of a procedural painting, with ground
// truth.
#include <charconv>
#include <filesystem>
#include <set>

#include "capture/formats/lights_file.h"
#include "capture/photo/photo_file.h"
#include "cli/arguments.h"
#include "cli/command_list.h"
#include "datasets/positions.h"
#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/output_set.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct GenerateArguments {
    std::string out, reflectance = "ggx", arrangement = "dome", format = "png16", transfer = "linear";
    std::string positions;  // "3x2"; empty: one stack of the whole
    std::uint64_t seed = 1;
    PaintingOptions painting;
    GeneratorOptions photos;
    PositionsOptions in_parts;
};

template <class Value>
Value chosen(const std::optional<Value>& value, const char* flag, const std::string& text,
             const char* allowed) {
    if (!value) throw UsageError(fmt::format("{} {}: is not one of {}", flag, text, allowed));
    return *value;
}

bool is_generated(const fs::path& folder) {
    const fs::path file = folder / "gt" / "meta.json";
    if (!fs::exists(file)) return false;
    const auto meta = json_or_discarded(read_text_file(file));
    return meta.is_object() && meta.contains("generator");
}

// Photographs that generate did not make are not replaced by made-up ones.
void refuse_to_overwrite_photographs(const fs::path& folder) {
    if (!fs::is_directory(folder) || is_generated(folder)) return;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name == "lights.lp" || (name.starts_with("img_") && is_photo_name(entry.path())))
            fail("--out {}: would overwrite {}, which is not a generated stack's; choose another folder",
                 folder.string(), entry.path().string());
    }
}

// Photographs of a stack that generate wrote here before, as its lights files name them.
std::vector<fs::path> photographs_before(const fs::path& folder) {
    std::vector<fs::path> photographs;
    if (!is_generated(folder)) return photographs;
    for (const fs::path& lights : {folder / "lights.lp", folder / "heldout" / "heldout.lp"}) {
        if (!fs::is_regular_file(lights)) continue;
        try {
            for (const Light& light : read_lights_file(lights).lights)
                if (const fs::path name = light.name;
                    name == name.filename() &&
                    (light.name.starts_with("img_") || light.name.starts_with("heldout_")))
                    photographs.push_back(lights.parent_path() / name);
        } catch (const Error&) {  // somebody's own: what it names is not looked for
        }
    }
    return photographs;
}

// What generate writes to gt/.
bool is_truth(const std::string& name) {
    static const std::set<std::string> names = {
        "height.exr",   "normal.exr",  "albedo.exr", "specular.exr", "roughness.exr",  "roughness_v.exr",
        "tangent.exr",  "lobe.exr",    "loss.png",   "varnish.png",  "craquelure.png", "retouch.png",
        "abrasion.png", "flaking.png", "stain.png",  "old_fill.png", "overpaint.png",  "valid.png",
        "lights.json",  "meta.json",   "truth.exr"};
    return names.contains(name);
}

// What is left of them would be taken for photographs of the new stack, and their truth for its.
void withdraw_left_over(OutputSet& set, const fs::path& folder, const std::vector<fs::path>& before,
                        const fs::path& written) {
    if (!is_generated(folder)) return;
    std::vector<fs::path> all = before;
    all.push_back(folder / "heldout" / "heldout.lp");
    for (const auto& entry : fs::directory_iterator(folder / "gt"))
        if (is_truth(entry.path().filename().string())) all.push_back(entry.path());
    for (const fs::path& file : all)
        if (const fs::path name = file.lexically_relative(folder); !fs::exists(written / name))
            set.withdraw(folder, name);
}

// Columns and rows of "3x2".
void take_grid(const std::string& text, PositionsOptions& options) {
    const char* const end = text.data() + text.size();
    const auto [cross, first] = std::from_chars(text.data(), end, options.columns);
    const bool crossed = first == std::errc() && cross != end && *cross == 'x';
    if (crossed)
        if (const auto [rest, second] = std::from_chars(cross + 1, end, options.rows);
            second == std::errc() && rest == end)
            return;
    throw UsageError(fmt::format("--positions {}: give columns and rows, such as 3x2", text));
}

// A stack for each position of the camera, in the place of what was written so before.
nlohmann::json run_positions(GenerateArguments& a, const Progress& progress) {
    take_grid(a.positions, a.in_parts);
    AtomicFolder folder(a.out, "positions.json");
    nlohmann::json written;
    told_of(folder.temporary(), a.out, [&] {
        written = write_positions(folder.temporary(), a.painting, a.in_parts, a.photos, progress);
        write_text_file(folder.temporary() / "positions.json", json_lines(written, 1));
    });
    folder.commit();
    nlohmann::json options = to_json(a.photos);
    options["positions"] = written.at("options");
    return {{"folder", a.out},
            {"photographs",
             written.at("positions").size() * static_cast<std::size_t>(a.photos.lights + a.photos.held_out)},
            {"width", a.painting.width},
            {"height", a.painting.height},
            {"mm_per_pixel", a.painting.mm_per_pixel},
            {"positions", written.at("positions")},
            {"options", options}};
}

nlohmann::json run_generate(GenerateArguments a) {
    a.painting.seed = a.photos.seed = a.seed;
    a.photos.reflectance = chosen(reflectance_named(a.reflectance), "--reflectance", a.reflectance,
                                  "ggx, ward_bounded, lambert");
    a.photos.arrangement =
        chosen(arrangement_named(a.arrangement), "--arrangement", a.arrangement, "dome, spiral");
    a.photos.format =
        chosen(generator_format_named(a.format), "--format", a.format, "png16, png8, jpg, exr, tif");
    a.photos.transfer = chosen(transfer_named(a.transfer), "--transfer", a.transfer, "linear, srgb, a gamma");
    refuse_to_overwrite_photographs(a.out);
    const Progress progress = console_progress();
    if (!a.positions.empty()) return run_positions(a, progress);
    const std::vector<fs::path> before = photographs_before(a.out);
    FolderFiles written(a.out);  // all of them, or none
    const PaintingTruth truth = procedural_painting(a.painting, progress);
    Photography photography;
    told_of(written.temporary(), a.out,
            [&] { photography = write_stack(written.temporary(), truth, a.photos, progress); });
    OutputSet set;
    set.add(written);
    withdraw_left_over(set, a.out, before, written.temporary());
    set.commit();
    return {{"folder", a.out},
            {"photographs", photography.photos.size()},
            {"width", truth.width()},
            {"height", truth.height()},
            {"mm_per_pixel", truth.mm_per_pixel},
            {"options", to_json(a.photos)}};
}

// The seed belongs to painting and photographs alike, so it is one flag.
template <class Options>
void add_fields_but_seed(Flags& flags, Options& options) {
    flags.fields(options, [](std::string_view field) { return field != "seed"; });
}

// Of which `--positions` says how many there are.
void add_positions(Flags& flags, GenerateArguments& a) {
    flags.option("--positions", a.positions,
                 "photograph it in overlapping parts, a stack each: columns and rows, such as 3x2");
    flags.fields(a.in_parts, [](std::string_view field) { return field != "columns" && field != "rows"; });
}

}  // namespace

Command generate_command() {
    return {"generate", "make photographs of a procedural painting, with ground truth, to test with",
            [](Flags& flags) {
                auto a = std::make_shared<GenerateArguments>();
                flags.option("--out", a->out, "folder to write; one of an earlier generate is written anew")
                    .required();
                flags.option("--seed", a->seed, "another painting for each number")
                    .check(within(0.0, 9e15))
                    .show_default();
                flags.option("--reflectance", a->reflectance, "ggx, ward_bounded or lambert").show_default();
                flags.option("--arrangement", a->arrangement, "of the lights: dome or spiral").show_default();
                flags.option("--format", a->format, "png16, png8, jpg, exr or tif").show_default();
                flags.option("--transfer", a->transfer, "linear, srgb or a gamma such as 2.2").show_default();
                add_fields_but_seed(flags, a->painting);
                add_fields_but_seed(flags, a->photos);
                add_positions(flags, *a);
                return [a, typed = flags.typed()] {
                    if (a->positions.empty())
                        refuse_typed(typed(),
                                     {"--overlap", "--position-shift", "--position-roll-deg",
                                      "--position-tilt-deg", "--position-zoom", "--position-exposure",
                                      "--camera-distance", "--whole-truth", "--no-whole-truth"},
                                     "is of several positions; give --positions as well");
                    return run_generate(*a);
                };
            }};
}

}  // namespace tangi
