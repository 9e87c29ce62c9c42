#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "surface/base/error.h"
#include "surface/base/memory_error.h"
#include "surface/file/version.h"
#include "surface/report/png_encode.h"

namespace tangi {

namespace {

std::string png_of(const float* samples, const Region& size, int channels, int bits) {
    TP_REQUIRE(bits == 8 || bits == 16, "PNG pictures have 8 or 16 bits a sample");
    const auto output = OIIO::ImageOutput::create("png");
    if (!output) fail("no writer for PNG pictures: {}", OIIO::geterror());
    OIIO::ImageSpec spec(size.width(), size.height(), channels,
                         bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
    spec.attribute("Software", program_name());
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (channels >= 3) spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("png:compressionLevel", 4);
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    output->set_ioproxy(&memory);
    if (!output->open("picture.png", spec) || !output->write_image(OIIO::TypeDesc::FLOAT, samples) ||
        !output->close()) {
        const std::string why = output->geterror();
        if (says_no_memory(why)) throw std::bad_alloc();
        fail("a PNG picture can't be made: {}", why);
    }
    return {bytes.begin(), bytes.end()};
}

}  // namespace

std::string png_bytes(const Image<Rgb>& encoded, const Image<float>& alpha, int bits) {
    if (alpha.empty()) return png_of(&encoded.data()->r, encoded.region(), 3, bits);
    TP_REQUIRE(alpha.region() == encoded.region(), "colours and alpha have the same size");
    std::vector<float> samples;
    samples.reserve(4 * encoded.size());
    for (std::size_t i = 0; i < encoded.size(); ++i) {
        const Rgb& c = encoded.pixels()[i];
        samples.insert(samples.end(), {c.r, c.g, c.b, alpha.pixels()[i]});
    }
    return png_of(samples.data(), encoded.region(), 4, bits);
}

std::string png_bytes(const Image<float>& values, int bits) {
    return png_of(values.data(), values.region(), 1, bits);
}

}  // namespace tangi
