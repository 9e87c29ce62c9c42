#include "web/engine/ground.h"

#include <array>
#include <cmath>

#include "paint/substrate/picture_substrate.h"
#include "paint/substrate/substrate.h"
#include "paint/substrate/substrate_finish.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/image/colour.h"

namespace tangi {

namespace {

std::array<float, 256> linear_of_codes() {
    std::array<float, 256> linear{};
    const Transfer srgb{Transfer::Kind::srgb};
    for (std::size_t i = 0; i < linear.size(); ++i) linear[i] = srgb.decode(static_cast<float>(i) / 255);
    return linear;
}

void require_whole(const RgbaPicture& picture) {
    const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    if (picture.width < 1 || picture.height < 1 || picture.bytes.size() != 4 * pixels)
        fail("the picture has {} bytes, which are not {} x {} pixels", picture.bytes.size(), picture.width,
             picture.height);
}

Image<Rgb> linear_picture(const RgbaPicture& picture) {
    require_whole(picture);
    const std::array<float, 256> linear = linear_of_codes();
    Image<Rgb> result(picture.width, picture.height);
    for (std::size_t i = 0; i < result.size(); ++i)
        for (int c = 0; c < 3; ++c)
            result.pixels()[i][c] = linear[picture.bytes[4 * i + static_cast<std::size_t>(c)]];
    return result;
}

Image<float> red_channel(const RgbaPicture& picture) {
    require_whole(picture);
    Image<float> result(picture.width, picture.height);
    for (std::size_t i = 0; i < result.size(); ++i)
        result.pixels()[i] = static_cast<float>(picture.bytes[4 * i]) / 255;
    return result;
}

Surface of_picture(const nlohmann::json& choice, const RgbaPicture& picture, const RgbaPicture& relief) {
    PictureSubstrateOptions options;
    options.pixel_mm = choice.value("pixel_mm", options.pixel_mm);
    options.relief_mm = choice.value("relief_mm", options.relief_mm);
    options.specular = choice.value("specular", options.specular);
    options.roughness = choice.value("roughness", options.roughness);
    validate(options);
    const Image<Rgb> colour = linear_picture(picture);
    const std::string from = choice.value("height_from", "luminance");
    const Image<float> heights = from == "luminance" ? lightness_of(colour)
                                 : from == "picture" ? red_channel(relief)
                                                     : Image<float>();
    Surface surface = substrate_of_picture(colour, heights, options);
    surface.provenance = json_line(nlohmann::json{{"substrate", choice.value("name", "picture")},
                                                  {"height_from", from},
                                                  {"pixel_mm", options.pixel_mm}});
    return surface;
}

Surface of_procedure(const nlohmann::json& choice) {
    const std::string name = choice.value("substrate", "canvas");
    const auto kind = substrate_named(name);
    if (!kind) fail("there is no support called '{}'", name);
    SubstrateOptions options;
    options.width_mm = choice.value("width_mm", options.width_mm);
    options.height_mm = choice.value("height_mm", options.height_mm);
    options.pixel_mm = choice.value("pixel_mm", options.pixel_mm);
    options.seed = choice.value("seed", options.seed);
    validate(options);
    return make_substrate(*kind, options);
}

}  // namespace

void require_memory_for(double width, double height, double memory_bytes) {
    if (!(memory_bytes > 0) || !(width * height * kBytesOfPixel > memory_bytes)) return;
    fail(
        "it has {:.1f} megapixels, and this device has memory to paint on {:.0f} at most; take less detail, "
        "or a computer",
        width * height / 1e6, std::floor(memory_bytes / kBytesOfPixel / 1e6));
}

Surface make_ground(const nlohmann::json& choice, const RgbaPicture& picture, const RgbaPicture& relief) {
    const bool is_picture = choice.value("picture", false);
    const SubstrateOptions usual;
    const double pixel_mm = choice.value("pixel_mm", usual.pixel_mm);
    require_memory_for(is_picture ? picture.width : choice.value("width_mm", usual.width_mm) / pixel_mm,
                       is_picture ? picture.height : choice.value("height_mm", usual.height_mm) / pixel_mm,
                       choice.value("memory_bytes", 0.0));
    Surface surface = is_picture ? of_picture(choice, picture, relief) : of_procedure(choice);
    SubstrateFinish finish;
    if (choice.contains("tint"))
        for (int c = 0; c < 3; ++c)
            finish.tint[c] = choice["tint"].at(static_cast<std::size_t>(c)).get<float>();
    if (!is_picture && choice.contains("specular")) finish.specular = choice["specular"].get<double>();
    if (!is_picture && choice.contains("roughness")) finish.roughness = choice["roughness"].get<double>();
    apply(finish, surface);
    return surface;
}

}  // namespace tangi
