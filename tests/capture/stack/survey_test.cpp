// survey_test.cpp: one look at a stack: samples are its pixels, black photographs are left out.
#include "capture/stack/survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "surface/base/parallel.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Survey, HoldsThePixelsAsStored) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(5), 20, 30);
    const Stack stack = open_stack(dir.path());
    const Survey s = survey(stack, {.samples = 100});
    EXPECT_EQ(s.channels, 3);
    ASSERT_GE(s.sample_count(), 50);
    ASSERT_LE(s.sample_count(), 200);
    for (int k = 0; k < s.sample_count(); ++k)
        for (int i = 0; i < 5; ++i) {
            const glm::ivec2 at = s.positions[static_cast<std::size_t>(k)];
            const float* value = s.sample(k) + i * 3;
            EXPECT_NEAR(value[0] * 255, i + at.x, 1e-4);
            EXPECT_NEAR(value[1] * 255, at.y, 1e-4);
            EXPECT_NEAR(value[2] * 255, 5 * i, 1e-4);
        }
}

TEST(Survey, TakesEveryPixelOfASmallStackOnce) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 8, 6);
    const Survey s = survey(open_stack(dir.path()));
    std::set<std::pair<int, int>> seen;
    for (const glm::ivec2& p : s.positions) seen.emplace(p.x, p.y);
    EXPECT_EQ(seen.size(), 48u);
    EXPECT_EQ(s.sample_count(), 48);
}

// Otherwise what is concluded from a sample would depend on which way up a painting was photographed.
TEST(Survey, SamplesOfAMirroredOrTurnedPictureAreMirroredAndTurned) {
    const auto sampled = [](int width, int height) {
        const TestDir dir;
        write_test_stack(dir, dome_lights(4), width, height);
        return survey(open_stack(dir.path()), {.samples = 60});
    };
    using Samples = std::set<std::array<int, 3>>;  // x, y, and how early in the order
    const auto early = [](const Survey& s, int wanted) {
        const std::vector<int> chosen = s.spread(wanted);
        return std::set<int>(chosen.begin(), chosen.end());
    };
    for (const auto& [width, height] : {std::pair(40, 30), {31, 47}, {33, 33}, {64, 5}}) {
        const Survey upright = sampled(width, height), turned = sampled(height, width);
        EXPECT_GE(upright.sample_count(), 40);
        ASSERT_EQ(upright.sample_count(), turned.sample_count());
        const std::set<int> few = early(upright, 20), few_turned = early(turned, 20);
        EXPECT_GE(few.size(), 20u);
        EXPECT_LE(few.size(), 28u);
        Samples as_is, flopped, flipped, by_a_quarter;
        for (int k = 0; k < upright.sample_count(); ++k) {
            const glm::ivec2 at = upright.positions[static_cast<std::size_t>(k)];
            const int is_early = few.contains(k);
            as_is.insert({at.x, at.y, is_early});
            flopped.insert({width - 1 - at.x, at.y, is_early});
            flipped.insert({at.x, height - 1 - at.y, is_early});
        }
        for (int k = 0; k < turned.sample_count(); ++k) {
            const glm::ivec2 at = turned.positions[static_cast<std::size_t>(k)];
            by_a_quarter.insert({at.y, height - 1 - at.x, few_turned.contains(k)});
        }
        EXPECT_EQ(as_is.size(), static_cast<std::size_t>(upright.sample_count())) << "none twice";
        EXPECT_EQ(flopped, as_is);
        EXPECT_EQ(flipped, as_is);
        EXPECT_EQ(by_a_quarter, as_is);
    }
}

// Whether all or few of them: every part of the picture has its share.
TEST(Survey, SamplesAreSpreadEvenly) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 120, 90);
    const Survey s = survey(open_stack(dir.path()), {.samples = 1000});
    for (const int wanted : {2000, 400, 100}) {
        std::array<int, 12> parts{};
        const std::vector<int> chosen = s.spread(wanted);
        for (const int k : chosen) {
            const glm::ivec2 at = s.positions[static_cast<std::size_t>(k)];
            ++parts[static_cast<std::size_t>(at.y / 30 * 4 + at.x / 30)];
        }
        const double share = static_cast<double>(chosen.size()) / 12;
        for (const int count : parts) EXPECT_NEAR(count, share, 0.35 * share + 1) << wanted;
    }
}

