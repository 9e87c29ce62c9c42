#include "cli/paint/substrate_arguments.h"

#include <algorithm>

#include "cli/arguments.h"
#include "cli/command.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;

void SubstrateArguments::add_to(Flags& flags) {
    flags.option(
        "--substrate", choice.which,
        "paint on a new canvas, linen, burlap, panel, gesso or paper instead of a painting; on a picture "
        "(.png, .tif, .jpg), a painting's dry layer (.exr), or what --keep-substrate kept; 200 x 150 mm of "
        "0.2 mm a pixel where no size is given, a picture as many pixels as it has");
    flags.option(
        "--height-from", choice.height_from,
        "relief of a picture: luminance (bright is high), none, or another picture, as a height map");
    flags.option("--keep-substrate", choice.keep_as,
                 "keep the substrate under this name, for --substrate NAME");
    flags.fields(choice.piece);
    flags.fields(choice.picture, [](std::string_view field) { return field == "relief_mm"; });
    flags.option("--tint", tint, "R,G,B that the substrate's colour is multiplied by, linear, 0..1");
    flags
        .option("--gloss", choice.finish.specular,
                "mean gloss (rho_s) of the substrate; where not given, its own")
        .check(within(0, 1));
    flags
        .option("--roughness", choice.finish.roughness,
                "mean roughness (alpha) of the substrate; where not given, its own")
        .check(within(0.001, 1));
    typed = flags.typed();
}

void SubstrateArguments::refuse_useless() const {
    const auto& [which, height_from, piece, picture, finish, keep_as] = choice;
    if (given() && !substrate_named(which) && !is_picture(which) && lower_extension(which) != ".exr") try {
            static_cast<void>(kept_substrate_file(which));  // is there
        } catch (const Error& error) {
            throw UsageError(fmt::format("--substrate {}", error.what()));
        }
    const auto refuse = [&](std::initializer_list<std::string_view> names, const std::string& reason) {
        refuse_typed(typed(), names, reason);
    };
    if (!given())
        refuse({"--height-from", "--keep-substrate", "--width-mm", "--height-mm", "--pixel-mm", "--seed",
                "--relief-mm", "--tint", "--gloss", "--roughness"},
               "is of a new substrate, and a painting is given; leave it out, or give --substrate instead of "
               "the painting");
    else if (substrate_named(which))
        refuse({"--height-from", "--relief-mm"},
               fmt::format("is of a picture; {} has a relief of its own", which));
    else if (!is_picture(which))
        refuse({"--height-from", "--width-mm", "--height-mm", "--pixel-mm", "--seed", "--relief-mm"},
               fmt::format("{} is taken as it is; leave it out", which));
    else
        refuse({"--width-mm", "--height-mm", "--seed"},
               fmt::format("{} is taken pixel by pixel; its size is that of its pixels, --pixel-mm", which));
    if (keep_as.empty()) refuse({"--keep-substrate"}, "is the name of a substrate, which is not empty");
    if (height_from == "none") refuse({"--relief-mm"}, "with --height-from none, there is no relief");
}

bool SubstrateArguments::assumes_scale() const {
    return is_picture(choice.which) && !std::ranges::count(typed(), "--pixel-mm");
}

std::vector<std::string> SubstrateArguments::warnings() const {
    if (!assumes_scale()) return {};
    return {fmt::format(
        "--substrate {}: a picture does not say how large it is: {} mm a pixel are assumed, and the scale "
        "counts as unknown; give --pixel-mm",
        choice.which, choice.piece.pixel_mm)};
}

Surface SubstrateArguments::make(const Progress& progress) const {
    SubstrateChoice whole = choice;
    whole.picture.pixel_known = !assumes_scale();
    if (!tint.empty()) {
        const std::vector<double> rgb = numbers_in(tint, "--tint", "R,G,B");
        if (rgb.size() != 3) throw UsageError(fmt::format("--tint {}: give three numbers: R,G,B", tint));
        if (std::ranges::any_of(rgb, [](double part) { return !(part >= 0 && part <= 1); }))
            throw UsageError(fmt::format("--tint {}: each of R,G,B is from 0 to 1", tint));
        whole.finish.tint = Rgb(rgb[0], rgb[1], rgb[2]);
    }
    return make_substrate(whole, progress);
}

std::vector<fs::path> SubstrateArguments::inputs() const {
    const auto& [which, height_from, piece, picture, finish, keep_as] = choice;
    std::vector<fs::path> files;
    if (is_picture(which) || lower_extension(which) == ".exr") files.emplace_back(which);
    if (height_from != "luminance" && height_from != "none") files.emplace_back(height_from);
    return files;
}

}  // namespace tangi
