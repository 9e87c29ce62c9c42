// photo_metadata_file.cpp: EXIF, ICC profiles and chunks of PNG files.
#include <OpenImageIO/imageio.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>

#include "capture/photo/photo_format.h"
#include "capture/photo/photo_metadata.h"
#include "capture/photo/raw_file.h"
#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "surface/image_file/png_check.h"
#include "surface/image_file/safe_picture.h"
#include "surface/image_file/tiff_pages.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::uint32_t big_endian(const unsigned char* bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 |
           bytes[3];
}

// gAMA and sRGB, which OpenImageIO does not tell from its own guess (ISO/IEC 15948, 11.3.3). They precede the
// pixels.
void read_png_chunks(const fs::path& path, PhotoMetadata& metadata) {
    std::ifstream stream(path, std::ios::binary);
    std::array<unsigned char, 8> head{};
    const auto read = [&](std::size_t count) {
        return static_cast<bool>(
            stream.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(count)));
    };
    if (!read(8) || head[0] != 0x89 || head[1] != 'P') return;
    while (read(8)) {
        const std::uint32_t length = big_endian(head.data());
        const std::string type(reinterpret_cast<const char*>(&head[4]), 4);
        if (type == "IDAT" || type == "IEND") return;
        std::streamoff rest = std::streamoff{length} + 4;  // and the checksum
        if (type == "sRGB") metadata.png_srgb = true;
        if (type == "gAMA" && length == 4 && read(4)) {
            rest -= 4;
            if (const std::uint32_t gamma = big_endian(head.data()); gamma > 0)
                metadata.png_gamma = gamma / 1e5;
        }
        stream.seekg(rest, std::ios::cur);
    }
}

// What the picture's page of a TIFF file says, and the first one, which may be a preview, where that says
// nothing.
OIIO::ImageSpec spec_of_picture(const fs::path& path, OIIO::ImageInput& input, const OIIO::ImageSpec& first) {
    const auto pages = tiff_pages(path);
    if (!pages || pages->chosen == 0 || !input.seek_subimage(static_cast<int>(pages->chosen), 0))
        return first;
    OIIO::ImageSpec spec = input.spec();
    for (const OIIO::ParamValue& said : first.extra_attribs)
        if (!spec.find_attribute(said.name())) spec.extra_attribs.push_back(said);
    return spec;
}

std::optional<double> positive_number(const OIIO::ImageSpec& spec, const char* name) {
    const OIIO::ParamValue* value = spec.find_attribute(name);
    if (!value) return std::nullopt;
    const double number = static_cast<double>(value->get_float());
    return std::isfinite(number) && number > 0 ? std::optional(number) : std::nullopt;
}

}  // namespace

PhotoMetadata read_photo_metadata(const fs::path& path) {
    if (!fs::exists(path)) fail("{}: no such photograph", path.string());
    if (!is_whole_png(path))
        fail("{}: is not a picture that can be read: the PNG file is cut off, or damaged; copy it again",
             path.string());
    OIIO::attribute("debug", 0);
    const auto safe = is_raw_name(path) ? std::nullopt : std::optional<SafePicture>(path);
    const auto input = OIIO::ImageInput::create(safe ? safe->reader() : "raw");
    OIIO::ImageSpec spec;
    if (!input || !input->open(safe ? safe->path() : path.string(), spec))
        fail("{}: is not a picture that can be read: {}", path.string(),
             trouble_with_picture(path, input ? input->geterror() : OIIO::geterror()));
    spec = spec_of_picture(path, *input, spec);
    PhotoMetadata metadata;
    metadata.exposure_s = positive_number(spec, "ExposureTime");
    metadata.f_number = positive_number(spec, "FNumber");
    for (const char* name : {"Exif:PhotographicSensitivity", "Exif:ISOSpeedRatings"})
        if (!metadata.iso) metadata.iso = positive_number(spec, name);
    if (const OIIO::ParamValue* icc = spec.find_attribute("ICCProfile"))
        metadata.icc_profile.assign(static_cast<const char*>(icc->data()),
                                    static_cast<std::size_t>(icc->datasize()));
    if (const int colour = spec.get_int_attribute("Exif:ColorSpace", 0)) metadata.exif_colour = colour;
    const PhotoFormat* format = photo_format_named(path);
    if (format && format->has_png_chunks) read_png_chunks(path, metadata);
    return metadata;
}

std::optional<double> exposure_of(const PhotoMetadata& m) {
    if (!m.exposure_s) return std::nullopt;
    const double f = m.f_number.value_or(1);
    return *m.exposure_s * m.iso.value_or(100) / 100 / (f * f);
}

}  // namespace tangi
