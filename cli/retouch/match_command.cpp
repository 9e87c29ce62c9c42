// match_command.cpp: tangipaint match: a recipe from one's own paints for a colour or spectrum.
#include <chrono>
#include <filesystem>
#include <glm/matrix.hpp>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "cli/retouch/retouch_arguments.h"
#include "cli/retouch/treatment_arguments.h"
#include "paint/canvas/appearance.h"
#include "paint/files/canvas_file.h"
#include "retouch/colour_match/gloss.h"
#include "retouch/colour_match/reflectance_file.h"
#include "retouch/colour_match/swatches.h"
#include "retouch/fill/surroundings.h"
#include "retouch/mask/mask.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr double kMetameric = 1;  // index from which on a match is warned of
constexpr double kVisible = 1;    // CIEDE2000 of mixtures that count as having a colour
constexpr double kVaried = 5;     // CIEDE2000 of surroundings that no single recipe matches

struct MatchArguments {
    std::string spectrum, lab, srgb, xyz, painting, damaged, treatment, under = "D65", below, swatch,
                                                                        save_pairs;
    AreaArguments area;
    AuthorArguments author;
    PaintBoxArguments box;
    MatchOptions match;
    AnnulusOptions annulus;
    std::optional<double> film_mm, mm_per_pixel;
};

// What is to be matched, and what is known of it.
struct Wanted {
    Spectrum reflectance{};
    nlohmann::json described = nlohmann::json::object();
    std::optional<Gloss> gloss;
    std::optional<Spectrum> below;
};

Rgb colour_in(const std::string& text, const char* flag) {
    unsigned value = 0;
    const bool hex = text.size() == 7 && text[0] == '#' &&
                     text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    if (!hex) throw UsageError(fmt::format("{} {}: is no colour of the form #rrggbb", flag, text));
    value = static_cast<unsigned>(std::stoul(text.substr(1), nullptr, 16));
    const auto byte = [&](int shift) { return static_cast<float>(value >> shift & 255u) / 255; };
    const Transfer srgb{Transfer::Kind::srgb};
    return {srgb.decode(byte(16)), srgb.decode(byte(8)), srgb.decode(byte(0))};
}

glm::dvec3 three(const std::string& text, const char* flag) {
    const auto numbers = numbers_in(text, flag, "three numbers, as in 52,12.5,-30");
    if (numbers.size() != 3)
        throw UsageError(fmt::format("{} {}: give three numbers, as in 52,12.5,-30", flag, text));
    return {numbers[0], numbers[1], numbers[2]};
}

// XYZ of a colour under its illuminant; sRGB is what is seen by eyes used to the illuminant: relative to its
// white.
glm::dvec3 xyz_wanted(const MatchArguments& a, Illuminant illuminant) {
    if (!a.xyz.empty()) return three(a.xyz, "--xyz");
    const glm::dvec3 white = white_xyz(illuminant);
    if (!a.lab.empty()) {
        const glm::dvec3 lab = three(a.lab, "--lab");
        const double y = (lab.x + 16) / 116;
        const auto back = [](double f) { return f > 6.0 / 29 ? f * f * f : (116 * f - 16) * 27 / 24389; };
        return glm::dvec3(back(y + lab.y / 500), back(y), back(y - lab.z / 200)) * white;
    }
    const glm::dmat3 xyz_of_rgb(0.4124564, 0.2126729, 0.0193339, 0.3575761, 0.7151522, 0.1191920, 0.1804375,
                                0.0721750, 0.9503041);
    const glm::dvec3 d65 = xyz_of_rgb * glm::dvec3(colour_in(a.srgb, "--srgb"));
    return d65 / white_xyz(Illuminant::d65) * white;
}

Wanted of_colour(const glm::dvec3& xyz, Illuminant illuminant, const PaintBox& box,
                 const MatchOptions& options) {
    Wanted wanted;
    const auto likely = likely_spectrum(box.palette.paints, xyz, illuminant, options, kVisible);
    wanted.reflectance = likely ? likely->reflectance : smooth_spectrum(xyz, illuminant);
    wanted.described = {{"spectrum", likely ? "likely: of the mixtures with this colour"
                                            : "smooth: no mixture "
                                              "has this colour"},
                        {"seen_under", name_of(illuminant)},
                        {"xyz", {xyz.x, xyz.y, xyz.z}}};
    if (likely) {
        wanted.described["mixtures"] = likely->mixtures;
        wanted.described["spread_delta_e_2000"] = by_each_light(likely->spread);
    }
    return wanted;
}

