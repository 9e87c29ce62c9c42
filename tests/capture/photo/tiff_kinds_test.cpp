// tiff_kinds_test.cpp: every kind of TIFF is read to the values that are meant, or refused by its
// name.
#include <gmock/gmock.h>

#include <cstring>

#include "surface/image_file/tiff_pages.h"
#include "tests/support/capture/photo_files.h"
#include "tests/support/capture/tiff_writer.h"

namespace tangi {
namespace {

using testing::HasSubstr;

constexpr int kTiffSide = 16;

// A ramp from black to white, and back.
double ramp(int x, int y) { return std::abs(((x + 3 * y) % 32) - 15.5) / 15.5; }

// Codes of `bits` bits, rows packed to whole bytes, little-endian; `of(pixel, sample)` is 0..1.
template <class Of>
std::string packed(int bits, int samples, const Of& of) {
    const double top = std::exp2(bits) - 1;
    std::string bytes;
    for (int y = 0; y < kTiffSide; ++y) {
        unsigned pending = 0;
        int filled = 0;
        for (int x = 0; x < kTiffSide; ++x)
            for (int s = 0; s < samples; ++s) {
                const auto code = static_cast<std::uint64_t>(std::llround(of(x, y, s) * top));
                if (bits >= 8) {
                    for (int byte = 0; byte < bits / 8; ++byte)
                        bytes += static_cast<char>(code >> (8 * byte) & 255);
                    continue;
                }
                pending = pending << bits | static_cast<unsigned>(code);
                filled += bits;
                if (filled == 8) bytes += static_cast<char>(pending), pending = 0, filled = 0;
            }
    }
    return bytes;
}

TiffPicture square(int samples, int bits, int photometric, std::string bytes) {
    return {.width = kTiffSide,
            .height = kTiffSide,
            .samples = samples,
            .bits = bits,
            .photometric = photometric,
            .bytes = std::move(bytes)};
}

// Half a code of so many bits.
void expect_ramp(const fs::path& path, int bits) {
    const PhotoHeader header = PhotoFile(path).header();
    EXPECT_EQ(header.channels, 1) << path;
    EXPECT_FALSE(header.is_float) << path;
    EXPECT_EQ(header.bits, bits <= 8 ? 8 : 16) << path;
    for (const int rows : {1, 5, 100}) {
        const std::vector<float> values = read_in_bands(path, rows);
        for (int y = 0; y < kTiffSide; ++y)
            for (int x = 0; x < kTiffSide; ++x)
                ASSERT_NEAR(values[static_cast<std::size_t>(y * kTiffSide + x)], ramp(x, y),
                            0.51 / (std::exp2(bits) - 1) + 1e-6)
                    << path << ", " << x << ", " << y;
    }
}

TEST(TiffKinds, OfGreyAreReadWhicheverEndIsWhite) {
    const TestDir dir;
    for (const int bits : {1, 2, 4, 8, 16, 32})
        for (const bool zero_is_white : {false, true}) {
            const std::string name = fmt::format("{}_{}.tif", bits, zero_is_white ? "white" : "black");
            const auto value = [&](int x, int y, int) { return zero_is_white ? 1 - ramp(x, y) : ramp(x, y); };
            write_bytes(dir / name,
                        tiff_of({square(1, bits, zero_is_white ? 0 : 1, packed(bits, 1, value))}));
            expect_ramp(dir / name, bits);
        }
}

TEST(TiffKinds, OfGreyWithAlphaAreReadWhicheverEndIsWhite) {
    const TestDir dir;
    for (const int bits : {8, 16})
        for (const bool zero_is_white : {false, true}) {
            TiffPicture picture =
                square(2, bits, zero_is_white ? 0 : 1, packed(bits, 2, [&](int x, int y, int s) {
                           if (s == 1) return x == 3 ? 0.0 : 1.0;
                           return zero_is_white ? 1 - ramp(x, y) : ramp(x, y);
                       }));
            picture.extra_samples = 2;
            write_bytes(dir / "a.tif", tiff_of({picture}));
            PhotoFile file(dir / "a.tif");
            std::vector<float> values(kTiffSide * kTiffSide);
            file.read_rows(0, kTiffSide, values);
            EXPECT_EQ(file.transparent(), kTiffSide);
            for (int x = 0; x < kTiffSide; ++x) {
                const float value = values[static_cast<std::size_t>(5 * kTiffSide + x)];
                if (x == 3)
                    EXPECT_TRUE(std::isnan(value));
                else
                    EXPECT_NEAR(value, ramp(x, 5), 0.51 / (std::exp2(bits) - 1)) << bits << zero_is_white;
            }
        }
}

TEST(TiffKinds, OfPalettesAndYcbcrAreColours) {
    const TestDir dir;
    TiffPicture palette = square(1, 8, 3, packed(8, 1, [](int x, int y, int) { return ramp(x, y); }));
    for (const int share : {4, 2, 1})  // red, green, blue
        for (std::uint32_t i = 0; i < 256; ++i)
            palette.colour_map.push_back(i * 257 / static_cast<std::uint32_t>(share));
    write_bytes(dir / "palette.tif", tiff_of({palette}));
    const TiffPicture ycbcr =
        square(3, 8, 6, packed(8, 3, [](int x, int y, int s) { return s == 0 ? ramp(x, y) : 128 / 255.0; }));
    write_bytes(dir / "ycbcr.tif", tiff_of({ycbcr}));
    for (const char* name : {"palette.tif", "ycbcr.tif"}) {
        const bool is_grey = name[0] == 'y';
        const std::vector<float> values = read_in_bands(dir / name, 5);
        ASSERT_EQ(values.size(), std::size_t{3 * kTiffSide * kTiffSide});
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(values[static_cast<std::size_t>(3 * (4 * kTiffSide + 2) + c)],
                        ramp(2, 4) / (is_grey ? 1 : 4 >> c), 2.0 / 255)
                << name << c;
    }
}

TEST(TiffKinds, OfPlanesAndHalfFloatsAreReadAsTheyAre) {
    const TestDir dir;
    OIIO::ImageSpec planes = spec_of(TypeDesc::UINT16);
    planes.attribute("planarconfig", "separate");
    for (OIIO::ImageSpec spec : {planes, tiled(planes, 16)}) {
        const std::vector<float> values = random_codes(3, 16);
        write(dir / "a.tif", spec, values);
        expect_values(dir / "a.tif", values, 1e-7);
    }
    std::vector<float> halves(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * 3));
    Random random(3);
    for (float& value : halves) value = static_cast<float>(random.below(2048)) / 1024;
    write(dir / "half.tif", spec_of(TypeDesc::HALF), halves);
    EXPECT_TRUE(PhotoFile(dir / "half.tif").header().is_float);
    expect_values(dir / "half.tif", halves, 0);
}

// What is no light, and what the library gets wrong.
TEST(TiffKinds, ThatAreNoPictureAreRefusedByTheirName) {
    const TestDir dir;
    const auto refusal = [&](TiffPicture picture) {
        picture.bytes.resize(
            static_cast<std::size_t>(kTiffSide * kTiffSide * picture.samples * picture.bits / 8), 'a');
        write_bytes(dir / "a.tif", tiff_of({picture}));
        return error_of([&] { PhotoFile(dir / "a.tif"); });
    };
    EXPECT_THAT(refusal(square(4, 8, 5, {})), HasSubstr("printing inks (CMYK)"));
    TiffPicture tiles = square(4, 16, 5, {});
    tiles.tile_width = 16;
    EXPECT_THAT(refusal(tiles), HasSubstr("printing inks (CMYK) in tiles"));
    EXPECT_THAT(refusal(square(3, 16, 6, {})), HasSubstr("YCbCr of more than 8 bits"));
    EXPECT_THAT(refusal(square(3, 16, 32845, {})), HasSubstr("LogLuv"));
    EXPECT_THAT(refusal(square(1, 16, 32844, {})), HasSubstr("LogLuv"));
    EXPECT_THAT(refusal(square(1, 16, 32803, {})), HasSubstr("mosaic of a camera's sensor"));
    EXPECT_THAT(refusal(square(3, 8, 10, {})), HasSubstr("ITU L*a*b*"));
    EXPECT_THAT(refusal(square(3, 16, 999, {})), HasSubstr("PhotometricInterpretation 999"));
    EXPECT_THAT(refusal(square(1, 24, 1, {})), HasSubstr("integers of 24 bits"));
    EXPECT_THAT(refusal(square(1, 64, 1, {})), HasSubstr("integers of 64 bits"));
    TiffPicture floats = square(1, 24, 1, {});
    floats.sample_format = 3;
    EXPECT_THAT(refusal(floats), HasSubstr("floats of 24 bits"));
    floats.bits = 32, floats.photometric = 0;
    EXPECT_THAT(refusal(floats), HasSubstr("floats of which 0 is white"));
    floats.bits = 64, floats.photometric = 1, floats.sample_format = 6;
    EXPECT_THAT(refusal(floats), HasSubstr("complex numbers"));
}

TEST(TiffKinds, OfSignedIntegersAreReadWhereNoneIsNegative) {
    const TestDir dir;
    TiffPicture picture = square(1, 16, 1, packed(16, 1, [](int x, int y, int) { return ramp(x, y) / 2.1; }));
    picture.sample_format = 2;
    write_bytes(dir / "a.tif", tiff_of({picture}));
    EXPECT_NEAR(read_in_bands(dir / "a.tif", 4)[0], ramp(0, 0) * 65535 / 32767 / 2.1, 1e-4);
    picture.bytes[2 * kTiffSide * 9 + 1] = '\x80';
    write_bytes(dir / "a.tif", tiff_of({picture}));
    EXPECT_THAT(error_of([&] { read_in_bands(dir / "a.tif", 4); }),
                HasSubstr("negative integers (SampleFormat 2) at rows 8 to 11"));
}

}  // namespace
}  // namespace tangi
