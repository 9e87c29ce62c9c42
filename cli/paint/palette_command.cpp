// palette_command.cpp: tangipaint palette [FILE] [--out CARDS.png]: what the paints of a palette are and look
// like.
#include <filesystem>

#include "cli/arguments.h"
#include "cli/command_list.h"
#include "paint/optics/drawdown_card.h"
#include "paint/optics/kubelka_munk.h"
#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

struct PaletteArguments {
    std::string file, out, save, illuminant = "D65";
    DrawdownOptions drawdown;
    std::function<std::vector<std::string>()> typed;  // flags of the command
};

nlohmann::json described(const Pigment& paint, Illuminant illuminant) {
    // A clear medium shows what is below: on white here.
    const bool clear = is_clear(paint);
    Spectrum white;
    white.fill(1);
    const Spectrum look = clear ? white : opaque_look({paint.k, paint.s});
    const Lab lab = lab_under(look, illuminant);
    const Rgb srgb = Transfer{Transfer::Kind::srgb}.encode(to_linear_rgb(look, illuminant));
    const auto byte = [](float v) { return static_cast<int>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255)); };
    return {{"name", paint.name},
            {"from", name_of(paint.origin)},
            {"approximate", paint.approximate()},
            {"clear", clear},
            {"lab", {lab.l, lab.a, lab.b}},
            {"srgb", fmt::format("#{:02x}{:02x}{:02x}", byte(srgb.r), byte(srgb.g), byte(srgb.b))},
            {"hides_at_mm", clear ? nlohmann::json(nullptr) : nlohmann::json(hiding_thickness_mm(paint))},
            {"source", paint.source}};
}

void refuse_to_save_over(const fs::path& palette, const std::vector<fs::path>& others) {
    std::error_code missing;
    for (const fs::path& other : others)
        if (palette == other || fs::equivalent(palette, other, missing))
            fail("--save {}: is the file of {} too; choose another name", palette.string(),
                 &other == &others[0] ? "the palette that is read" : "--out");
}

nlohmann::json run_palette(const PaletteArguments& a) {
    const Illuminant illuminant = parse_illuminant(a.illuminant, "--illuminant");
    if (a.out.empty())
        refuse_typed(a.typed(), {"--card-px", "--columns", "--thickest-mm", "--tint"},
                     "is of the drawdown cards: give a picture for them with --out");
    if (!a.file.empty() && !a.out.empty()) refuse_to_overwrite(a.out, {a.file});
    if (!a.save.empty()) refuse_to_save_over(a.save, {a.file, a.out});
    if (!a.out.empty()) require_picture_ending(a.out);
    const Progress progress = console_progress();
    const Palette palette = a.file.empty() ? artist_acrylics() : read_palette(a.file);
    nlohmann::json paints = nlohmann::json::array();
    for (const Pigment& paint : palette.paints) paints.push_back(described(paint, illuminant));
    nlohmann::json result = {{"name", palette.name}, {"illuminant", name_of(illuminant)}, {"paints", paints}};
    std::optional<AtomicFile> picture, saved;
    OutputSet set;
    if (!a.out.empty()) {
        const Image<Rgb> cards = drawdown_cards(palette, illuminant, a.drawdown, progress);
        const bool linear = lower_extension(a.out) == ".exr";
        told_of(picture.emplace(a.out).temporary(), a.out, [&] {
            write_picture(picture->temporary(), cards, linear ? Transfer{} : Transfer{Transfer::Kind::srgb},
                          {.bits = 8});
        });
        set.add(*picture);
        result["picture"] = a.out;
    }
    if (!a.save.empty()) {
        told_of(saved.emplace(a.save).temporary(), a.save,
                [&] { write_palette(saved->temporary(), palette); });
        set.add(*saved);
        result["palette"] = a.save;
    }
    set.commit();
    return result;
}

}  // namespace

Command palette_command() {
    return {
        "palette", "show the paints of a palette: what they are, and as drawdown cards", [](Flags& flags) {
            auto a = std::make_shared<PaletteArguments>();
            flags.option("FILE", a->file,
                         "palette file (.json, docs/reference/palette-format.md); the built-in artist "
                         "acrylics without");
            flags.option(
                "--out", a->out,
                "picture to write (.png .tif .jpg .exr): every paint by itself, in two tints with white, and "
                "anisotropic over black and white");
            flags.option("--save", a->save, "palette file to write: K and S of every paint in 12 bands");
            flags.option("--illuminant", a->illuminant, "A, D50, D65, F11 or LED").show_default();
            flags.fields(a->drawdown);
            a->typed = flags.typed();
            return [a] { return run_palette(*a); };
        }};
}

}  // namespace tangi
