// foreign_painting.h: paintings as other programs write them, who may put anything into a map.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <vector>

#include "surface/painting_file/surface_channels.h"
#include "tests/support/test_support.h"

namespace tangi {

// The maps of a surface as part `dry`, without hash and provenance, and whatever they hold.
inline void write_as_another_program(const std::filesystem::path& path, Surface surface) {
    const std::vector<DryChannel> channels = channels_of(surface);
    const std::size_t count = channels.size(), pixels = surface.height_mm.size();
    OIIO::ImageSpec spec(surface.width(), surface.height(), static_cast<int>(count), OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (const DryChannel& channel : channels) spec.channelnames.emplace_back(channel.name);
    spec.alpha_channel = spec.z_channel = -1;
    spec.attribute("oiio:subimagename", "dry");
    spec.attribute("compression", "zip");
    spec.attribute("mm_per_pixel", static_cast<float>(surface.mm_per_pixel));
    spec.attribute("scale_known", surface.scale_known ? 1 : 0);
    std::vector<float> values(pixels * count);
    for (std::size_t c = 0; c < count; ++c)
        for (std::size_t i = 0; i < pixels; ++i)
            values[i * count + c] = channels[c].base[i * channels[c].stride];
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output && output->open(path.string(), spec)) << OIIO::geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
}

}  // namespace tangi
