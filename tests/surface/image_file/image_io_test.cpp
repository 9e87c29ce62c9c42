// image_io_test.cpp: pictures to files and back, within what their format can hold.
#include "surface/image_file/image_io.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "surface/image_file/image_alpha.h"
#include "surface/image_file/picture_rows.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Image<Rgb> random_picture(int width, int height, double low = 0, double high = 1) {
    Random random(1);
    Image<Rgb> picture(width, height);
    for (Rgb& c : picture.pixels())
        c = {random.real(low, high), random.real(low, high), random.real(low, high)};
    return picture;
}

Image<Rgb> encoded(const Image<Rgb>& linear, const Transfer& transfer) {
    Image<Rgb> result = linear;
    for (Rgb& c : result.pixels()) c = transfer.encode(c);
    return result;
}

// Writes a file of `channels` channels with the given values (0..1) in every pixel.
void write_constant(const std::filesystem::path& path, const std::vector<float>& values,
                    bool unassociated = false) {
    OIIO::ImageSpec spec(3, 2, static_cast<int>(values.size()), OIIO::TypeDesc::UINT16);
    if (unassociated) spec.attribute("oiio:UnassociatedAlpha", 1);
    std::vector<float> pixels;
    for (int i = 0; i < 6; ++i) pixels.insert(pixels.end(), values.begin(), values.end());
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output->open(path.string(), spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close());
}

TEST(PictureFile, Of16BitsComesBackWithinHalfACode) {
    const TestDir dir;
    const Image<Rgb> picture = random_picture(17, 9);
    for (const Transfer& transfer : {kLinear, kSrgb, Transfer{Transfer::Kind::gamma, 1.8}})
        for (const char* name : {"a.png", "a.tif", "A.TIFF"}) {
            write_picture(dir / name, picture, transfer);
            EXPECT_TRUE(images_near(read_picture(dir / name), encoded(picture, transfer), 0.501 / 65535))
                << name << ", " << transfer.name();
        }
}

TEST(PictureFile, Of8BitsComesBackWithinHalfACode) {
    const TestDir dir;
    const Image<Rgb> picture = random_picture(17, 9);
    write_picture_8bit(dir / "a.png", picture);
    EXPECT_TRUE(images_near(read_picture(dir / "a.png"), picture, 0.501 / 255));
    write_picture(dir / "b.png", picture, kSrgb, {.bits = 8});
    EXPECT_TRUE(images_near(read_picture(dir / "b.png"), encoded(picture, kSrgb), 0.501 / 255));
    EXPECT_FALSE(images_near(read_picture(dir / "b.png"), encoded(picture, kSrgb), 0.4 / 255));
}

TEST(PictureFile, OfExrIsExactAlsoBelowZeroAndAboveOne) {
    const TestDir dir;
    const Image<Rgb> picture = random_picture(17, 9, -1, 20);
    write_picture(dir / "a.exr", picture, kLinear);
    EXPECT_TRUE(images_identical(read_picture(dir / "a.exr"), picture));
}

TEST(PictureFile, OfJpegComesBackWithinAFewCodes) {
    const TestDir dir;
    Image<Rgb> picture(32, 32);  // smooth, so that quality 95 leaves little to see
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) picture(x, y) = {0.2f + x / 64.0f, 0.5f, 0.9f - y / 64.0f};
    write_picture(dir / "a.jpg", picture, kLinear);
    // Colour is halved in resolution: a code of slope (4) and the quantiser's 2 to 3.
    EXPECT_TRUE(images_near(read_picture(dir / "a.jpg"), picture, 7.0 / 255));
}

TEST(PictureFile, ClipsWhatItsFormatCannotHold) {
    const TestDir dir;
    Image<Rgb> picture(2, 1);
    picture(0, 0) = {-1, 2, 0.5f};
    write_picture(dir / "a.png", picture, kLinear);
    const Rgb back = read_picture(dir / "a.png")(0, 0);
    EXPECT_EQ(back.r, 0);
    EXPECT_EQ(back.g, 1);
    EXPECT_NEAR(back.b, 0.5, 1e-5);
}

