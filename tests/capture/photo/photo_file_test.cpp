// photo_file_test.cpp: every format is read to the values that were stored, in bands of any height.
#include "capture/photo/photo_file.h"

#include <gmock/gmock.h>

#include <glm/vec2.hpp>
#include <limits>

#include "tests/support/capture/photo_files.h"
#include "tests/support/capture/tiff_writer.h"

namespace tangi {
namespace {

using testing::HasSubstr;

// An uncompressed 24-bit TGA file; rows as in the file, from the bottom up where `bottom_left`.
void write_tga(const fs::path& path, const std::vector<float>& values, bool bottom_left) {
    std::string bytes(18, '\0');
    bytes[2] = 2;  // true colour
    bytes[12] = kPhotoWidth;
    bytes[14] = kPhotoHeight;
    bytes[16] = 24;
    bytes[17] = bottom_left ? 0 : 0x20;
    for (int i = 0; i < kPhotoHeight; ++i) {
        const int y = bottom_left ? kPhotoHeight - 1 - i : i;
        for (int x = 0; x < kPhotoWidth; ++x)
            for (int c = 2; c >= 0; --c)  // blue first
                bytes += static_cast<char>(
                    std::lround(values[static_cast<std::size_t>((y * kPhotoWidth + x) * 3 + c)] * 255));
    }
    write_bytes(path, bytes);
}

TEST(PhotoFile, ReadsIntegerFormatsWithoutLoss) {
    const TestDir dir;
    const struct {
        const char* name;
        OIIO::ImageSpec spec;
        int bits;
    } formats[] = {{"8.png", spec_of(TypeDesc::UINT8), 8},
                   {"16.png", spec_of(TypeDesc::UINT16), 16},
                   {"8.tif", spec_of(TypeDesc::UINT8), 8},
                   {"16.tif", spec_of(TypeDesc::UINT16), 16},
                   {"tiled.tif", tiled(spec_of(TypeDesc::UINT16), 16), 16},
                   {"grey.png", spec_of(TypeDesc::UINT16, 1), 16},
                   {"grey.tif", spec_of(TypeDesc::UINT8, 1), 8},
                   {"8.bmp", spec_of(TypeDesc::UINT8), 8}};
    for (const auto& [name, spec, bits] : formats) {
        const std::vector<float> values = random_codes(spec.nchannels, bits);
        write(dir / name, spec, values);
        const PhotoHeader header = PhotoFile(dir / name).header();
        EXPECT_EQ(header.width, kPhotoWidth) << name;
        EXPECT_EQ(header.height, kPhotoHeight) << name;
        EXPECT_EQ(header.channels, spec.nchannels) << name;
        EXPECT_EQ(header.bits, bits) << name;
        EXPECT_FALSE(header.is_float) << name;
        expect_values(dir / name, values, 1e-7);  // one rounding of a float up to 1
    }
}

TEST(PhotoFile, ReadsFloatFormatsWithoutLoss) {
    const TestDir dir;
    Random random(2);
    std::vector<float> values(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * 3));
    for (float& v : values) v = static_cast<float>(random.below(2048)) / 128 - 1;  // -1..15, exact in a half
    OIIO::ImageSpec moved = spec_of(TypeDesc::FLOAT);
    moved.x = moved.full_x = 5;
    moved.y = moved.full_y = -7;
    const struct {
        const char* name;
        OIIO::ImageSpec spec;
    } formats[] = {{"float.tif", spec_of(TypeDesc::FLOAT)},
                   {"tiled.tif", tiled(spec_of(TypeDesc::FLOAT), 32)},
                   {"half.exr", spec_of(TypeDesc::HALF)},
                   {"float.exr", spec_of(TypeDesc::FLOAT)},
                   {"tiled.exr", tiled(spec_of(TypeDesc::HALF), 8)},
                   {"moved.exr", moved}};
    for (const auto& [name, spec] : formats) {
        write(dir / name, spec, values);
        EXPECT_TRUE(PhotoFile(dir / name).header().is_float) << name;
        EXPECT_EQ(PhotoFile(dir / name).header().bits, 32) << name;
        expect_values(dir / name, values, 0);
    }
}

// A picture whose file has a part of it: rows and columns that are missing are no samples.
TEST(PhotoFile, OfExrIsPlacedInItsDisplayWindow) {
    const TestDir dir;
    Random random(5);
    const int width = kPhotoWidth + 9, height = kPhotoHeight + 5;
    for (const bool in_tiles : {false, true})
        for (const glm::ivec2 corner : {glm::ivec2(6, 4), {0, 0}, {-7, -3}, {-30, 20}}) {
            OIIO::ImageSpec spec = spec_of(TypeDesc::FLOAT);
            if (in_tiles) spec = tiled(spec, 16);
            spec.full_x = 100, spec.full_y = -50;  // wherever that is
            spec.full_width = width, spec.full_height = height;
            spec.x = 100 + corner.x, spec.y = -50 + corner.y;
            std::vector<float> stored(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * 3));
            for (float& v : stored) v = random.real();
            write(dir / "a.exr", spec, stored);
            const PhotoHeader header = PhotoFile(dir / "a.exr").header();
            EXPECT_EQ(header.width, width);
            EXPECT_EQ(header.height, height);
            EXPECT_THAT(header.doubts, testing::ElementsAre(HasSubstr("all pixels of its display window")));
            for (const int rows : {1, 7, 100}) {
                const std::vector<float> values = read_in_bands(dir / "a.exr", rows);
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        const int from_x = x - corner.x, from_y = y - corner.y;
                        const bool there =
                            from_x >= 0 && from_y >= 0 && from_x < kPhotoWidth && from_y < kPhotoHeight;
                        const float value = values[static_cast<std::size_t>((y * width + x) * 3 + 1)];
                        if (there) {
                            ASSERT_EQ(
                                value,
                                stored[static_cast<std::size_t>((from_y * kPhotoWidth + from_x) * 3 + 1)]);
                        } else {
                            ASSERT_TRUE(std::isnan(value)) << x << ", " << y;
                        }
                    }
            }
            PhotoFile file(dir / "a.exr");
            std::vector<float> row(static_cast<std::size_t>(width * 3));
            file.read_rows(0, 1, row);
            EXPECT_EQ(file.without_number(), 0);  // what is not there is no number that is wrong
        }
    OIIO::ImageSpec nowhere = spec_of(TypeDesc::HALF);
    nowhere.full_width = nowhere.full_height = 1 << 20;
    write(dir / "b.exr", nowhere, random_codes(3, 8));
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "b.exr"); }),
                HasSubstr("next to nothing of its display window"));
}