TEST(Survey, MeasuresMeanMaximumAndClippedPart) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 10, 10);
    Image<Rgb> photo(10, 10, Rgb(0.2f));
    for (int x = 0; x < 10; ++x) photo(x, 0) = {1, 0.2f, 0.2f};  // 10 of 300 values
    write_picture_8bit(dir / "photo_002.png", photo);
    const Survey s = survey(open_stack(dir.path()));
    EXPECT_NEAR(s.photos[2].mean, 0.2 + 0.8 / 30, 1e-6);  // 0.2 is the code 51
    EXPECT_NEAR(s.photos[2].maximum, 1, 1e-6);
    EXPECT_NEAR(s.photos[2].clipped, 1 / 30.0, 1e-6);
    EXPECT_EQ(s.photos[1].clipped, 0);
    EXPECT_NEAR(s.photos[1].maximum, 10 / 255.0, 1e-6);
}

TEST(Survey, IsTheSameOnAnyNumberOfThreads) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(7), 40, 30);
    const Stack stack = open_stack(dir.path());
    set_thread_count(1);
    const Survey alone = survey(stack, {.samples = 77});
    set_thread_count(2);
    const Survey together = survey(stack, {.samples = 77});
    set_thread_count(0);
    EXPECT_EQ(alone.positions, together.positions);
    EXPECT_EQ(alone.values, together.values);
    for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(alone.photos[i].mean, together.photos[i].mean);
}

TEST(Survey, LeavesOutWhatTheMaskLeavesOut) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4), 20, 20);
    Image<Rgb> mask(20, 20);
    for (int y = 5; y < 15; ++y)
        for (int x = 8; x < 20; ++x) mask(x, y) = Rgb(1);
    std::filesystem::create_directory(dir / "masks");
    write_picture_8bit(dir / "masks/mask.png", mask);
    const Survey s =
        survey(open_stack(dir.path(), {.crop = Region{4, 4, 20, 20}, .mask_file = dir / "masks/mask.png"}));
    EXPECT_EQ(s.sample_count(), 120);
    for (const glm::ivec2& p : s.positions)
        EXPECT_TRUE(p.x >= 4 && p.x < 16 && p.y >= 1 && p.y < 11) << p.x << p.y;
    EXPECT_NEAR(s.sample(0)[0] * 255, s.positions[0].x + 4, 1e-4);  // positions are those of the crop
}

TEST(Survey, FindsTheDamagedPhotograph) {
    const TestDir dir;
    Random random(1);
    write_test_stack(dir, dome_lights(4), 64, 64);
    Image<Rgb> noise(64, 64);
    for (Rgb& c : noise.pixels()) c = {random.real(), random.real(), random.real()};
    write_picture_8bit(dir / "photo_001.png", noise);
    std::string damaged = bytes_of(dir / "photo_001.png");
    // Within one of its chunks, which are whole: else it would be refused when it is opened.
    std::fill_n(damaged.begin() + 2000, 1000, '\0');
    write_bytes(dir / "photo_001.png", damaged);
    EXPECT_THAT(error_of([&] { survey(open_stack(dir.path())); }),
                testing::StartsWith((dir / "photo_001.png").string() + ": cannot be decoded at rows "));
}

TEST(Survey, StopsWhenAsked) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4));
    EXPECT_THROW(survey(open_stack(dir.path()), {}, [](auto, double) { return false; }), Cancelled);
}

