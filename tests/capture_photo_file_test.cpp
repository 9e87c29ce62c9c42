// capture_photo_file_test.cpp: every format is read to the values that were stored, in bands of any height.
#include "capture/photo_file.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/vec2.hpp>
#include <limits>

#include "capture/photo_metadata.h"
#include "tests/test_support.h"
#include "tests/tiff_writer.h"

namespace tangi {
namespace {

using OIIO::TypeDesc;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

constexpr int kPhotoWidth = 53, kPhotoHeight = 37;  // no multiple of a tile

// Codes of `bits` bits as numbers 0..1, interleaved, so that integers store them without loss.
std::vector<float> random_codes(int channels, int bits) {
    Random random(1);
    const double top = (1 << bits) - 1;
    std::vector<float> values(static_cast<std::size_t>(kPhotoWidth * kPhotoHeight * channels));
    for (float& v : values) v = static_cast<float>(std::round(random.uniform() * top) / top);
    return values;
}

void write(const fs::path& path, OIIO::ImageSpec spec, const std::vector<float>& values) {
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output && output->open(path.string(), spec)) << OIIO::geterror();
    ASSERT_TRUE(output->write_image(TypeDesc::FLOAT, values.data()) && output->close()) << output->geterror();
}

OIIO::ImageSpec spec_of(TypeDesc type, int channels = 3) {
    return {kPhotoWidth, kPhotoHeight, channels, type};
}

OIIO::ImageSpec tiled(OIIO::ImageSpec spec, int tile) {
    spec.tile_width = spec.tile_height = tile;
    spec.tile_depth = 1;
    return spec;
}

std::vector<float> read_in_bands(const fs::path& path, int rows) {
    PhotoFile file(path);
    const auto row = static_cast<std::size_t>(file.header().width * file.header().channels);
    std::vector<float> values(row * static_cast<std::size_t>(file.header().height));
    for (int y = 0; y < file.header().height; y += rows) {
        const int end = std::min(y + rows, file.header().height);
        file.read_rows(y, end, std::span(values).subspan(row * static_cast<std::size_t>(y)));
    }
    return values;
}

void expect_values(const fs::path& path, const std::vector<float>& expected, double tolerance) {
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
    std::size_t pixel = 0;
    for (const float value : wrong) values[4 * pixel + pixel % 3] = value, ++pixel;
    for (const float value : right) values[4 * pixel + 1] = value, ++pixel;
    for (const float alpha : {nan, inf, 0.0f}) values[4 * pixel + 3] = alpha, ++pixel;
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

TEST(PhotoFile, IsToldByItsExtension) {
    for (const char* name : {"a.jpg", "a.JPEG", "b/c.png", "x.Tif", "x.tiff", "x.exr", "x.TGA", "x.bmp"})
        EXPECT_TRUE(is_photo_name(name)) << name;
    for (const char* name : {"a.lp", "a.txt", "jpg", "a.jpg.bak", "", "a.cr2x"})
        EXPECT_FALSE(is_photo_name(name)) << name;
}

TEST(PhotoFile, ThatIsMissingOrAFolderIsAnError) {
    const TestDir dir;
    fs::create_directory(dir / "a.jpg");
    EXPECT_EQ(error_of([] { PhotoFile("/nowhere/a.jpg"); }), "/nowhere/a.jpg: no such photograph");
    EXPECT_EQ(error_of([&] { PhotoFile(dir / "a.jpg"); }),
              (dir / "a.jpg").string() + ": is a folder, not a photograph");
}

TEST(PhotoFile, ThatIsTextIsAnError) {
    const TestDir dir;
    for (const char* name : {"a.jpg", "a.png", "a.tif", "a.exr", "a.tga"})
        for (const std::string text :
             {"", "this is no picture, whatever its name says; it is a text file\n"}) {
            write_bytes(dir / name, text);
            EXPECT_THAT(error_of([&] { PhotoFile(dir / name); }),
                        StartsWith((dir / name).string() + ": is not a picture that can be read: "));
        }
}

TEST(PhotoFile, OfJpegTruncatedIsAnError) {
    const TestDir dir;
    write(dir / "a.jpg", spec_of(TypeDesc::UINT8), random_codes(3, 8));
    const std::string whole = bytes_of(dir / "a.jpg");
    for (const double part : {0.5, 0.7, 0.99}) {
        write_bytes(dir / "cut.jpg",
                    whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
        EXPECT_EQ(error_of([&] { PhotoFile(dir / "cut.jpg"); }),
                  (dir / "cut.jpg").string() +
                      ": the JPEG file is truncated; copy it again from the camera or the archive");
    }
    write_bytes(dir / "padded.jpg", whole + std::string(1000, '\0'));  // as some cameras write them
    EXPECT_NO_THROW(PhotoFile(dir / "padded.jpg"));
    // The film of a motion photograph.
    write_bytes(dir / "film.jpg", whole +
                                      std::string("\0\0\0\x18"
                                                  "ftypmp42",
                                                  12) +
                                      std::string(120000, '\0'));
    EXPECT_EQ(read_in_bands(dir / "film.jpg", 8), read_in_bands(dir / "a.jpg", 8));
}

TEST(PhotoFile, OfJpegTruncatedIsFoundBehindACompleteThumbnail) {
    const TestDir dir;
    write(dir / "a.jpg", spec_of(TypeDesc::UINT8), random_codes(3, 8));
    const std::string whole = bytes_of(dir / "a.jpg");
    const std::string thumbnail = whole;  // a whole JPEG with its own end, in a segment of the file
    std::string segment = "\xFF\xE1";     // APP1
    segment += static_cast<char>((thumbnail.size() + 2) >> 8);
    segment += static_cast<char>((thumbnail.size() + 2) & 255);
    const std::string with_thumbnail = whole.substr(0, 2) + segment + thumbnail + whole.substr(2);
    write_bytes(dir / "b.jpg", with_thumbnail);
    EXPECT_NO_THROW(PhotoFile(dir / "b.jpg"));
    write_bytes(dir / "b.jpg", with_thumbnail.substr(0, with_thumbnail.size() * 7 / 10));
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "b.jpg"); }),
                StartsWith((dir / "b.jpg").string() + ": the JPEG file is truncated"));
}