// A pixel that holds what light cannot be is no sample, in none of its channels.
TEST(PhotoFile, HasNoSamplesWhereFloatsAreNoNumbers) {
    constexpr float inf = std::numeric_limits<float>::infinity(),
                    nan = std::numeric_limits<float>::quiet_NaN();
    const TestDir dir;
    const float wrong[] = {nan, inf, -inf, 65504, 3.4e38f, -3.4e38f, 1e30f, -9999};
    const float right[] = {0, -0.01f, -1, 70000, 1e-4f, 65503};
    std::vector<float> values(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * 4), 0.5f);
    for (std::size_t i = 3; i < values.size(); i += 4) values[i] = 1;
    std::size_t pixel = 0;
    for (const float value : wrong) values[4 * pixel + pixel % 3] = value, ++pixel;
    for (const float value : right) values[4 * pixel + 1] = value, ++pixel;
    for (const float alpha : {nan, inf}) values[4 * pixel + 3] = alpha, ++pixel;
    OIIO::ImageSpec spec = spec_of(TypeDesc::FLOAT, 4);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    for (const char* name : {"a.exr", "a.tif"}) {
        write(dir / name, spec, values);
        PhotoFile file(dir / name);
        std::vector<float> read(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * 3));
        file.read_rows(0, kPhotoHeight, read);
        EXPECT_EQ(file.without_number(), static_cast<long>(std::size(wrong))) << name;
        for (std::size_t i = 0; i < static_cast<std::size_t>(kPhotoWidth * kPhotoHeight); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                if (i < std::size(wrong))
                    ASSERT_TRUE(std::isnan(read[3 * i + c])) << name << ", " << wrong[i];
                else
                    ASSERT_EQ(read[3 * i + c], values[4 * i + c]) << name << ", pixel " << i;
    }
}