TEST(PictureFile, OfOneChannelIsReadAsGrey) {
    const TestDir dir;
    Image<float> map(5, 4);
    for (std::size_t i = 0; i < map.size(); ++i) map.pixels()[i] = static_cast<float>(i) / 20;
    Image<Rgb> grey(5, 4);
    for (std::size_t i = 0; i < map.size(); ++i) grey.pixels()[i] = Rgb(map.pixels()[i]);
    write_map(dir / "a.png", map);
    EXPECT_TRUE(images_near(read_picture(dir / "a.png"), grey, 0.501 / 65535));
    write_map(dir / "a.exr", map);
    EXPECT_TRUE(images_identical(read_picture(dir / "a.exr"), grey));
}

TEST(PictureFile, DropsAlphaWithoutMultiplyingByIt) {
    const TestDir dir;
    write_constant(dir / "rgba.png", {0.2f, 0.4f, 0.8f, 0.5f}, true);
    EXPECT_TRUE(images_near(read_picture(dir / "rgba.png"), Image<Rgb>(3, 2, Rgb(0.2f, 0.4f, 0.8f)), 1e-4));
    write_constant(dir / "ya.png", {0.6f, 0.5f}, true);
    EXPECT_TRUE(images_near(read_picture(dir / "ya.png"), Image<Rgb>(3, 2, Rgb(0.6f)), 1e-4));
}

// OpenImageIO would take what follows for arguments, as in an address of the web.
TEST(PictureFile, OfManyBandsIsNotTakenForColours) {
    const TestDir dir;
    write_constant(dir / "a.tif", {0.1f, 0.2f, 0.3f, 0.4f});
    EXPECT_NEAR(read_picture(dir / "a.tif")(0, 0).b, 0.3, 1e-4);
    write_constant(dir / "a.tif", {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f});
    for (const auto& read : {std::function<void()>([&] { read_picture(dir / "a.tif"); }),
                             std::function<void()>([&] { read_picture_with_alpha(dir / "a.tif"); })})
        EXPECT_THAT(error_of(read),
                    HasSubstr("a.tif: has 6 channels, and nothing says which are red, green and blue"));
}

TEST(PictureFile, MayHaveAQuestionMarkInItsPath) {
    const TestDir dir;
    const std::filesystem::path folder = dir / "which? folder&x=1";
    std::filesystem::create_directory(folder);
    const Image<Rgb> picture = random_picture(17, 9);
    for (const char* name : {"img 1?.png", "img 1?.tif", "img 1?.EXR"}) {
        write_picture(folder / name, picture, kLinear);
        EXPECT_TRUE(images_near(read_picture(folder / name), picture, 0.501 / 65535)) << name;
    }
    write_picture(folder / "a.jpg", picture, kLinear);
    EXPECT_EQ(read_picture(folder / "a.jpg").width(), 17);
    EXPECT_THAT(error_of([&] { read_picture(folder / "no.png"); }),
                StartsWith((folder / "no.png").string() + ": cannot be read: "));
    EXPECT_EQ(names_in(folder).size(), 4u);
}

// libpng would ask for memory by a damaged length.
TEST(PictureFile, OfPngCutOffOrWithADamagedLengthIsAnError) {
    const TestDir dir;
    write_picture(dir / "a.png", random_picture(17, 9), kLinear);
    const std::string whole = bytes_of(dir / "a.png");
    std::string damaged = whole;
    damaged[33] = '\x60';  // of the second chunk: 1.6 GB
    for (const std::string& bytes : {damaged, whole.substr(0, whole.size() - 1), whole.substr(0, 8)}) {
        write_bytes(dir / "b.png", bytes);
        EXPECT_EQ(error_of([&] { read_picture(dir / "b.png"); }),
                  (dir / "b.png").string() + ": the PNG file is truncated; copy it again from where it came");
    }
    write_bytes(dir / "b.png", whole + std::string(100, '\0'));  // padding does no harm
    EXPECT_EQ(read_picture(dir / "b.png").width(), 17);
}

TEST(PictureFile, ExtensionsAreToldInAnyCase) {
    EXPECT_EQ(lower_extension("which? folder/A.b.EXR"), ".exr");
    EXPECT_EQ(lower_extension("a"), "");
    EXPECT_EQ(lower_extension(".png"), "");
}

