// photo_alpha_test.cpp: what is transparent was not photographed; what shows through is divided by
// alpha.
#include <gmock/gmock.h>

#include "capture/stack/survey.h"
#include "tests/support/capture/photo_files.h"

namespace tangi {
namespace {

using testing::Contains;
using testing::HasSubstr;

double alpha_at(int x) { return x < 10 ? 0.0 : x < 20 ? 0.4 : x < 30 ? 0.8 : 1.0; }

struct AlphaFile {
    const char* name;
    TypeDesc type;
    bool multiplied;
    double tolerance;
};

TEST(PhotoAlpha, SaysWhatIsNoSample) {
    const TestDir dir;
    const AlphaFile kinds[] = {{"straight.png", TypeDesc::UINT16, false, 1e-4},
                               {"straight.tif", TypeDesc::UINT8, false, 3e-3},
                               {"straight16.tif", TypeDesc::UINT16, false, 1e-4},
                               {"multiplied.tif", TypeDesc::UINT16, true, 1e-4},
                               {"multiplied.exr", TypeDesc::FLOAT, true, 1e-6}};
    for (const AlphaFile& kind : kinds) {
        const std::vector<float> colours = random_codes(3, 8);
        std::vector<float> stored;
        for (std::size_t i = 0; i < colours.size() / 3; ++i) {
            const auto alpha = static_cast<float>(alpha_at(static_cast<int>(i) % kPhotoWidth));
            for (std::size_t c = 0; c < 3; ++c)
                stored.push_back(colours[3 * i + c] * (kind.multiplied ? alpha : 1));
            stored.push_back(alpha);
        }
        OIIO::ImageSpec spec = spec_of(kind.type, 4);
        spec.alpha_channel = 3;
        if (!kind.multiplied) spec.attribute("oiio:UnassociatedAlpha", 1);
        write(dir / kind.name, spec, stored);
        PhotoFile file(dir / kind.name);
        EXPECT_EQ(file.header().channels, 3);
        std::vector<float> values(colours.size());
        for (int y = 0; y < kPhotoHeight; y += 5)
            file.read_rows(y, std::min(y + 5, kPhotoHeight),
                           std::span(values).subspan(static_cast<std::size_t>(y * kPhotoWidth * 3)));
        EXPECT_EQ(file.transparent(), 20 * kPhotoHeight) << kind.name;
        EXPECT_EQ(file.without_number(), 0) << kind.name;
        for (std::size_t i = 0; i < values.size(); ++i)
            if (alpha_at(static_cast<int>(i / 3) % kPhotoWidth) < 0.5)
                ASSERT_TRUE(std::isnan(values[i])) << kind.name;
            else
                ASSERT_NEAR(values[i], colours[i], kind.tolerance) << kind.name << ", " << i;
    }
}

// A fourth byte of a BMP file is no alpha: most programs leave it at 0.
TEST(PhotoAlpha, OfBmpIsNotUsed) {
    const TestDir dir;
    std::vector<float> stored = random_codes(4, 8);
    for (std::size_t i = 3; i < stored.size(); i += 4) stored[i] = 0;
    write(dir / "a.bmp", spec_of(TypeDesc::UINT8, 4), stored);
    const std::vector<float> values = read_in_bands(dir / "a.bmp", 7);
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_NEAR(values[i], stored[i / 3 * 4 + i % 3], 1e-6);
}

TEST(PhotoAlpha, IsToldOfAStack) {
    const TestDir dir;
    const std::vector<Light> lights = dome_lights(5);
    for (const Light& light : lights) {
        OIIO::ImageSpec spec = spec_of(TypeDesc::UINT16, 4);
        spec.alpha_channel = 3;
        spec.attribute("oiio:UnassociatedAlpha", 1);
        std::vector<float> stored = random_codes(4, 8);
        for (std::size_t i = 3; i < stored.size(); i += 4) stored[i] = i / 4 < 100 ? 0 : 1;
        write(dir / light.name, spec, stored);
    }
    write_lights(dir / "lights.lp", lights);
    Stack stack = open_stack(dir.path());
    const Survey surveyed = survey(stack);
    EXPECT_NEAR(surveyed.photos[2].present, 1 - 100.0 / (kPhotoWidth * kPhotoHeight), 1e-9);
    tell_pixels_without_number(stack, surveyed);
    EXPECT_THAT(stack.warnings, Contains(testing::AllOf(HasSubstr("transparent"), HasSubstr("100 of "))));
}

}  // namespace
}  // namespace tangi