TEST(PhotoFile, ReadsTheChannelsThatAreNamed) {
    const TestDir dir;
    std::vector<float> values;
    for (int i = 0; i < kPhotoWidth * kPhotoHeight; ++i)
        values.insert(values.end(), {0.1f, 0.2f, 0.3f, 0.4f, 0.5f});
    OIIO::ImageSpec layers = spec_of(TypeDesc::FLOAT, 5);
    layers.channelnames = {"a.Z", "photo.R", "photo.G", "photo.B", "z.Z"};
    for (const bool in_tiles : {false, true}) {
        write(dir / "a.exr", in_tiles ? tiled(layers, 16) : layers, values);
        const std::vector<float> read = read_in_bands(dir / "a.exr", 7);
        EXPECT_THAT(std::vector(read.begin(), read.begin() + 3), testing::ElementsAre(0.2f, 0.3f, 0.4f));
    }
    OIIO::ImageSpec bands = spec_of(TypeDesc::FLOAT, 5);
    bands.channelnames = {"450nm", "550nm", "650nm", "750nm", "850nm"};
    write(dir / "b.exr", bands, values);
    EXPECT_THAT(
        error_of([&] { PhotoFile(dir / "b.exr"); }),
        testing::AllOf(HasSubstr("b.exr: its channels (450nm, 550nm, 650nm, 750nm, 850nm) do not say"),
                       HasSubstr("store red, green and blue")));
    OIIO::ImageSpec tiff = spec_of(TypeDesc::UINT16, 6);
    values.resize(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * 6), 0.5f);
    write(dir / "b.tif", tiff, values);
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "b.tif"); }), HasSubstr("b.tif: has 6 channels"));
}

TEST(PhotoFile, OfTiffIsItsLargestPicture) {
    const TestDir dir;
    const std::string red("\xFF\x00\x00", 3), green("\x00\xFF\x00", 3);
    write_bytes(dir / "a.tif", tiff_of({even_tiff(4, 3, red, 1), even_tiff(16, 12, green)}));
    EXPECT_EQ(PhotoFile(dir / "a.tif").header().width, 16);
    EXPECT_THAT(PhotoFile(dir / "a.tif").header().doubts, testing::IsEmpty());
    std::vector<float> expected;
    for (int i = 0; i < 16 * 12; ++i) expected.insert(expected.end(), {0, 1, 0});
    EXPECT_EQ(read_in_bands(dir / "a.tif", 5), expected);
    write_bytes(dir / "b.tif", tiff_of({even_tiff(8, 8, red), even_tiff(8, 8, green)}));
    EXPECT_THAT(
        PhotoFile(dir / "b.tif").header().doubts,
        testing::ElementsAre(HasSubstr("holds 2 pictures of the same size, of which the first (page 1)")));
    TiffPicture preview = even_tiff(4, 3, red);
    preview.below = {even_tiff(16, 12, green)};
    write_bytes(dir / "c.tif", tiff_of({preview}));
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "c.tif"); }),
                testing::AllOf(HasSubstr("its picture of 16 x 12 lies below a smaller one (4 x 3)"),
                               HasSubstr("plain TIFF")));
}

