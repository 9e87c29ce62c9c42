// stack_reader_test.cpp: photographs of a stack are cropped, masked, linearised and read in bands.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/stack/stack.h"
#include "surface/base/parallel.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

TEST(StackReader, GivesTheSameValuesInBandsOfAnyHeight) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(6), 13, 29);
    const Stack stack = open_stack(dir.path());
    for (const int rows : {29, 1, 4, 10, 28}) {
        StackReader reader(stack);
        for (int y0 = 0; y0 < 29; y0 += rows) {
            const Band band = reader.read(y0, std::min(y0 + rows, 29), Transfer{});
            EXPECT_EQ(band.photos(), 6);
            for (int i = 0; i < 6; ++i)
                for (int y = band.y0(); y < band.y1(); ++y)
                    for (int x = 0; x < 13; ++x) {
                        ASSERT_NEAR(band.row(i, 0, y)[x] * 255, i + x, 1e-4);
                        ASSERT_NEAR(band.row(i, 1, y)[x] * 255, y, 1e-4);
                        ASSERT_NEAR(band.row(i, 2, y)[x] * 255, 5 * i, 1e-4);
                    }
        }
    }
}

// A layer that was painted on by itself, and black and white with holes: as masks of retouches are read.
TEST(StackReader, AMaskLeavesOutWhatIsTransparentInIt) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 4, 2);
    const auto mask = [&](const std::string& name, const std::vector<float>& grey_and_alpha) {
        OIIO::ImageSpec spec(4, 2, 2, OIIO::TypeDesc::UINT8);
        spec.alpha_channel = 1;
        spec.attribute("oiio:UnassociatedAlpha", 1);
        const auto output = OIIO::ImageOutput::create(name);
        EXPECT_TRUE(output->open((dir / name).string(), spec));
        EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, grey_and_alpha.data()));
        EXPECT_TRUE(output->close());
        const Stack stack = open_stack(dir.path(), {.mask_file = dir / name});
        fs::remove(dir / name);
        std::string kept;
        for (const unsigned char inside : stack.mask.pixels()) kept += inside ? '1' : '0';
        return kept;
    };
    EXPECT_EQ(mask("layer.png", {0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0.4f, 0, 0}), "01100100");
    EXPECT_EQ(mask("holes.png", {1, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0, 0, 0, 1}), "01010100");
    EXPECT_EQ(mask("opaque.png", {1, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1, 1, 0, 1, 0, 1}), "10011100");
}

TEST(StackReader, ReadsTheCropAndItsMask) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 20, 10);
    Image<Rgb> mask(20, 10, Rgb(1));
    mask(7, 4) = Rgb(0.4f);     // dark is out
    mask(8, 4) = {0, 0.6f, 0};  // light in any channel is in
    fs::create_directory(dir / "masks");
    write_picture_8bit(dir / "masks/mask.png", mask);
    const Stack stack =
        open_stack(dir.path(), {.crop = Region{5, 2, 12, 9}, .mask_file = dir / "masks/mask.png"});
    EXPECT_EQ(stack.width(), 7);
    EXPECT_EQ(stack.height(), 7);
    ASSERT_EQ(stack.mask.region(), (Region{0, 0, 7, 7}));
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 7; ++x) EXPECT_EQ(stack.mask(x, y) != 0, !(x == 2 && y == 2)) << x << ", " << y;
    StackReader reader(stack);
    const Band band = reader.read(1, 4, Transfer{});
    for (int y = 1; y < 4; ++y)
        for (int x = 0; x < 7; ++x) {
            EXPECT_NEAR(band.row(2, 0, y)[x] * 255, 2 + x + 5, 1e-4);
            EXPECT_NEAR(band.row(2, 1, y)[x] * 255, y + 2, 1e-4);
        }
}

TEST(StackReader, LinearisesByTheCurveAskedFor) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 200, 3);
    const Stack stack = open_stack(dir.path());
    StackReader reader(stack);
    for (const Transfer& transfer : {Transfer{Transfer::Kind::srgb}, Transfer{Transfer::Kind::gamma, 1.8},
                                     Transfer{}, Transfer{Transfer::Kind::gamma, 2.4}}) {
        const Band band = reader.read(0, 3, transfer);
        for (int x = 0; x < 200; ++x)
            ASSERT_NEAR(band.row(1, 0, 1)[x], transfer.decode(static_cast<float>(1 + x) / 255), 1e-7)
                << transfer.name();
    }
}

TEST(StackReader, ReadsFloatsAboveOne) {
    const TestDir dir;
    std::vector<Light> lights = dome_lights(4);
    for (Light& light : lights) {
        light.name.replace(light.name.find(".png"), 4, ".exr");
        write_picture(dir / light.name, Image<Rgb>(5, 5, Rgb(0.125f, 1, 8)), Transfer{});
    }
    write_lights(dir / "lights.lp", lights);
    const Stack stack = open_stack(dir.path());
    EXPECT_EQ(stack.bits, 32);
    StackReader reader(stack);
    const Band band = reader.read(0, 5, Transfer{});
    EXPECT_EQ(band.row(3, 0, 4)[4], 0.125f);
    EXPECT_EQ(band.row(3, 2, 4)[4], 8);
}

TEST(StackReader, AsksForAsManyRowsAsFitTheMemory) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 10, 30);
    const Stack stack = open_stack(dir.path());
    const StackReader reader(stack);  // a row: 4 photographs, 3 channels, 10 pixels, 4 bytes
    EXPECT_EQ(reader.rows_for(480 * 7), 7);
    EXPECT_EQ(reader.rows_for(480 * 8 - 1), 7);
    EXPECT_EQ(reader.rows_for(0), 1);
    EXPECT_EQ(reader.rows_for(std::size_t{1} << 40), 30);
}

TEST(StackReader, GivesTheSameBitsOnAnyNumberOfThreads) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(9), 30, 20);
    const Stack stack = open_stack(dir.path());
    const auto values = [&](int threads) {
        set_thread_count(threads);
        StackReader reader(stack);
        const Band band = reader.read(3, 17, {Transfer::Kind::srgb});
        set_thread_count(0);
        return std::vector<float>(band.row(0, 0, 3), band.row(8, 2, 16) + 30);
    };
    EXPECT_EQ(values(1), values(2));
}

}  // namespace
}  // namespace tangi