Wanted of_painting(const MatchArguments& a, const std::optional<Treatment>& treatment, const PaintBox& box,
                   const MatchOptions& options, const Progress& progress) {
    Surface seen;
    {
        const Canvas canvas =
            treatment ? treatment->read_canvas(progress) : read_canvas(a.painting, progress, a.mm_per_pixel);
        seen = appearance(canvas, {}, progress);
        seen.mm_per_pixel = canvas.mm_per_pixel();
    }
    Mask mask(seen.width(), seen.height());
    Mask spoilt = a.damaged.empty() ? Mask() : read_mask(a.damaged, seen.width(), seen.height());
    if (treatment) {
        mask = a.area.area(*treatment);
        spoilt = spoilt.empty() ? damaged(*treatment) : united(spoilt, damaged(*treatment));
    } else {
        for (const std::string& file : a.area.masks)
            mask = united(mask, read_mask(file, seen.width(), seen.height()));
    }
    const Annulus round = annulus_of(seen, mask, spoilt, a.annulus);
    const glm::dvec3 xyz = xyz_of(reflectance_of_rgb(round.mode), Illuminant::d65);
    Wanted wanted = of_colour(xyz, Illuminant::d65, box, options);
    const Lab mode = lab_from_linear(round.mode), middle = lab_from_linear(round.median);
    wanted.described["surroundings"] = {{"pixels", round.pixels},
                                        {"mode_lab", {mode.l, mode.a, mode.b}},
                                        {"median_lab", {middle.l, middle.a, middle.b}},
                                        {"spread_delta_e_2000", round.spread},
                                        {"specular", round.specular},
                                        {"roughness", round.roughness}};
    if (round.spread > kVaried)
        warn(fmt::format(
            "beside the mask, colours vary by CIEDE2000 {:.0f}: the commonest is matched; a narrower "
            "--annulus-mm or a mask of a part of the loss gives the colour of one place",
            round.spread));
    wanted.gloss = Gloss{round.specular, round.roughness, xyz.y};
    Rgb sum(0);
    float weights = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        sum += mask.pixels()[i] * seen.diffuse.pixels()[i];
        weights += mask.pixels()[i];
    }
    if (weights > 0) wanted.below = reflectance_of_rgb(sum / weights);
    return wanted;
}

Wanted wanted_by(const MatchArguments& a, const std::optional<Treatment>& treatment, const PaintBox& box,
                 const MatchOptions& options, const Progress& progress) {
    if (!a.spectrum.empty()) {
        Wanted wanted;
        wanted.reflectance = read_reflectance(a.spectrum);
        wanted.described = {{"spectrum", "measured"}, {"file", a.spectrum}};
        return wanted;
    }
    if (treatment || !a.painting.empty()) return of_painting(a, treatment, box, options, progress);
    const Illuminant illuminant = parse_illuminant(a.under, "--under");
    return of_colour(xyz_wanted(a, illuminant), illuminant, box, options);
}

nlohmann::json gloss_advice(const Mixture& mixture, const PaintBox& box, double luminance,
                            const std::optional<Gloss>& wanted) {
    const Gloss paint = gloss_of(mixture, box.palette.paints, luminance);
    nlohmann::json json = {{"specular", paint.specular}, {"roughness", paint.roughness}};
    if (!wanted) return json;
    json["wanted"] = {{"specular", wanted->specular}, {"roughness", wanted->roughness}};
    json["difference"] = gloss_difference(paint, *wanted);
    json["remedy"] = name_of(remedy_for(paint, *wanted));
    json["within_reach"] = can_reflect(paint, *wanted);
    return json;
}

nlohmann::json described(const MatchedRecipe& r, const PaintBox& box, const Wanted& wanted) {
    nlohmann::json json = as_json(r.steps, r.mixture, box.palette.paints);
    json["delta_e_2000"] = by_each_light(r.delta_e);
    json["error"] = r.error;
    json["error_not_bound_to_measures"] = r.ideal_error;
    json["metamerism_index"] = by_each_light(r.metamerism);
    json["reflectance"] = r.look;
    json["gloss"] = gloss_advice(r.mixture, box, xyz_of(r.look, Illuminant::d65).y, wanted.gloss);
    json["warnings"] = warnings_of(r.mixture, box);
    for (const Illuminant illuminant : {Illuminant::a, Illuminant::f11}) {
        const double index = r.metamerism[static_cast<std::size_t>(illuminant)];
        if (index > kMetameric)
            json["warnings"].push_back(
                fmt::format("metameric: where it matches under D65, it differs by CIEDE2000 {:.1f} under {}",
                            index, name_of(illuminant)));
    }
    return json;
}

std::string table_of(const MatchResult& result, const PaintBox& box) {
    std::string text =
        fmt::format("{:>6} {:>6} {:>6} {:>6} {:>6}   recipe\n", "A", "D50", "D65", "F11", "LED");
    for (const MatchedRecipe& r : result.recipes) {
        for (const double d : r.delta_e) text += fmt::format("{:6.2f} ", d);
        text += "  " + text_of(r.steps, box.palette.paints) + "\n";
    }
    return text;
}

