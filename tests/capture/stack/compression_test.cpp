// compression_test.cpp: how strongly photographs are compressed is read off their files, and said.
#include "capture/stack/compression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Image<Rgb> some_picture() {
    Image<Rgb> picture(40, 30);
    for (std::size_t i = 0; i < picture.size(); ++i)
        picture.pixels()[i] = Rgb(static_cast<float>(i * i % 97) / 97);
    return picture;
}

TEST(Compression, QualityIsThatTheFileWasWrittenWith) {
    const TestDir dir;
    for (const int quality : {20, 50, 60, 75, 90, 95, 100}) {
        write_picture(dir / "a.jpg", some_picture(), {}, {.jpeg_quality = quality});
        const auto found = jpeg_quality(dir / "a.jpg");
        ASSERT_TRUE(found) << quality;
        EXPECT_NEAR(*found, quality, 1);
    }
}

TEST(Compression, OtherAndDamagedFilesHaveNone) {
    const TestDir dir;
    write_picture(dir / "a.png", some_picture(), {});
    EXPECT_FALSE(jpeg_quality(dir / "a.png"));
    EXPECT_FALSE(jpeg_quality(dir / "none.jpg"));
    write_picture(dir / "a.jpg", some_picture(), {});
    const std::string whole = bytes_of(dir / "a.jpg");
    for (const std::size_t kept : {0u, 2u, 5u, 20u, 60u}) {
        write_bytes(dir / "cut.jpg", whole.substr(0, kept));
        EXPECT_FALSE(jpeg_quality(dir / "cut.jpg")) << kept;
    }
}

TEST(Compression, IsToldWhereItIsStrong) {
    const auto warnings = [](int quality) {
        const TestDir dir;
        std::vector<Light> lights = dome_lights(5);
        for (Light& light : lights) {
            light.name = std::filesystem::path(light.name).replace_extension(".jpg");
            write_picture(dir / light.name, some_picture(), {}, {.jpeg_quality = quality});
        }
        write_lights(dir / "lights.lp", lights);
        Stack stack = open_stack(dir.path());
        warn_of_compression(stack);
        return stack.warnings;
    };
    EXPECT_THAT(warnings(75), ElementsAre(HasSubstr("JPEG of quality 75")));
    EXPECT_THAT(warnings(95), IsEmpty());
}

}  // namespace
}  // namespace tangi