// At once, not when its last rows are wanted.
TEST(PhotoFile, OfPngTruncatedIsAnError) {
    const TestDir dir;
    write(dir / "a.png", spec_of(TypeDesc::UINT16), random_codes(3, 16));
    const std::string whole = bytes_of(dir / "a.png");
    for (const std::size_t kept : {whole.size() - 1, whole.size() / 2, std::size_t{40}, std::size_t{8}}) {
        write_bytes(dir / "b.png", whole.substr(0, kept));
        EXPECT_EQ(error_of([&] { PhotoFile(dir / "b.png"); }),
                  (dir / "b.png").string() +
                      ": the PNG file is truncated; copy it again from the camera or the archive")
            << kept;
    }
    std::string damaged = whole;
    damaged[33] = '\x60';  // the length of its second chunk: 1.6 GB, which libpng would ask for
    write_bytes(dir / "b.png", damaged);
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "b.png"); }), HasSubstr("the PNG file is truncated"));
    EXPECT_THAT(error_of([&] { read_photo_metadata(dir / "b.png"); }), HasSubstr("cut off, or damaged"));
    write_bytes(dir / "b.png", whole + std::string(1000, '\0'));  // padding does no harm
    EXPECT_EQ(PhotoFile(dir / "b.png").header().width, kPhotoWidth);
}

// OpenImageIO would take what follows for arguments, as in an address of the web.
TEST(PhotoFile, MayHaveAQuestionMarkInItsPath) {
    const TestDir dir;
    const fs::path folder = dir / "which? folder&x=1";
    fs::create_directory(folder);
    for (const char* extension : {".png", ".tif", ".exr", ".TIFF"}) {
        const std::vector<float> values = random_codes(3, 8);
        const fs::path plain = dir / (std::string("plain") + extension);
        write(plain, spec_of(TypeDesc::UINT8), values);
        fs::copy_file(plain, folder / (std::string("img 1?") + extension));
        EXPECT_EQ(read_in_bands(folder / (std::string("img 1?") + extension), 16), read_in_bands(plain, 16))
            << extension;
    }
    write_bytes(folder / "text.png", "this is no picture");
    EXPECT_THAT(error_of([&] { PhotoFile(folder / "text.png"); }),
                StartsWith((folder / "text.png").string() + ": is not a picture that can be read: "));
    EXPECT_THAT(error_of([&] { PhotoFile(folder / "text.png?x"); }), HasSubstr("no such photograph"));
}

TEST(PhotoFile, TruncatedIsAnErrorAtTheLatestWhereItsRowsAreRead) {
    const TestDir dir;
    const struct {
        const char* name;
        OIIO::ImageSpec spec;
    } formats[] = {{"a.png", spec_of(TypeDesc::UINT8)},
                   {"a.exr", spec_of(TypeDesc::HALF)},
                   {"tiled.exr", tiled(spec_of(TypeDesc::HALF), 8)},
                   {"a.tga", spec_of(TypeDesc::UINT8)},
                   {"a.bmp", spec_of(TypeDesc::UINT8)},
                   {"a.tif", spec_of(TypeDesc::UINT8)}};
    for (const auto& [name, spec] : formats) {
        write(dir / name, spec, random_codes(3, 8));
        const std::string whole = bytes_of(dir / name);
        write_bytes(dir / name, whole.substr(0, whole.size() * 6 / 10));
        EXPECT_THAT(error_of([&, &name = name] { read_in_bands(dir / name, 8); }),
                    StartsWith((dir / name).string() + ": "))
            << name;
    }
    write(dir / "a.png", formats[0].spec, random_codes(3, 8));
    std::string damaged = bytes_of(dir / "a.png");
    const std::size_t hole = damaged.size() * 6 / 10;
    std::fill(damaged.begin() + static_cast<std::ptrdiff_t>(hole), damaged.end() - 40, '\0');
    write_bytes(dir / "a.png", damaged);
    EXPECT_THAT(error_of([&] { read_in_bands(dir / "a.png", kPhotoHeight); }),
                StartsWith((dir / "a.png").string() + ": cannot be decoded at rows 0 to 36: "));
    // Its last chunk is there, but the one before does not lead to it.
    write_bytes(dir / "a.png", damaged.substr(0, hole) + std::string("\0\0\0\0IEND\xAE\x42\x60\x82", 12));
    EXPECT_THAT(error_of([&] { PhotoFile(dir / "a.png"); }), HasSubstr("the PNG file is truncated"));
}

TEST(PhotoFile, ReadOutsideItsRowsOrIntoTooLittleBreaksTheContract) {
    const TestDir dir;
    write(dir / "a.png", spec_of(TypeDesc::UINT8), random_codes(3, 8));
    PhotoFile file(dir / "a.png");
    std::vector<float> row(kPhotoWidth * 3);
    EXPECT_THROW(file.read_rows(-1, 0, row), ContractError);
    EXPECT_THROW(file.read_rows(kPhotoHeight, kPhotoHeight + 1, row), ContractError);
    EXPECT_THROW(file.read_rows(3, 3, row), ContractError);
    EXPECT_THROW(file.read_rows(0, 2, row), ContractError);
    EXPECT_NO_THROW(file.read_rows(kPhotoHeight - 1, kPhotoHeight, row));
}

}  // namespace
}  // namespace tangi