void require_one_target(const MatchArguments& a) {
    int targets = 0;
    for (const std::string* text : {&a.spectrum, &a.lab, &a.srgb, &a.xyz, &a.painting, &a.treatment})
        targets += text->empty() ? 0 : 1;
    if (targets != 1)
        throw UsageError(
            "say what to match, once: --spectrum FILE, --lab L,a,b, --xyz X,Y,Z, --srgb #rrggbb, "
            "PAINTING.exr with --mask, or --treatment with --class");
    if (a.treatment.empty() &&
        (a.painting.empty() != a.area.masks.empty() || !a.area.classes.empty() || !a.area.polygons.empty()))
        throw UsageError("PAINTING.exr and --mask belong together: the colour is that beside the mask");
    if (!a.treatment.empty() && a.area.empty())
        throw UsageError("say beside what the colour is matched: --treatment DIR --class loss_to_ground");
    if (!a.below.empty() && !a.film_mm)
        throw UsageError("--below: says what a film lies on; give its thickness by --film-mm");
}

// What the command writes: put in place together, when all of it is there.
struct MatchFiles {
    std::optional<AtomicFile> pairs, swatch;
    OutputSet set;
};

void write_pairs(const MatchArguments& a, MatchFiles& files) {
    if (a.save_pairs.empty()) return;
    refuse_to_overwrite(a.save_pairs, a.box.inputs());
    files.pairs.emplace(a.save_pairs).write(usual_pigment_pairs_text());
    files.set.add(*files.pairs);
}

void require_sound_swatch(const MatchArguments& a) {
    if (a.swatch.empty()) return;
    std::vector<fs::path> inputs = a.box.inputs();
    for (const std::string& file : {a.spectrum, a.painting, a.damaged})
        if (!file.empty()) inputs.emplace_back(file);
    for (const fs::path& file : a.area.inputs()) inputs.push_back(file);
    refuse_to_overwrite(a.swatch, inputs);
    require_picture_ending(a.swatch, "--swatch");
    std::error_code missing;
    if (a.swatch == a.save_pairs || fs::equivalent(a.swatch, a.save_pairs, missing))
        fail("--swatch {}: is the file of --save-pairs too; choose another name", a.swatch);
}

void write_swatch(const MatchArguments& a, const Image<Rgb>& swatches, MatchFiles& files) {
    const bool linear = lower_extension(a.swatch) == ".exr";
    told_of(files.swatch.emplace(a.swatch).temporary(), a.swatch, [&] {
        write_picture(files.swatch->temporary(), swatches,
                      linear ? Transfer{} : Transfer{Transfer::Kind::srgb}, {.bits = 8});
    });
    files.set.add(*files.swatch);
}

// A film of paint, and what it lies on: what was given, or is in the mask, or a white ground.
std::optional<FilmOnGround> film_of(const MatchArguments& a, const Wanted& wanted) {
    if (!a.film_mm) return {};
    Spectrum below;
    below.fill(0.82f);  // paper or gesso
    if (!a.below.empty())
        below = reflectance_of_rgb(colour_in(a.below, "--below"));
    else if (wanted.below)
        below = *wanted.below;
    return FilmOnGround{*a.film_mm, below};
}

nlohmann::json target_of(const Wanted& wanted) {
    const Lab lab = lab_under(wanted.reflectance);
    nlohmann::json target = wanted.described;
    target["reflectance"] = wanted.reflectance;
    target["lab"] = {lab.l, lab.a, lab.b};
    return target;
}

nlohmann::json result_of(const MatchResult& found, const PaintBox& box, const Wanted& wanted,
                         const MatchOptions& options) {
    nlohmann::json recipes = nlohmann::json::array(), by_count = nlohmann::json::array();
    for (const MatchedRecipe& r : found.recipes) recipes.push_back(described(r, box, wanted));
    for (const MatchedRecipe& r : found.by_count)
        by_count.push_back({{"paints", r.mixture.count},
                            {"recipe", text_of(r.steps, box.palette.paints)},
                            {"error", r.error}});
    nlohmann::json illuminants = nlohmann::json::array();
    for (const Illuminant illuminant : options.illuminants) illuminants.push_back(name_of(illuminant));
    nlohmann::json result = {{"palette", box.palette.name}, {"media", box.media},
                             {"target", target_of(wanted)}, {"illuminants", illuminants},
                             {"recipes", recipes},          {"fewer_paints", by_count}};
    if (found.recipes.front().error > kPoorMatch)
        result["poor"] = {fmt::format("the nearest recipe of these paints is off by CIEDE2000 {:.1f}",
                                      found.recipes.front().error)};
    return result;
}