TEST(LeaveOutBlackPhotos, TakesThemOutOfStackAndSurveyWithAWarning) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(7));
    write_picture_8bit(dir / "photo_001.png", Image<Rgb>(8, 6, Rgb(0)));
    write_picture_8bit(dir / "photo_004.png",
                       Image<Rgb>(8, 6, Rgb(4 / 255.0f)));  // 1.6 %: the noise of a black one
    Stack stack = open_stack(dir.path());
    Survey s = survey(stack);
    const Survey before = s;
    leave_out_black_photos(stack, s);
    EXPECT_THAT(stack.warnings,
                ElementsAre(dir.path().string() +
                            ": rejected 2 photographs that are black: photo_001.png, photo_004.png"));
    ASSERT_EQ(stack.photos.size(), 5u);
    ASSERT_EQ(s.photos.size(), 5u);
    EXPECT_EQ(stack.photos[1].light.name, "photo_002.png");
    EXPECT_EQ(s.photos[1].mean, before.photos[2].mean);
    ASSERT_EQ(s.sample_count(), before.sample_count());
    for (int k = 0; k < s.sample_count(); ++k)
        for (int c = 0; c < 3; ++c) {
            EXPECT_EQ(s.sample(k)[1 * 3 + c], before.sample(k)[2 * 3 + c]);
            EXPECT_EQ(s.sample(k)[4 * 3 + c], before.sample(k)[6 * 3 + c]);
        }
}

TEST(LeaveOutBlackPhotos, SaysNothingWhereThereAreNone) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(5), 8, 9);
    Stack stack = open_stack(dir.path());
    Survey s = survey(stack);
    leave_out_black_photos(stack, s);
    EXPECT_EQ(stack.photos.size(), 5u);
    EXPECT_THAT(stack.warnings, IsEmpty());
}

// A hundredth of the light is left some hundreds of codes of 16 bits: a black one is so beside these.
TEST(LeaveOutBlackPhotos, OfADarkStackAreThoseWithoutLight) {
    const TestDir dir;
    const std::vector<Light> lights = dome_lights(6);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        Image<Rgb> photo(8, 6);
        for (std::size_t k = 0; k < photo.size(); ++k)
            photo.pixels()[k] = Rgb(i == 2 ? 1e-4f : 0.002f + 1e-4f * static_cast<float>(k));
        write_picture(dir / lights[i].name, photo, {}, {.bits = 16});
    }
    write_lights(dir / "lights.lp", lights);
    Stack stack = open_stack(dir.path());
    Survey s = survey(stack);
    leave_out_black_photos(stack, s);
    EXPECT_THAT(stack.warnings,
                ElementsAre(dir.path().string() + ": rejected 1 photograph that is black: photo_002.png"));
    for (const Light& light : lights)  // caps on
        write_picture(dir / light.name, Image<Rgb>(8, 6, Rgb(1e-3f)), {}, {.bits = 16});
    Stack black = open_stack(dir.path());
    Survey nothing = survey(black);
    EXPECT_THAT(error_of([&] { leave_out_black_photos(black, nothing); }), testing::HasSubstr("are black"));
}

TEST(LeaveOutBlackPhotos, IsAnErrorWhereTooFewRemain) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4));
    write_picture_8bit(dir / "photo_003.png", Image<Rgb>(8, 6, Rgb(0)));
    Stack stack = open_stack(dir.path());
    Survey s = survey(stack);
    EXPECT_EQ(error_of([&] { leave_out_black_photos(stack, s); }),
              dir.path().string() +
                  ": 1 of 4 photographs are black (photo_003.png), which leaves 3; at least 4 under "
                  "different lights are needed");
}

TEST(LeaveOutBlackPhotos, NamesFewOfManyAndNoneOfAll) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(12));
    const auto error_with_black = [&](int black) {
        for (int i = 0; i < black; ++i)
            write_picture_8bit(dir / fmt::format("photo_{:03}.png", i), Image<Rgb>(8, 6, Rgb(0)));
        Stack stack = open_stack(dir.path());
        Survey s = survey(stack);
        return error_of([&] { leave_out_black_photos(stack, s); });
    };
    const std::string most = error_with_black(10);
    EXPECT_NE(most.find("10 of 12 photographs are black"), std::string::npos) << most;
    EXPECT_EQ(most.find("photo_008"), std::string::npos) << most;
    EXPECT_EQ(error_with_black(12), dir.path().string() +
                                        ": all 12 photographs are black; at least 4 under different lights "
                                        "are needed");
}

TEST(LeaveOutBlackPhotos, OfAnotherSurveyBreaksTheContract) {
    const TestDir dir;
    write_test_stack(dir, dome_lights(4));
    Stack stack = open_stack(dir.path());
    Survey other;
    EXPECT_THROW(leave_out_black_photos(stack, other), ContractError);
}

}  // namespace
}  // namespace tangi
