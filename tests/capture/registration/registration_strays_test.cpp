// registration_strays_test.cpp: photographs that cannot be registered are named, and lead no other
// astray.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/registration/registration.h"
#include "tests/support/capture/registration_scenes.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

// A stack of 12 in which these photographs are replaced.
std::string warnings_with(const std::vector<int>& replaced, const Image<Rgb>& by, std::size_t& left) {
    const RegistrationScene scene(12, 1, 0);
    for (const int i : replaced)
        write_picture(scene.folder / fmt::format("photo_{:03d}.png", i), by, {}, {.bits = 16});
    Stack stack = open_stack(scene.folder.path());
    register_stack(stack, {});
    left = stack.photos.size();
    std::string all;
    for (const std::string& warning : stack.warnings) all += warning;
    return all;
}

TP_LONG TEST(RegisterStack, NamesABlackPhotographAndGoesOn) {
    std::size_t left = 0;
    EXPECT_THAT(warnings_with({4}, Image<Rgb>(kWidth, kHeight, Rgb(0)), left),
                testing::AllOf(testing::HasSubstr("photo_004.png"), testing::HasSubstr("rejected 1")));
    EXPECT_EQ(left, 11u);
}

TP_LONG TEST(RegisterStack, NamesAPhotographOfSomethingElseAndGoesOn) {
    std::size_t left = 0;
    EXPECT_THAT(warnings_with({6}, another_scene(), left), testing::HasSubstr("photo_006.png"));
    EXPECT_EQ(left, 11u);
}

// Wherever it is in the tree of lights: the others are not led astray by it, and it is nobody's reference.
// Where it stands decides what the first reference is, and what its neighbours are compared with.
class AForeignPhotograph : public testing::TestWithParam<std::pair<int, bool>> {};

TP_LONG TEST_P(AForeignPhotograph, MovesNoOther) {
    const auto [foreign, moves] = GetParam();
    const RegistrationScene scene(24, moves ? 1.5 : 0, 0);
    const std::string name = fmt::format("photo_{:03d}.png", foreign);
    write_picture(scene.folder / name, another_scene(), {}, {.bits = 16});
    Stack stack = open_stack(scene.folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_EQ(r.moved, moves);
    EXPECT_NE(r.reference, name);
    if (!moves) {
        EXPECT_EQ(r.reference, foreign == 0 ? "photo_001.png" : "photo_000.png");
    }
    EXPECT_EQ(stack.photos.size(), 23u);
    for (const PhotoDrift& drift : r.photos)
        if (drift.name != name) {
            EXPECT_GT(drift.correlation, 0.8) << drift.name;
        }
    for (const StackPhoto& photo : stack.photos) EXPECT_NE(photo.light.name, name);
    if (!moves) {
        EXPECT_LT(r.typical_drift_px, 0.1);
    }
}

INSTANTIATE_TEST_SUITE_P(RegisterStack, AForeignPhotograph,
                         testing::Values(std::pair(0, true), std::pair(11, true), std::pair(4, false),
                                         std::pair(17, false), std::pair(22, false)));

// Two lines of the lights file are exchanged: both photographs show the painting, under another light.
class ExchangedLights : public testing::TestWithParam<std::pair<std::size_t, double>> {};

TP_LONG TEST_P(ExchangedLights, AreNoMotionAndNoReasonToLeavePhotographsOut) {
    const auto [other, shift_px] = GetParam();
    const RegistrationScene scene(16, shift_px, 0, painting(), 10, Arrangement::spiral);
    Stack stack = open_stack(scene.folder.path());
    std::swap(stack.photos[0].light.direction, stack.photos[other].light.direction);
    const Registration r = register_stack(stack, {});
    EXPECT_EQ(r.moved, shift_px > 0);
    EXPECT_EQ(stack.photos.size(), 16u);
    EXPECT_THAT(stack.warnings, testing::IsEmpty());
    for (const std::size_t i : {std::size_t{0}, other}) {
        EXPECT_TRUE(r.photos[i].registered) << i;
        EXPECT_GT(r.photos[i].correlation, 0.5) << i;
        // Under which light it was shown is told: the one that the other's line has.
        ASSERT_TRUE(r.photos[i].per_photo_light) << i;
        const glm::dvec3 truth(stack.photos[i == 0 ? other : 0].light.direction);
        EXPECT_GT(glm::dot(*r.photos[i].per_photo_light, truth), 0.8) << i;
        EXPECT_GT(glm::dot(*r.photos[i].per_photo_light, truth),
                  glm::dot(*r.photos[i].per_photo_light, glm::dvec3(stack.photos[i].light.direction)))
            << i;
        EXPECT_TRUE(to_json(r)["photos"][i]["per_photo_light"].is_array());
    }
    EXPECT_FALSE(r.photos[2].per_photo_light);
    EXPECT_TRUE(to_json(r)["photos"][2]["per_photo_light"].is_null());
    EXPECT_LE(scene.rms_error_px(r), shift_px > 0 ? 0.25 : 0.1);
}

INSTANTIATE_TEST_SUITE_P(RegisterStack, ExchangedLights,
                         testing::Values(std::pair(1, 0.0), std::pair(4, 0.0), std::pair(1, 1.0)));

TP_LONG TEST(RegisterStack, FailsWhereTooFewShowTheSame) {
    const RegistrationScene scene(5, 1, 0);
    for (const int i : {1, 2, 3})
        write_picture(scene.folder / fmt::format("photo_{:03d}.png", i), Image<Rgb>(kWidth, kHeight, Rgb(0)),
                      {}, {.bits = 16});
    Stack stack = open_stack(scene.folder.path());
    EXPECT_THAT(error_of([&] { register_stack(stack, {}); }),
                testing::AllOf(testing::HasSubstr("photo_001.png"), testing::HasSubstr("--register off")));
}

}  // namespace
}  // namespace tangi
