// picture_substrate_test.cpp: pictures as supports, and supports that are kept.
#include "paint/substrate/picture_substrate.h"

#include <gmock/gmock.h>

#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

Image<Rgb> waves() {
    Image<Rgb> picture(64, 48);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            picture(x, y) = Rgb(0.4f, 0.5f, 0.3f) * (1 + 0.5f * std::sin(0.4f * static_cast<float>(x)));
    return picture;
}

TEST(PictureSubstrate, HasThePicturesColoursAndTheReliefOfItsLightness) {
    const Surface s =
        substrate_of_picture(waves(), lightness_of(waves()), {.pixel_mm = 0.1, .relief_mm = 0.5});
    EXPECT_TRUE(images_near(s.diffuse, waves(), 1e-6));
    EXPECT_EQ(s.mm_per_pixel, 0.1);
    EXPECT_TRUE(s.scale_known);
    const auto [low, high] = std::minmax_element(s.height_mm.pixels().begin(), s.height_mm.pixels().end());
    EXPECT_NEAR(*high - *low, 0.5, 0.01);
    double mean = 0;
    for (const float mm : s.height_mm.pixels()) mean += mm / static_cast<double>(s.height_mm.size());
    EXPECT_NEAR(mean, 0, 1e-5);
    EXPECT_NEAR(s.height_mm(4, 10), *high, 1e-3);  // bright is high: the crest is at x = 3.93
    EXPECT_TRUE(images_near(s.normal, normals_of(s.height_mm, 0.1), 1e-6));
    EXPECT_GT(std::abs(s.normal(8, 10).x), 0.3f);
}

TEST(PictureSubstrate, TakesAHeightMapOrNone) {
    Image<float> ramp(64, 48);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) ramp(x, y) = 0.25f + 0.001f * static_cast<float>(y);
    const Surface tilted = substrate_of_picture(waves(), ramp, {.relief_mm = 2});
    EXPECT_NEAR(tilted.height_mm(5, 40) - tilted.height_mm(5, 8), 2 * 32 / 47.0, 0.02);
    const Surface flat = substrate_of_picture(waves(), {}, {});
    for (const float mm : flat.height_mm.pixels()) ASSERT_EQ(mm, 0);
    const Surface even = substrate_of_picture(waves(), Image<float>(64, 48, 0.5f), {});
    for (const float mm : even.height_mm.pixels()) ASSERT_EQ(mm, 0);
}

TEST(PictureSubstrate, RefusesWhatIsNoSupport) {
    EXPECT_THAT(error_of([] { substrate_of_picture(Image<Rgb>(4, 100), {}, {}); }), HasSubstr("4 x 100"));
    EXPECT_THAT(error_of([] { substrate_of_picture(waves(), Image<float>(10, 10), {}); }),
                AllOf(HasSubstr("10 x 10"), HasSubstr("64 x 48")));
    Image<float> relief(64, 48);
    relief(3, 3) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(error_of([&] { substrate_of_picture(waves(), relief, {}); }), HasSubstr("finite"));
}

TEST(PictureSubstrate, IsKeptUnderAName) {
    const TestDir dir;
    const auto shelf = dir / "data" / "substrates";
    EXPECT_TRUE(kept_substrates(shelf).empty());
    const Surface s = substrate_of_picture(waves(), lightness_of(waves()), {});
    keep_substrate(shelf, "old linen, fine", s);
    keep_substrate(shelf, "board", s);
    EXPECT_THAT(kept_substrates(shelf), ElementsAre("board", "old linen, fine"));
    EXPECT_TRUE(images_near(read_painting(kept_substrate(shelf, "board")).height_mm, s.height_mm, 0));
    EXPECT_THAT(error_of([&] { keep_substrate(shelf, "board", s); }), HasSubstr("already"));
    EXPECT_THAT(error_of([&] { keep_substrate(shelf, "linen", s); }), HasSubstr("another name"));
    EXPECT_THAT(error_of([&] { keep_substrate(shelf, "../x", s); }), HasSubstr("'../x'"));
    EXPECT_THAT(error_of([&] { keep_substrate(shelf, "", s); }), HasSubstr("''"));
}

}  // namespace
}  // namespace tangi
