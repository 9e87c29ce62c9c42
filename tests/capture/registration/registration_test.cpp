// registration_test.cpp: known motions of the camera are found again under moving lights, and none
// are found where there are none.
#include "capture/registration/registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <limits>

#include "surface/base/parallel.h"
#include "surface/image/local_contrast.h"
#include "tests/support/capture/registration_scenes.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

const RegistrationScene& shaken() {
    static const RegistrationScene scene(24, 1.5, 0.4);
    return scene;
}

const RegistrationScene& still() {
    static const RegistrationScene scene(24, 0, 0);
    return scene;
}

TP_LONG TEST(RegisterStack, RecoversShiftsAndTurnsUnderMovingLights) {
    Stack stack = open_stack(shaken().folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_TRUE(r.moved);
    const std::size_t reference = shaken().reference_of(r);
    // The reference's own error moves all photographs alike, which blurs nothing.
    const double error = shaken().rms_error_px(r), jitter_left = shaken().rms_jitter_px(r);
    std::cout << "[  FIGURE  ] generated stack registered to " << error << " px rms of the reference, to "
              << jitter_left << " px rms of each other\n";
    EXPECT_LE(error, 0.15);
    EXPECT_LE(jitter_left, 0.1);
    EXPECT_FALSE(stack.photos[reference].homography);
    ASSERT_EQ(stack.photos.size(), 24u);
    for (std::size_t i = 0; i < 24; ++i) {
        if (i == reference) continue;
        ASSERT_TRUE(r.photos[i].registered) << i;
        ASSERT_EQ(r.photos[i].warped, stack.photos[i].homography.has_value()) << i;
        if (r.photos[i].warped) {
            EXPECT_EQ(*stack.photos[i].homography, r.photos[i].homography);
        }
        EXPECT_LT(shaken().error_px(r.photos[i].homography, i, reference), 5 * r.photos[i].error_px) << i;
    }
}

// Of all photographs of stacks that moved by little and by much.
TP_LONG TEST(RegisterStack, StatedErrorsCoverTheTruth) {
    int within1 = 0, within2 = 0, all = 0;
    double squares = 0;
    const auto count = [&](const RegistrationScene& scene) {
        Stack stack = open_stack(scene.folder.path());
        const Registration r = register_stack(stack, {});
        const std::size_t reference = scene.reference_of(r);
        for (std::size_t i = 0; i < r.photos.size(); ++i) {
            if (i == reference || !r.photos[i].registered) continue;
            const double ratio = scene.error_px(r.photos[i].homography, i, reference) / r.photos[i].error_px;
            within1 += ratio < 1;
            within2 += ratio < 2;
            squares += ratio * ratio;
            ++all;
        }
    };
    count(shaken());
    count(RegistrationScene(16, 0.6, 0.3, painted(12), 15));
    count(RegistrationScene(12, 3, 0.8, painted(23), 35));
    std::cout << fmt::format(
        "[  FIGURE  ] errors within 1 and 2 of those stated: {} and {} of {}, rms {:.2f}\n", within1, within2,
        all, std::sqrt(squares / all));
    EXPECT_GE(within2, 0.85 * all);
    EXPECT_LE(std::sqrt(squares / all), 1.5);
    EXPECT_GE(std::sqrt(squares / all), 0.5);  // nor are they much too large
}

TP_LONG TEST(RegisterStack, RecoversShiftsOfManyPixels) {
    const RegistrationScene scene(24, 8, 0);
    Stack stack = open_stack(scene.folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_LE(scene.rms_error_px(r), 0.15);
    EXPECT_LE(scene.rms_jitter_px(r), 0.1);
}

TP_LONG TEST(RegisterStack, FindsNoMotionWhereThereIsNone) {
    Stack stack = open_stack(still().folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_FALSE(r.moved);
    EXPECT_LT(r.typical_drift_px, 0.05);
    EXPECT_THAT(stack.warnings, testing::IsEmpty());
    ASSERT_EQ(stack.photos.size(), 24u);
    for (const StackPhoto& photo : stack.photos) EXPECT_FALSE(photo.homography);
}

// Of few photographs, the mean of the others is all that one can be laid onto: relief looks like motion.
TP_LONG TEST(RegisterStack, FindsNoMotionInAFewPhotographs) {
    const PaintingTruth rough = procedural_painting({.seed = 3,
                                                     .width = 2 * (kWidth + 2 * kBorder),
                                                     .height = 2 * (kHeight + 2 * kBorder),
                                                     .mm_per_pixel = 0.125,
                                                     .supersampling = 1});
    for (const int lights : {4, 5, 6}) {
        const RegistrationScene scene(lights, 0, 0, rough, 30);
        Stack stack = open_stack(scene.folder.path());
        const Registration r = register_stack(stack, {});
        EXPECT_FALSE(r.moved) << lights;
        EXPECT_THAT(stack.warnings, testing::IsEmpty()) << lights;
    }
}

// The first photograph was taken before somebody touched the camera, which shook a little afterwards: the
// painting is where most photographs saw it.
TEST(RegisterStack, HasTheFrameThatMostPhotographsHave) {
    const RegistrationScene scene(24, [](int i) { return i == 0 ? MotionVector{3, -2} : jitter(i, 0.4, 0); });
    Stack stack = open_stack(scene.folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_TRUE(r.moved);
    EXPECT_NE(r.reference, "photo_000.png");
    EXPECT_TRUE(r.photos[0].warped);
    EXPECT_LE(r.typical_drift_px, 0.5);
    EXPECT_LE(scene.rms_jitter_px(r), 0.45);  // of photographs that stay where they are, too
}

TEST(RegisterStack, FollowsAFewPhotographsThatMovedAndSaysHowWell) {
    for (const int lights : {5, 6}) {
        const RegistrationScene scene(lights, 4, 0);
        Stack stack = open_stack(scene.folder.path());
        const Registration r = register_stack(stack, {});
        EXPECT_TRUE(r.moved) << lights;
        EXPECT_LE(scene.rms_error_px(r), 1) << lights;
        EXPECT_THAT(stack.warnings,
                    testing::ElementsAre(testing::HasSubstr("the camera seems to have moved")))
            << lights;
    }
}

// Files of floats can hold anything; such a pixel was all that a photograph's mean showed.
TEST(RegisterStack, OnePixelBeyondAllMeasureChangesNothing) {
    const TestDir dir;
    std::vector<Light> lights = open_stack(still().folder.path()).lights();
    lights.resize(8);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        Image<Rgb> photo = read_picture(still().folder / lights[i].name);
        if (i == 3) photo(100, 80) = Rgb(1e30f);
        lights[i].name = fmt::format("photo_{:03d}.exr", i);
        write_picture(dir / lights[i].name, photo, {});
    }
    write_lights(dir / "lights.lp", lights);
    Stack stack = open_stack(dir.path());
    const Registration r = register_stack(stack, {});
    EXPECT_FALSE(r.moved);
    EXPECT_EQ(stack.photos.size(), 8u);
    EXPECT_THAT(stack.warnings, testing::IsEmpty());
}

// Holes that stay where they are in the camera while the painting moves; as black they would be edges.
TEST(RegisterStack, WhatHasNoSampleIsNotMatched) {
    const TestDir dir;
    std::vector<Light> lights = open_stack(shaken().folder.path()).lights();
    for (Light& light : lights) {
        Image<Rgb> photo = read_picture(shaken().folder / light.name);
        for (int y = 0; y < photo.height(); ++y)
            for (int x = 0; x < photo.width(); ++x)
                if (x % 40 < 12 && y % 40 < 12) photo(x, y) = Rgb(std::numeric_limits<float>::quiet_NaN());
        light.name = std::filesystem::path(light.name).replace_extension(".exr").string();
        write_picture(dir / light.name, photo, {});
    }
    write_lights(dir / "lights.lp", lights);
    Stack stack = open_stack(dir.path());
    const Registration r = register_stack(stack, {});
    EXPECT_EQ(r.photos.size(), lights.size());
    EXPECT_EQ(stack.photos.size(), lights.size());
    EXPECT_LE(shaken().rms_error_px(r), 0.3);
}

TEST(LocalContrast, IsUnknownWhereBrightnessIsAndNothingOfItBeside) {
    Image<float> even(60, 50, 0.4f);
    for (int y = 20; y < 30; ++y)
        for (int x = 25; x < 40; ++x) even(x, y) = std::numeric_limits<float>::quiet_NaN();
    const Image<float> contrast = local_contrast(even, 0.01);
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 60; ++x)
            if (std::isnan(even(x, y)))
                EXPECT_TRUE(std::isnan(contrast(x, y)));
            else
                EXPECT_NEAR(contrast(x, y), 0, 1e-5) << x << ", " << y;
    float value, dx, dy;
    EXPECT_TRUE(sample_at(contrast, {22.5, 25}, value, dx, dy));
    EXPECT_FALSE(sample_at(contrast, {23.5, 25}, value, dx, dy));
}

TP_LONG TEST(RegisterStack, FindsTheOnePhotographThatMoved) {
    const RegistrationScene scene(16, 0, 0);
    const RegistrationScene moved(16, 1.5, 0);
    std::filesystem::copy_file(moved.folder / "photo_004.png", scene.folder / "photo_004.png",
                               std::filesystem::copy_options::overwrite_existing);
    Stack stack = open_stack(scene.folder.path());
    const Registration r = register_stack(stack, {});
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(r.photos[i].warped, i == 4) << i;
    EXPECT_LE(moved.error_px(r.photos[4].homography, 4, 0), 0.15);
}

TP_LONG TEST(RegisterStack, RegistersHeldOutPhotographsWithoutTheirSay) {
    Stack all = open_stack(shaken().folder.path()), some = all;
    hold_out(some, "5:8");
    Stack only = some;
    only.held_out.clear();
    const Registration with = register_stack(some, {}), without = register_stack(only, {});
    ASSERT_EQ(with.held_out.size(), 3u);
    for (std::size_t i = 0; i < with.photos.size(); ++i)
        EXPECT_LT(
            rms_displacement(motion_of(glm::inverse(without.photos[i].homography) * with.photos[i].homography,
                                       shaken().frame)),
            0.02);
    EXPECT_LE(shaken().error_px(with.held_out[0].homography, 5, shaken().reference_of(with)), 0.3);
    EXPECT_TRUE(some.held_out[0].homography);
}

TP_LONG TEST(RegisterStack, IsTheSameOnAnyNumberOfThreads) {
    std::vector<Homography> first;
    for (const int threads : {1, 3, 0}) {
        set_thread_count(threads);
        Stack stack = open_stack(shaken().folder.path());
        const Registration r = register_stack(stack, {});
        for (std::size_t i = 0; i < r.photos.size(); ++i) {
            if (threads == 1) first.push_back(r.photos[i].homography);
            EXPECT_EQ(first[i], r.photos[i].homography) << i;
        }
    }
    set_thread_count(0);
}

Image<float> grey_of(const Image<Rgb>& image) {
    Image<float> grey(image.width(), image.height());
    for (std::size_t i = 0; i < grey.size(); ++i)
        grey.pixels()[i] = (image.pixels()[i].r + image.pixels()[i].g + image.pixels()[i].b) / 3;
    return grey;
}

TEST(RegisterPictures, RecoversAHomographyBetweenTwoPictures) {
    const GeneratorOptions options{.lights = 8, .held_out = 0, .min_elevation_deg = 50};
    const auto photos = photography_of(painting(), options).photos;
    const RegistrationScene& scene = still();  // for its frame
    const Homography truth = homography_of({4, -3, 2, 5, 1, 0.5, 0.6, -0.4}, scene.frame);
    const Image<Rgb> before = photographed(render_photo(painting(), photos[0].light, options), Homography(1));
    const Image<Rgb> after = photographed(render_photo(painting(), photos[1].light, options), truth);
    const PhotoDrift drift = register_pictures(grey_of(before), grey_of(after));
    const MotionVector error = motion_of(glm::inverse(truth) * drift.homography, scene.frame);
    std::cout << "[  FIGURE  ] two pictures registered to " << rms_displacement(error)
              << " px, standard error " << drift.error_px << " px\n";
    EXPECT_LE(rms_displacement(error), 0.1);
    EXPECT_LE(rms_displacement(error), 4 * drift.error_px);
}

TEST(RegisterPictures, FailsForTwoPaintings) {
    const Image<Rgb> one = photographed(
        render_photo(painting(), Light{.name = "", .direction = {0.3f, 0, 0.95f}}), Homography(1));
    EXPECT_THAT(error_of([&] { register_pictures(grey_of(one), grey_of(another_scene())); }),
                testing::HasSubstr("cannot be registered"));
}

TEST(StackReader, ResamplesRegisteredPhotographs) {
    Stack stack = open_stack(shaken().folder.path());
    stack.crop = {10, 20, 200, 150};
    for (std::size_t i = 0; i < stack.photos.size(); ++i)
        if (i % 2) stack.photos[i].homography = shaken().truth[i];
    StackReader whole(stack), in_bands(stack);
    const Band expected = whole.read(0, stack.height(), {});
    for (int y = 0; y < stack.height(); y += 17) {
        const Band band = in_bands.read(y, std::min(y + 17, stack.height()), {});
        for (int i = 0; i < band.photos(); ++i)
            for (int c = 0; c < 3; ++c)
                for (int row = y; row < band.y1(); ++row)
                    for (int x = 0; x < band.width(); ++x)
                        ASSERT_EQ(band.row(i, c, row)[x], expected.row(i, c, row)[x])
                            << i << " " << x << " " << row;
    }
    // Two photographs under neighbouring lights differ less where they are laid onto each other.
    stack.photos[1].homography.reset();
    StackReader unregistered(stack);
    const Band other = unregistered.read(0, stack.height(), {});
    double with = 0, without = 0;
    for (int y = 0; y < stack.height(); ++y)
        for (int x = 0; x < stack.width(); ++x) {
            with += std::abs(expected.row(1, 1, y)[x] - expected.row(0, 1, y)[x]);
            without += std::abs(other.row(1, 1, y)[x] - other.row(0, 1, y)[x]);
        }
    EXPECT_LT(with, without);
}

TEST(StackReader, MarksWhatAPhotographDoesNotReach) {
    Stack stack = open_stack(still().folder.path());
    stack.photos[2].homography = homography_of({5.25, -3, 0, 0}, MotionFrame(kWidth, kHeight));
    StackReader reader(stack);
    const Band band = reader.read(0, stack.height(), {});
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(std::isnan(band.row(2, 0, y)[x]), y < 3 || x > kWidth - 1 - 5.25) << x << " " << y;
}

}  // namespace
}  // namespace tangi
