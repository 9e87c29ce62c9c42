// photo_files.h: small photographs in any format, written through OpenImageIO, and read back in bands.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>

#include "capture/photo/photo_file.h"
#include "tests/support/test_support.h"

namespace tangi {

using OIIO::TypeDesc;
namespace fs = std::filesystem;

constexpr int kPhotoWidth = 53, kPhotoHeight = 37;  // no multiple of a tile

// Codes of `bits` bits as numbers 0..1, interleaved, so that integers store them without loss.
inline std::vector<float> random_codes(int channels, int bits) {
    Random random(1);
    const double top = (1 << bits) - 1;
    std::vector<float> values(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * channels));
    for (float& v : values) v = static_cast<float>(std::round(random.uniform() * top) / top);
    return values;
}

inline void write(const fs::path& path, const OIIO::ImageSpec& spec, const std::vector<float>& values) {
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output && output->open(path.string(), spec)) << OIIO::geterror();
    ASSERT_TRUE(output->write_image(TypeDesc::FLOAT, values.data()) && output->close()) << output->geterror();
}

inline OIIO::ImageSpec spec_of(const TypeDesc& type, int channels = 3) {
    return {kPhotoWidth, kPhotoHeight, channels, type};
}

inline OIIO::ImageSpec tiled(OIIO::ImageSpec spec, int tile) {
    spec.tile_width = spec.tile_height = tile;
    spec.tile_depth = 1;
    return spec;
}

inline std::vector<float> read_in_bands(const fs::path& path, int rows) {
    PhotoFile file(path);
    const auto row = static_cast<std::size_t>(file.header().width * file.header().channels);
    std::vector<float> values(row * static_cast<std::size_t>(file.header().height));
    for (int y = 0; y < file.header().height; y += rows) {
        const int end = std::min(y + rows, file.header().height);
        file.read_rows(y, end, std::span(values).subspan(row * static_cast<std::size_t>(y)));
    }
    return values;
}

inline void expect_values(const fs::path& path, const std::vector<float>& expected, double tolerance) {
    const std::vector<float> whole = read_in_bands(path, 1 << 20);
    ASSERT_EQ(whole.size(), expected.size()) << path;
    double worst = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const double error = std::abs(double(whole[i]) - double(expected[i]));
        worst = error <= worst ? worst : error;  // NaN stays
    }
    EXPECT_TRUE(worst <= tolerance) << path << ": " << worst;
    for (const int rows : {1, 2, 7, 16, 36})
        EXPECT_EQ(read_in_bands(path, rows), whole) << path << ", " << rows;

    // Going back starts over.
    PhotoFile file(path);
    const auto row = static_cast<std::size_t>(file.header().width * file.header().channels);
    std::vector<float> values(row * 3);
    for (const int y : {20, 3, 34, 0}) {
        file.read_rows(y, y + 3, values);
        EXPECT_TRUE(
            std::equal(values.begin(), values.end(), whole.begin() + static_cast<std::ptrdiff_t>(row) * y))
            << path << ", row " << y;
    }
}

}  // namespace tangi