TEST(PhotoFile, TellsOfPixelsThatAreNotSquare) {
    const TestDir dir;
    for (const char* name : {"a.exr", "a.tif", "a.png"}) {
        OIIO::ImageSpec spec = spec_of(name == std::string("a.exr") ? TypeDesc::HALF : TypeDesc::UINT8);
        write(dir / name, spec, random_codes(3, 8));
        EXPECT_THAT(PhotoFile(dir / name).header().doubts, testing::IsEmpty()) << name;
        spec.attribute("PixelAspectRatio", 2.0f);
        spec.attribute("XResolution", 100.0f);
        spec.attribute("YResolution", 200.0f);
        spec.attribute("ResolutionUnit", "in");
        write(dir / name, spec, random_codes(3, 8));
        EXPECT_THAT(PhotoFile(dir / name).header().doubts, testing::ElementsAre(HasSubstr("2 times as wide")))
            << name;
    }
}

TEST(PhotoFile, ReadsTgaFromBothOrigins) {
    const TestDir dir;
    const std::vector<float> values = random_codes(3, 8);
    write_tga(dir / "bottom.tga", values, true);
    write_tga(dir / "top.tga", values, false);
    for (const char* name : {"bottom.tga", "top.tga"}) {
        expect_values(dir / name, values, 1e-7);
        EXPECT_EQ(PhotoFile(dir / name).header().orientation, 1) << name;  // it is turned already
    }
}

TEST(PhotoFile, ReadsJpegWithinItsLoss) {
    const TestDir dir;
    std::vector<float> values;  // a gentle ramp: quality 95 leaves two or three codes
    for (int y = 0; y < kPhotoHeight; ++y)
        for (int x = 0; x < kPhotoWidth; ++x)
            values.insert(values.end(), 3, static_cast<float>(0.2 + 0.01 * x + 0.005 * y));
    OIIO::ImageSpec spec = spec_of(TypeDesc::UINT8);
    spec.attribute("Compression", "jpeg:95");
    write(dir / "a.JPG", spec, values);
    expect_values(dir / "a.JPG", values, 3.0 / 255);
    EXPECT_EQ(PhotoFile(dir / "a.JPG").header().bits, 8);
    OIIO::ImageSpec grey = spec_of(TypeDesc::UINT8, 1);
    write(dir / "grey.jpeg", grey,
          std::vector<float>(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight), 0.5f));
    EXPECT_EQ(PhotoFile(dir / "grey.jpeg").header().channels, 1);
}

TEST(PhotoFile, DropsAlphaWithoutMultiplyingByIt) {
    const TestDir dir;
    std::vector<float> rgba, rgb;
    for (int i = 0; i < kPhotoWidth * kPhotoHeight; ++i) {
        rgba.insert(rgba.end(), {0.2f, 0.4f, 0.8f, 0.5f});  // codes 51, 102, 204
        rgb.insert(rgb.end(), {0.2f, 0.4f, 0.8f});
    }
    OIIO::ImageSpec spec = spec_of(TypeDesc::UINT8, 4);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    for (const char* name : {"a.png", "a.tif"}) {
        write(dir / name, spec, rgba);
        EXPECT_EQ(PhotoFile(dir / name).header().channels, 3);
        expect_values(dir / name, rgb, 1e-7);
    }
}

TEST(PhotoFile, TellsTheExifOrientation) {
    const TestDir dir;
    OIIO::ImageSpec spec = spec_of(TypeDesc::UINT8);
    spec.attribute("Orientation", 6);
    write(dir / "a.jpg", spec, random_codes(3, 8));
    EXPECT_EQ(PhotoFile(dir / "a.jpg").header().orientation, 6);
    write(dir / "b.jpg", spec_of(TypeDesc::UINT8), random_codes(3, 8));
    EXPECT_EQ(PhotoFile(dir / "b.jpg").header().orientation, 1);
}

}  // namespace
}  // namespace tangi
