#include "paint/substrate/substrate_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/image/colour.h"
#include "surface/image/memory_budget.h"
#include "surface/image_file/image_io.h"
#include "surface/image_file/picture_rows.h"
#include "surface/painting_file/painting_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

Image<Rgb> linear_picture(const fs::path& path) {
    Image<Rgb> picture = read_picture(path);
    const Transfer srgb{Transfer::Kind::srgb};
    for (Rgb& pixel : picture.pixels()) pixel = srgb.decode(pixel);
    return picture;
}

Image<float> first_channel(const Image<Rgb>& picture) {
    Image<float> result(picture.width(), picture.height());
    for (std::size_t i = 0; i < result.size(); ++i) result.pixels()[i] = picture.pixels()[i].r;
    return result;
}

// The names of files, not where they lay.
std::string provenance_of_picture(const SubstrateChoice& choice, const PictureSubstrateOptions& options) {
    const bool is_file = choice.height_from != "luminance" && choice.height_from != "none";
    nlohmann::json all = {
        {"substrate", fs::path(choice.which).filename().string()},
        {"height_from", is_file ? fs::path(choice.height_from).filename().string() : choice.height_from},
        {"pixel_mm", options.pixel_mm},
        {"pixel_known", options.pixel_known}};
    if (choice.height_from != "none") all["relief_mm"] = options.relief_mm;
    return json_line(all);
}

Surface made(const SubstrateChoice& choice, const Progress& progress) {
    if (const auto kind = substrate_named(choice.which)) return make_substrate(*kind, choice.piece, progress);
    if (is_picture(choice.which)) {
        const PictureContent size = PictureRows(choice.which).content();
        require_memory_of_surface(choice.which, size.width, size.height, sizeof(Rgb) + sizeof(float),
                                  "making a ground");
        const Image<Rgb> colour = linear_picture(choice.which);
        const Image<float> relief = choice.height_from == "luminance" ? lightness_of(colour)
                                    : choice.height_from == "none"
                                        ? Image<float>()
                                        : first_channel(read_picture(choice.height_from));
        PictureSubstrateOptions options = choice.picture;
        options.pixel_mm = choice.piece.pixel_mm;
        try {
            Surface surface = substrate_of_picture(colour, relief, options);
            surface.provenance = provenance_of_picture(choice, options);
            return surface;
        } catch (const Error& error) {
            const bool is_file = choice.height_from != "luminance" && choice.height_from != "none";
            fail("{}{}: {}", choice.which, is_file ? " with the relief of " + choice.height_from : "",
                 error.what());
        }
    }
    if (lower_extension(choice.which) == ".exr") return read_painting(choice.which, progress);
    return read_painting(kept_substrate_file(choice.which), progress);
}

// What was made otherwise than `before` says.
std::string provenance_of(const SubstrateChoice& choice, const std::string& before) {
    const SubstrateFinish& f = choice.finish;
    nlohmann::json finish = {{"tint", {f.tint.r, f.tint.g, f.tint.b}}};
    if (f.specular) finish["specular"] = *f.specular;
    if (f.roughness) finish["roughness"] = *f.roughness;
    nlohmann::json all = {{"substrate", choice.which}, {"finish", finish}};
    if (!before.empty()) {
        const nlohmann::json made = json_or_discarded(before);
        all["made_of"] = made.is_discarded() ? nlohmann::json(before) : made;
    }
    return json_line(all);
}

}  // namespace

bool is_picture(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return std::ranges::any_of(std::array{".png", ".tif", ".tiff", ".jpg", ".jpeg"},
                               [&](const char* known) { return extension == known; });
}

fs::path kept_substrate_file(const std::string& name) {
    fs::path kept =
        name.find('/') == std::string::npos ? kept_substrate(substrate_shelf(), name) : fs::path();
    if (!kept.empty() && fs::exists(kept)) return kept;
    std::vector<std::string> names = substrate_names();
    for (std::string& other : kept_substrates(substrate_shelf())) names.push_back(std::move(other));
    fail("{}: is no picture, no painting and not one of {}", name, fmt::join(names, ", "));
}

Surface make_substrate(const SubstrateChoice& choice, const Progress& progress) {
    if (is_picture(choice.keep_as) || lower_extension(choice.keep_as) == ".exr")
        fail(
            "'{}' can't be the name of a substrate: --substrate would take it for a file; leave its ending "
            "out",
            choice.keep_as);
    Surface surface = made(choice, progress);
    apply(choice.finish, surface);
    if (choice.finish != SubstrateFinish()) {
        // It is not what was photographed any more.
        surface.photography = {};
        surface.provenance = provenance_of(choice, surface.provenance);
    }
    if (!choice.keep_as.empty()) keep_substrate(substrate_shelf(), choice.keep_as, surface);
    return surface;
}

}  // namespace tangi
