// registration_grid_test.cpp: photographs that are fitted and those that are held out are looked at
// in the same places, however large they are and however many.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/formats/lights_file.h"
#include "capture/registration/registration.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

Stack stack_of(int width, int height, int photos, int held_out) {
    Stack stack;
    stack.crop = {0, 0, width, height};
    stack.photos.resize(static_cast<std::size_t>(photos - held_out));
    stack.held_out.resize(static_cast<std::size_t>(held_out));
    return stack;
}

TEST(RegistrationGrid, IsTheSameWhicheverPhotographsAreHeldOut) {
    for (const auto& [width, height] : {std::pair(300, 200), {900, 700}, {1300, 1000}, {4000, 3000}})
        for (const int photos : {9, 48, 400}) {
            const RegistrationGrid none(stack_of(width, height, photos, 0));
            for (const int held_out : {1, photos / 8, photos / 2}) {
                const RegistrationGrid grid(stack_of(width, height, photos, held_out));
                EXPECT_EQ(grid.reduction, none.reduction) << width << ", " << photos;
                EXPECT_EQ(grid.patches, none.patches) << width << ", " << photos;
            }
            EXPECT_EQ(none.patches.empty(), none.reduction == 1);
        }
    // A bounded number of bytes.
    const RegistrationGrid many(stack_of(4000, 3000, 400, 0)), few(stack_of(4000, 3000, 9, 0));
    EXPECT_LT(few.reduction, many.reduction);
    EXPECT_GT(few.patches.size(), many.patches.size());
}

// [1] Values that vary over some pixels, 0 to 1, the same everywhere and always.
float blobs(int x, int y, std::uint32_t seed) {
    const auto lattice = [&](int i, int j) {
        std::uint32_t h = static_cast<std::uint32_t>(i) * 0x9E3779B1u ^
                          static_cast<std::uint32_t>(j) * 0x85EBCA77u ^ seed * 0xC2B2AE3Du;
        h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
        return static_cast<float>((h ^ (h >> 13)) & 0xFFFF) / 65535;
    };
    constexpr int size = 6;
    const int i = x / size, j = y / size;
    const float u = static_cast<float>(x % size) / size, v = static_cast<float>(y % size) / size;
    return (1 - v) * ((1 - u) * lattice(i, j) + u * lattice(i + 1, j)) +
           v * ((1 - u) * lattice(i, j + 1) + u * lattice(i + 1, j + 1));
}

// A flat painting of two colours with relief in the first order of its slope, photographed 1300 x 1000 under
// 10 lights by a camera that jumps by whole pixels.
class LargePictures : public testing::Test {
protected:
    static constexpr int kPictures = 10, kWide = 1300, kHigh = 1000, kMargin = 40;

    static glm::ivec2 jump(int photo, int px) { return {photo * 7 % 5 * px / 4, photo * 3 % 4 * px / 3}; }

    void photograph(int px) {
        std::vector<Light> lights;
        for (int i = 0; i < kPictures; ++i) {
            const double azimuth = 2.4 * i, slope = 0.5 + 0.1 * i;
            const auto u = static_cast<float>(slope * std::cos(azimuth)),
                       v = static_cast<float>(slope * std::sin(azimuth));
            Image<Rgb> photo(kWide, kHigh);
            const glm::ivec2 by = glm::ivec2(kMargin) - jump(i, px);
            for (int y = 0; y < kHigh; ++y)
                for (int x = 0; x < kWide; ++x) {
                    const glm::ivec2 at(x + by.x, y + by.y);
                    const float paint = 0.15f + 0.5f * blobs(at.x, at.y, 1);
                    const float lean_x = 0.4f * (blobs(at.x, at.y, 2) - 0.5f),
                                lean_y = 0.4f * (blobs(at.x, at.y, 3) - 0.5f);
                    photo(x, y) = Rgb(paint * std::max(0.05f, 1 + lean_x * u + lean_y * v));
                }
            lights.push_back(
                {.name = fmt::format("photo_{}.png", i), .direction = glm::normalize(Vec3(u, v, 1))});
            write_picture_8bit(dir_ / lights.back().name, photo);
        }
        write_lights(dir_ / "lights.lp", lights);
    }

    TestDir dir_;
};

TP_LONG TEST_F(LargePictures, HeldOutAreRegisteredAndHaveNoSay) {
    photograph(0);
    Stack some = open_stack(dir_.path()), only = some;
    hold_out(some, "4:4");
    only.photos = some.photos;
    const Registration with = register_stack(some, {}), without = register_stack(only, {});
    EXPECT_FALSE(with.moved);
    EXPECT_THAT(some.warnings, testing::IsEmpty());
    EXPECT_EQ(some.held_out.size(), 2u);
    ASSERT_EQ(with.held_out.size(), 2u);
    for (const PhotoDrift& drift : with.held_out) {
        EXPECT_TRUE(drift.registered) << drift.name;
        EXPECT_GT(drift.correlation, 0.9) << drift.name;
        EXPECT_LT(drift.drift_px, 0.05) << drift.name;
    }
    for (std::size_t i = 0; i < with.photos.size(); ++i)
        EXPECT_EQ(with.photos[i].homography, without.photos[i].homography) << i;
}

TP_LONG TEST_F(LargePictures, HeldOutAreFollowedAsFarAsTheOthers) {
    const int px = 24;
    photograph(px);
    Stack stack = open_stack(dir_.path());
    hold_out(stack, "4:4");
    const Registration r = register_stack(stack, {});
    EXPECT_TRUE(r.moved);
    EXPECT_EQ(stack.held_out.size(), 2u);
    const auto reference = std::ranges::find_if(
        stack.photos, [](const StackPhoto& photo) { return !photo.homography.has_value(); });
    ASSERT_NE(reference, stack.photos.end());
    for (const auto* photos : {&stack.photos, &stack.held_out})
        for (const StackPhoto& photo : *photos) {
            const glm::dvec2 moved =
                mapped(photo.homography.value_or(Homography(1)), {600, 500}) - glm::dvec2(600, 500);
            const glm::ivec2 truth = jump(photo.number, px) - jump(reference->number, px);
            EXPECT_LT(glm::length(moved - glm::dvec2(truth)), 0.1) << photo.light.name;
        }
}

}  // namespace
}  // namespace tangi
