#include "cli/substrate_arguments.h"

#include <array>

#include "cli/arguments.h"
#include "cli/command.h"
#include "surface/colour.h"
#include "surface/painting_file.h"
#include "surface/picture_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

bool is_picture(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return std::ranges::any_of(std::array{".png", ".tif", ".tiff", ".jpg", ".jpeg"},
                               [&](const char* known) { return extension == known; });
}

Image<Rgb> linear_picture(const fs::path& path) {
    Image<Rgb> picture = read_picture(path);
    const Transfer srgb{Transfer::Kind::srgb};
    for (Rgb& pixel : picture.pixels())
        pixel = {srgb.decode(pixel.r), srgb.decode(pixel.g), srgb.decode(pixel.b)};
    return picture;
}

Image<float> first_channel(const Image<Rgb>& picture) {
    Image<float> result(picture.width(), picture.height());
    for (std::size_t i = 0; i < result.size(); ++i) result.pixels()[i] = picture.pixels()[i].r;
    return result;
}

// The file of one that was kept under a name; throws UsageError where there is none.
fs::path kept_file(const std::string& which) {
    const fs::path kept =
        which.find('/') == std::string::npos ? kept_substrate(substrate_shelf(), which) : fs::path();
    if (!kept.empty() && fs::exists(kept)) return kept;
    std::vector<std::string> names = substrate_names();
    for (std::string& name : kept_substrates(substrate_shelf())) names.push_back(std::move(name));
    throw UsageError(fmt::format("--substrate {}: is no picture, no painting and not one of {}", which,
                                 fmt::join(names, ", ")));
}

}  // namespace

void SubstrateArguments::add_to(Flags& flags) {
    flags.option(
        "--substrate", which,
        "paint on a new canvas, linen, burlap, panel, gesso or paper instead of a painting; on a picture "
        "(.png, .tif, .jpg), a painting's dry layer (.exr), or what --keep-substrate kept");
    flags.option(
        "--height-from", height_from,
        "relief of a picture: luminance (bright is high), none, or another picture, as a height map");
    flags.option("--keep-substrate", keep_as, "keep the substrate under this name, for --substrate NAME");
    flags.fields(piece);
    flags.fields(picture, [](std::string_view field) { return field == "relief_mm"; });
    typed = flags.typed();
}

void SubstrateArguments::refuse_useless() const {
    if (given() && !substrate_named(which) && !is_picture(which) && lower_extension(which) != ".exr")
        static_cast<void>(kept_file(which));  // is there
    const auto refuse = [&](std::initializer_list<std::string_view> names, const std::string& reason) {
        refuse_typed(typed(), names, reason);
    };
    if (!given())
        refuse({"--height-from", "--keep-substrate", "--width-mm", "--height-mm", "--pixel-mm", "--seed",
                "--relief-mm"},
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

Surface SubstrateArguments::make(const Progress& progress) const {
    const auto made = [&] {
        if (const auto kind = substrate_named(which)) return make_substrate(*kind, piece, progress);
        if (is_picture(which)) {
            const Image<Rgb> colour = linear_picture(which);
            const Image<float> relief = height_from == "luminance" ? lightness_of(colour)
                                        : height_from == "none"    ? Image<float>()
                                                                   : first_channel(read_picture(height_from));
            PictureSubstrateOptions options = picture;
            options.pixel_mm = piece.pixel_mm;
            return substrate_of_picture(colour, relief, options);
        }
        if (lower_extension(which) == ".exr") return read_painting(which, progress);
        return read_painting(kept_file(which), progress);
    };
    Surface surface = made();
    if (!keep_as.empty()) keep_substrate(substrate_shelf(), keep_as, surface);
    return surface;
}

std::vector<fs::path> SubstrateArguments::inputs() const {
    std::vector<fs::path> files;
    if (is_picture(which) || lower_extension(which) == ".exr") files.emplace_back(which);
    if (height_from != "luminance" && height_from != "none") files.emplace_back(height_from);
    return files;
}

}  // namespace tangi
