#include "surface/report/jpeg_bytes.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "surface/base/error.h"
#include "surface/base/memory_error.h"

namespace tangi {

std::string jpeg_bytes(const Samples8& samples, int quality) {
    TP_REQUIRE(samples.channels == 1 || samples.channels == 3, "JPEG pictures have one channel or three");
    const auto output = OIIO::ImageOutput::create("jpeg");
    if (!output) fail("no writer for JPEG pictures: {}", OIIO::geterror());
    OIIO::ImageSpec spec(samples.width, samples.height, samples.channels, OIIO::TypeDesc::UINT8);
    spec.attribute("Compression", fmt::format("jpeg:{}", quality));
    spec.attribute("jpeg:subsampling", "4:4:4");
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    output->set_ioproxy(&memory);
    if (!output->open("picture.jpg", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, samples.values.data()) || !output->close()) {
        const std::string why = output->geterror();
        if (says_no_memory(why)) throw std::bad_alloc();
        fail("a JPEG picture can't be made: {}", why);
    }
    return {bytes.begin(), bytes.end()};
}

Samples8 samples_of_jpeg(std::string_view bytes) {
    OIIO::Filesystem::IOMemReader memory(const_cast<char*>(bytes.data()), bytes.size());
    const auto input = OIIO::ImageInput::create("jpeg");
    OIIO::ImageSpec spec;
    if (!input || !input->set_ioproxy(&memory) || !input->open("picture.jpg", spec))
        fail("a JPEG picture can't be read: {}", input ? input->geterror() : OIIO::geterror());
    Samples8 samples{spec.width, spec.height, spec.nchannels, {}};
    samples.values.resize(static_cast<std::size_t>(spec.image_pixels()) *
                          static_cast<std::size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, samples.values.data()))
        fail("a JPEG picture can't be read: {}", input->geterror());
    return samples;
}

}  // namespace tangi