TEST(PictureFile, WithAnUnknownExtensionIsAnError) {
    const TestDir dir;
    for (const char* name : {"a.gif", "a", "a.png.bak", ".png"}) {
        const std::string expected =
            (dir / name).string() + ": pictures are written as .png, .tif, .jpg or .exr";
        EXPECT_EQ(error_of([&] { write_picture(dir / name, random_picture(2, 2), kSrgb); }), expected);
        EXPECT_EQ(error_of([&] { require_picture_format(dir / name); }), expected);
    }
    EXPECT_NO_THROW(require_picture_format("somewhere/else.JPG"));
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{});
}

TEST(PictureFile, OfExrRefusesToBeEncoded) {
    const TestDir dir;
    EXPECT_EQ(error_of([&] { write_picture(dir / "a.exr", random_picture(2, 2), kSrgb); }),
              (dir / "a.exr").string() +
                  ": EXR files hold linear light; use --encoding linear, or write .png or .tif");
    EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{});
}

TEST(PictureRows, FillNoMoreThanTheRowsOfALargerBuffer) {
    const TestDir dir;
    for (const char* name : {"a.png", "a.tif", "a.exr"}) {
        write_picture(dir / name, Image<Rgb>(30, 20, Rgb(0.5f)), {});
        PictureRows rows(dir / name);
        std::vector<float> values(30 * 20 * 3, 7.0f);
        rows.read(4, 6, 0, 3, values);
        EXPECT_NEAR(values[30 * 2 * 3 - 1], 0.5f, 1e-4) << name;
        for (std::size_t i = 30 * 2 * 3; i < values.size(); ++i) ASSERT_EQ(values[i], 7.0f) << name;
        EXPECT_THROW(rows.read(0, 20, 0, 3, std::span(values).first(100)), ContractError);
        EXPECT_THROW(rows.read(19, 21, 0, 3, values), ContractError);
    }
}

// Masks and maps are placed as photographs are.
TEST(PictureFile, OfExrIsPlacedInItsDisplayWindow) {
    const TestDir dir;
    for (const bool with_alpha : {false, true}) {
        OIIO::ImageSpec spec(4, 3, with_alpha ? 4 : 3, OIIO::TypeDesc::FLOAT);
        spec.full_x = -2, spec.full_y = 5, spec.full_width = 7, spec.full_height = 6;
        spec.x = 0, spec.y = 6;  // columns 2 to 5, rows 1 to 3
        const auto output = OIIO::ImageOutput::create("exr");
        ASSERT_TRUE(output->open((dir / "a.exr").string(), spec));
        std::vector<float> values(static_cast<std::size_t>(12 * spec.nchannels), 0.5f);
        for (std::size_t i = 3; with_alpha && i < values.size(); i += 4) values[i] = 1;
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()) && output->close());
        const PictureWithAlpha picture = read_picture_with_alpha(dir / "a.exr");
        EXPECT_TRUE(images_identical(read_picture(dir / "a.exr"), picture.colour));
        ASSERT_EQ(picture.colour.region(), (Region{0, 0, 7, 6}));
        ASSERT_EQ(picture.alpha.region(), (Region{0, 0, 7, 6}));
        for (int y = 0; y < 6; ++y)
            for (int x = 0; x < 7; ++x) {
                const bool there = x >= 2 && x < 6 && y >= 1 && y < 4;
                EXPECT_EQ(picture.colour(x, y), Rgb(there ? 0.5f : 0.0f)) << x << ", " << y;
                EXPECT_EQ(picture.alpha(x, y), there ? 1.0f : 0.0f) << x << ", " << y;
            }
    }
}

TEST(PictureFile, OnAFullDiskLeavesTheOldOne) {
    const TestDir dir;
    const Image<Rgb> picture = random_picture(60, 50);
    for (const char* name : {"a.png", "a.tif", "a.exr", "a.jpg"}) {
        write_picture(dir / name, picture, kLinear);
        const std::size_t size = std::filesystem::file_size(dir / name);
        write_bytes(dir / name, "old");
        for (const std::size_t room : {std::size_t{0}, size / 2, size - 1}) {
            std::string message;
            {
                const FullDisk full(room);
                message = error_of([&] { write_picture(dir / name, picture, kLinear); });
            }
            EXPECT_EQ(message, (dir / name).string() + ": cannot be written: File too large") << room;
            EXPECT_TRUE(bytes_of(dir / name) == "old") << name << ", " << room;
        }
        std::filesystem::remove(dir / name);
        EXPECT_EQ(names_in(dir.path()), std::vector<std::string>{}) << name;
    }
}