// In the treatment's log; what is written comes into its place with it.
void record(Treatment& treatment, const MatchArguments& a, const MatchOptions& options,
            const nlohmann::json& result, MatchFiles& files, const Progress& progress) {
    TreatmentStep step{.action = "match", .parameters = parameters_of(options), .inputs = a.box.inputs()};
    step.parameters["area"] = a.area.as_json();
    step.parameters["annulus"] = to_json(a.annulus);
    step.parameters["palette"] = result["palette"], step.parameters["avoid_pairs"] = a.box.avoid_pairs;
    if (a.film_mm) step.parameters["film_mm"] = *a.film_mm;
    if (!a.below.empty()) step.parameters["below"] = a.below;
    for (const fs::path& file : a.area.inputs()) step.inputs.push_back(file);
    if (!a.damaged.empty()) step.inputs.emplace_back(a.damaged);
    step.results = result;
    step.results.erase("seconds"), step.results.erase("picture");
    step.elsewhere = [&] { files.set.commit(); };
    treatment.record(step, a.author.author(), progress);
}

bool only_saves_pairs(const MatchArguments& a) {
    return !a.save_pairs.empty() && a.spectrum.empty() && a.lab.empty() && a.srgb.empty() && a.xyz.empty() &&
           a.painting.empty() && a.treatment.empty();
}

nlohmann::json run_match(const MatchArguments& a) {
    MatchFiles files;
    if (only_saves_pairs(a)) {
        write_pairs(a, files);
        files.set.commit();
        return {{"pairs", a.save_pairs}};
    }
    require_one_target(a);
    require_sound_swatch(a);
    write_pairs(a, files);
    const Progress progress = console_progress();
    const PaintBox box = paint_box(a.box);
    MatchOptions options = a.match;
    set_options(a.box, box, options);
    std::optional<Treatment> treatment;
    if (!a.treatment.empty()) treatment = open_treatment(a.treatment);
    const Wanted wanted = wanted_by(a, treatment, box, options, progress);
    if (const auto film = film_of(a, wanted)) options.film = film;

    const auto start = std::chrono::steady_clock::now();
    const MatchResult found = match_spectrum(box.palette.paints, wanted.reflectance, options);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;

    nlohmann::json result = result_of(found, box, wanted, options);
    result["goal"] = a.box.goal, result["seconds"] = seconds.count();
    if (a.film_mm) result["film_mm"] = *a.film_mm;
    if (!a.swatch.empty()) {
        write_swatch(a, recipe_swatches(wanted.reflectance, found.recipes, box.palette.paints), files);
        result["picture"] = a.swatch;
    }
    if (treatment)
        record(*treatment, a, options, result, files, progress);
    else
        files.set.commit();
    tell_lines(table_of(found, box));
    return result;
}

}  // namespace

Command match_command() {
    return {
        "match", "find recipes from one's own paints for a colour, a spectrum, or what is beside a loss",
        [](Flags& flags) {
            auto a = std::make_shared<MatchArguments>();
            flags.option("PAINTING", a->painting, "painting (.exr or .tangi), with --mask");
            a->area.add_to(flags, "where the loss is: its surroundings are matched");
            flags.option(
                "--treatment", a->treatment,
                "treatment to look at and log in (docs/guide/retouching.md), instead of PAINTING.exr");
            a->author.add_to(flags);
            flags.option("--damaged", a->damaged, "picture, white where there is other damage beside it");
            flags.option("--spectrum", a->spectrum,
                         "measured reflectance: text, a wavelength in nm and a reflectance (0..1) a line");
            flags.option("--lab", a->lab, "L,a,b under the illuminant --under").value_name("L,a,b");
            flags.option("--xyz", a->xyz, "X,Y,Z under it, Y of white is 1").value_name("X,Y,Z");
            flags.option("--srgb", a->srgb, "colour as seen by eyes that are used to the illuminant")
                .value_name("#rrggbb");
            flags.option("--under", a->under, "illuminant that the colour is seen under").show_default();
            flags.option("--film-mm", a->film_mm, "thickness of the paint; without, it hides what is below")
                .check(within(0.001, 10));
            flags
                .option("--below", a->below,
                        "what the film lies on; without, what is in the mask, or a white ground")
                .value_name("#rrggbb");
            flags
                .option("--mm-per-pixel", a->mm_per_pixel,
                        "size of the painting's pixels where the file does not say")
                .check(within(1e-4, 1e3));
            a->box.add_to(flags);
            flags.fields(a->match);
            flags.fields(a->annulus);
            flags.option("--swatch", a->swatch,
                         "picture to write (.png .tif .jpg .exr): target and recipes under all illuminants");
            flags.option("--save-pairs", a->save_pairs,
                         "file to write: the built-in list of pairs, to be edited");
            return [a] { return run_match(*a); };
        }};
}

}  // namespace tangi
