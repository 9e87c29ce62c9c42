// samples_test.cpp: what is no number reaches nobody as black or as light, in photographs and in
// frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "capture/radiometry/develop_stack.h"
#include "capture/stack/survey.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinite = std::numeric_limits<float>::infinity();
constexpr int kSampledWidth = 12, kSampledHeight = 9;

// EXR photographs of different greys, and frames beside them.
struct FloatStack {
    TestDir dir;
    std::vector<Light> lights = dome_lights(5);
    std::vector<Image<Rgb>> pictures;

    FloatStack() {
        for (std::size_t i = 0; i < lights.size(); ++i) {
            lights[i].name = fs::path(lights[i].name).replace_extension(".exr").string();
            pictures.emplace_back(kSampledWidth, kSampledHeight, Rgb(0.2f + 0.1f * static_cast<float>(i)));
        }
        fs::create_directory(dir / "frames");
    }
    Stack open(const DevelopOptions& develop = {}) {
        for (std::size_t i = 0; i < lights.size(); ++i) write_picture(dir / lights[i].name, pictures[i], {});
        write_lights(dir / "lights.lp", lights);
        return open_stack(dir.path(), {.develop = develop});
    }
    fs::path frame(const std::string& name, const Image<Rgb>& picture) {
        write_picture(dir / "frames" / (name + ".exr"), picture, {});
        return dir / "frames" / (name + ".exr");
    }
};

Band band_of(const Stack& stack) { return StackReader(stack).read(0, kSampledHeight, Transfer{}); }

TEST(Samples, ThatAreNoNumbersAreMissingAndNotBlack) {
    FloatStack set;
    set.pictures[1](3, 2).g = kNan;
    set.pictures[2](4, 5) = Rgb(kInfinite);
    set.pictures[2](5, 5) = Rgb(0.5f, -kInfinite, 0.5f);
    Stack stack = set.open();
    const Band band = band_of(stack);
    for (int photo = 0; photo < 5; ++photo)
        for (int y = 0; y < kSampledHeight; ++y)
            for (int x = 0; x < kSampledWidth; ++x)
                for (int c = 0; c < 3; ++c) {
                    const bool missing =
                        (photo == 1 && x == 3 && y == 2) || (photo == 2 && (x == 4 || x == 5) && y == 5);
                    EXPECT_EQ(std::isnan(band.row(photo, c, y)[x]), missing)
                        << photo << ": " << x << ", " << y;
                }
    const Survey surveyed = survey(stack);
    EXPECT_EQ(surveyed.photos[0].without_number, 0);
    EXPECT_EQ(surveyed.photos[1].without_number, 1);
    EXPECT_EQ(surveyed.photos[2].without_number, 2);
    EXPECT_NEAR(surveyed.photos[2].mean, 0.4, 1e-3);  // of what is there
    tell_pixels_without_number(stack, surveyed);
    EXPECT_THAT(stack.warnings, ElementsAre(AllOf(HasSubstr("no number"),
                                                  HasSubstr("1 of photo_001.exr, 2 of photo_002.exr"))));
}

// Registered, it is not mixed with its neighbours.
TEST(Samples, ThatAreNoNumbersAreMissingWherePhotographsAreResampled) {
    FloatStack set;
    set.pictures[1](5, 4).r = kInfinite;
    Stack stack = set.open();
    Homography shift(1);
    shift[2][0] = 0.25;
    stack.photos[1].homography = shift;
    const Band band = band_of(stack);
    EXPECT_TRUE(std::isnan(band.row(1, 0, 4)[5]));
    EXPECT_TRUE(std::isnan(band.row(1, 1, 4)[5]));
    for (int y = 0; y < kSampledHeight; ++y)
        for (int x = 0; x < kSampledWidth - 1; ++x)
            if (const float value = band.row(1, 2, y)[x]; !std::isnan(value)) {
                EXPECT_NEAR(value, 0.3f, 1e-5);
            }
    EXPECT_FALSE(std::isnan(band.row(1, 0, 0)[0]));
}

TEST(Samples, OfAPhotographWithoutAnyLeaveItOut) {
    FloatStack set;
    set.pictures[3] = Image<Rgb>(kSampledWidth, kSampledHeight, Rgb(kNan));
    Stack stack = set.open();
    Survey surveyed = survey(stack);
    EXPECT_EQ(surveyed.photos[3].present, 0);
    leave_out_black_photos(stack, surveyed, 4);
    EXPECT_EQ(stack.photos.size(), 4u);
    EXPECT_THAT(stack.warnings,
                ElementsAre(AllOf(HasSubstr("rejected 1 photograph that has no pixel here with a number"),
                                  HasSubstr("photo_003.exr"))));
}

TEST(Samples, OfFramesThatAreNoNumbersTellNothingThere) {
    FloatStack set;
    Image<Rgb> dark(kSampledWidth, kSampledHeight, Rgb(0.01f)),
        flat(kSampledWidth, kSampledHeight, Rgb(0.5f)), ambient(kSampledWidth, kSampledHeight, Rgb(0.02f));
    dark(2, 2) = Rgb(kNan);
    flat(3, 2).b = kInfinite;
    ambient(4, 2) = Rgb(0.02f, 1e30f, 0.02f);
    set.pictures[1](5, 2) = Rgb(kNan);
    Stack stack = set.open({.dark = set.frame("dark", dark),
                            .flat = set.frame("flat", flat),
                            .ambient = set.frame("ambient", ambient)});
    develop_stack(stack);
    for (const char* name : {"dark.exr", "flat.exr", "ambient.exr"})
        EXPECT_THAT(stack.warnings,
                    testing::Contains(AllOf(HasSubstr(name), HasSubstr("1 pixels hold no number"))))
            << name;
    const Band band = band_of(stack);
    for (int photo = 0; photo < 5; ++photo)
        for (int x = 0; x < kSampledWidth; ++x)
            for (int c = 0; c < 3; ++c) {
                const bool missing = x == 2 || x == 3 || x == 4 || (photo == 1 && x == 5);
                EXPECT_EQ(std::isnan(band.row(photo, c, 2)[x]), missing) << photo << ": " << x;
                EXPECT_NEAR(band.row(photo, c, 1)[x], 0.2 + 0.1 * photo - 0.01 - 0.01,
                            1e-4);  // a flat of its mean
            }
    EXPECT_THAT(error_of([&] {
                    Stack empty = set.open(
                        {.dark = set.frame("dark", Image<Rgb>(kSampledWidth, kSampledHeight, Rgb(kNan)))});
                    develop_stack(empty);
                }),
                HasSubstr("dark.exr: no pixel holds a number"));
}

}  // namespace
}  // namespace tangi