TEST(PictureFile, ThatCannotBeReadIsAnError) {
    const TestDir dir;
    EXPECT_THAT(error_of([&] { read_picture(dir / "no.png"); }),
                StartsWith((dir / "no.png").string() + ": cannot be read: "));
    write_bytes(dir / "text.png", "this is no picture");
    EXPECT_THAT(error_of([&] { read_picture(dir / "text.png"); }),
                StartsWith((dir / "text.png").string() + ": is not a picture that can be read: "));
    write_picture(dir / "a.png", random_picture(64, 64), kLinear);
    write_bytes(dir / "cut.png", bytes_of(dir / "a.png").substr(0, 9000));
    EXPECT_THAT(error_of([&] { read_picture(dir / "cut.png"); }),
                StartsWith((dir / "cut.png").string() + ": the PNG file is truncated"));
}

// The names of a PNG's chunks, in their order.
std::vector<std::string> chunks_of(const std::string& png) {
    std::vector<std::string> names;
    for (std::size_t at = 8; at + 8 <= png.size();) {
        std::size_t length = 0;
        for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<unsigned char>(png[at + i]);
        names.push_back(png.substr(at + 4, 4));
        at += length + 12;
    }
    return names;
}

TEST(PictureFile, OfPngSaysOnceHowItIsEncoded) {
    const TestDir dir;
    write_picture(dir / "a.png", random_picture(5, 4), kSrgb);
    write_picture_8bit(dir / "b.png", random_picture(5, 4));
    for (const char* name : {"a.png", "b.png"}) {
        const auto chunks = chunks_of(bytes_of(dir / name));
        EXPECT_EQ(std::ranges::count(chunks, "iCCP"), 1) << name;
        EXPECT_EQ(std::ranges::count(chunks, "sRGB"), 0) << name << ": ISO/IEC 15948 allows one of them";
    }
    write_picture(dir / "c.png", random_picture(5, 4), kLinear);
    EXPECT_EQ(std::ranges::count(chunks_of(bytes_of(dir / "c.png")), "gAMA"), 1);
    write_picture(dir / "d.png", random_picture(5, 4), *transfer_named("1.8"));
    const std::string gamma = bytes_of(dir / "d.png");
    EXPECT_THAT(chunks_of(gamma), testing::Not(testing::Contains("sRGB")));
    const auto at = gamma.find("gAMA");
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(gamma.substr(at + 4, 4), std::string("\x00\x00\xd9\x04", 4)) << "100000 / 1.8";
}

TEST(PictureFile, OfTheSamePictureIsTheSameAtAnyTime) {
    const TestDir dir;
    const Image<Rgb> picture = random_picture(5, 4);
    const auto write = [&](const std::string& folder) {
        std::filesystem::create_directory(dir / folder);
        for (const char* name : {"a.png", "a.tif", "a.jpg"})
            write_picture(dir / folder / name, picture, kSrgb);
        write_picture(dir / folder / "a.exr", picture, kLinear);
    };
    ::unsetenv("SOURCE_DATE_EPOCH");
    write("early");
    ::sleep(1);  // dates in pictures are of whole seconds
    write("late");
    for (const char* name : {"a.png", "a.tif", "a.jpg", "a.exr"})
        EXPECT_EQ(bytes_of(dir / "early" / name), bytes_of(dir / "late" / name)) << name;
    ::setenv("SOURCE_DATE_EPOCH", "86399", 1);
    write("dated");
    ::unsetenv("SOURCE_DATE_EPOCH");
    for (const char* name : {"a.tif", "a.exr"})
        EXPECT_THAT(bytes_of(dir / "dated" / name), HasSubstr("1970:01:01 23:59:59")) << name;
}

}  // namespace
}  // namespace tangi
