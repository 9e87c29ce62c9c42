// capture_registration_test.cpp: known motions of the camera are found again under moving lights, none are
// found where there are none, and photographs that cannot be registered are named.
#include "capture/registration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iostream>

#include "datasets/generator.h"
#include "surface/parallel.h"
#include "tests/test_support.h"

namespace tangi {
namespace {

constexpr int kWidth = 240, kHeight = 200, kBorder = 12;

// A painting, larger than its photographs, rendered twice as fine.
PaintingTruth painted(std::uint64_t seed) {
    return procedural_painting({.seed = seed,
                                .width = 2 * (kWidth + 2 * kBorder),
                                .height = 2 * (kHeight + 2 * kBorder),
                                .mm_per_pixel = 0.2,
                                .supersampling = 1});
}

const PaintingTruth& painting() {
    static const PaintingTruth truth = painted(5);
    return truth;
}

float bilinear(const Image<Rgb>& image, double x, double y, int c) {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
    return (1 - fy) * ((1 - fx) * image.clamped(ix, iy)[c] + fx * image.clamped(ix + 1, iy)[c]) +
           fy * ((1 - fx) * image.clamped(ix, iy + 1)[c] + fx * image.clamped(ix + 1, iy + 1)[c]);
}

// What a camera sees that moved by h: 4 x 4 samples a pixel.
Image<Rgb> photographed(const Image<Rgb>& fine, const Homography& h) {
    Image<Rgb> photo(kWidth, kHeight);
    const Homography back = glm::inverse(h);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            Rgb sum(0);
            for (double dy : {-0.375, -0.125, 0.125, 0.375})
                for (double dx : {-0.375, -0.125, 0.125, 0.375}) {
                    const glm::dvec2 p = mapped(back, {x + dx, y + dy});
                    for (int c = 0; c < 3; ++c)
                        sum[c] += bilinear(fine, 2 * (p.x + kBorder) + 0.5, 2 * (p.y + kBorder) + 0.5, c);
                }
            photo(x, y) = sum / 16.0f;
        }
    return photo;
}

MotionVector jitter(int photo, double shift_px, double turn_px) {
    if (photo == 0) return {};
    // Without a pattern that lights might have as well.
    const auto number = [&](int k) {
        const double v = std::sin(12.9898 * photo + 78.233 * k) * 43758.5453;
        return 2 * (v - std::floor(v)) - 1;
    };
    return {shift_px * number(1), shift_px * number(2), 0, turn_px * number(3)};
}

struct Scene {
    TestDir folder;
    std::vector<Homography> truth;
    MotionFrame frame{kWidth, kHeight};

    Scene(int lights, double shift_px, double turn_px, const PaintingTruth& of = painting(),
          double lowest_deg = 25) {
        const GeneratorOptions options{.lights = lights, .held_out = 0, .min_elevation_deg = lowest_deg};
        const Photography photography = photography_of(of, options);
        std::vector<Light> listed;
        for (int i = 0; i < lights; ++i) {
            const Light& light = photography.photos[static_cast<std::size_t>(i)].light;
            truth.push_back(homography_of(jitter(i, shift_px, turn_px), frame));
            const Image<Rgb> photo = photographed(render_photo(of, light, options), truth.back());
            listed.push_back(light);
            listed.back().name = fmt::format("photo_{:03d}.png", i);
            write_picture(folder / listed.back().name, apply_sensor(photo, options, i), {}, {.bits = 16});
        }
        write_lights(folder / "lights.lp", listed);
    }

    // [pixels] over the picture.
    double error_px(const Homography& found, std::size_t photo) const {
        double sum = 0, count = 0;
        for (double y = 0; y <= 1; y += 0.1)
            for (double x = 0; x <= 1; x += 0.1, count += 1) {
                const glm::dvec2 p(x * kWidth, y * kHeight);
                const glm::dvec2 d = mapped(found, p) - mapped(truth[photo], p);
                sum += glm::dot(d, d);
            }
        return std::sqrt(sum / count);
    }

    // [pixels] At the centre, after the mean of all photographs.
    double rms_jitter_px(const Registration& registration) const {
        std::vector<glm::dvec2> errors;
        glm::dvec2 mean(0);
        for (std::size_t i = 0; i < registration.photos.size(); ++i) {
            errors.push_back(mapped(registration.photos[i].homography, frame.centre) -
                             mapped(truth[i], frame.centre));
            mean += errors.back() / static_cast<double>(registration.photos.size());
        }
        double sum = 0;
        for (const glm::dvec2& e : errors) sum += glm::dot(e - mean, e - mean);
        return std::sqrt(sum / static_cast<double>(errors.size()));
    }

    double rms_error_px(const Registration& registration) const {
        double sum = 0;
        for (std::size_t i = 0; i < registration.photos.size(); ++i) {
            const double e = error_px(registration.photos[i].homography, i);
            sum += e * e;
        }
        return std::sqrt(sum / static_cast<double>(registration.photos.size()));
    }
};

const Scene& shaken() {
    static const Scene scene(24, 1.5, 0.4);
    return scene;
}

const Scene& still() {
    static const Scene scene(24, 0, 0);
    return scene;
}

TEST(RegisterStack, RecoversShiftsAndTurnsUnderMovingLights) {
    Stack stack = open_stack(shaken().folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_TRUE(r.moved);
    EXPECT_EQ(r.reference, "photo_000.png");
    // The reference's own error moves all photographs alike, which blurs nothing.
    const double error = shaken().rms_error_px(r), jitter_left = shaken().rms_jitter_px(r);
    std::cout << "[  FIGURE  ] generated stack registered to " << error << " px rms of the reference, to "
              << jitter_left << " px rms of each other\n";
    EXPECT_LE(error, 0.15);
    EXPECT_LE(jitter_left, 0.1);
    EXPECT_FALSE(stack.photos[0].homography);
    ASSERT_EQ(stack.photos.size(), 24u);
    for (std::size_t i = 1; i < 24; ++i) {
        ASSERT_TRUE(r.photos[i].registered) << i;
        ASSERT_EQ(r.photos[i].warped, stack.photos[i].homography.has_value()) << i;
        if (r.photos[i].warped) {
            EXPECT_EQ(*stack.photos[i].homography, r.photos[i].homography);
        }
        EXPECT_LT(shaken().error_px(r.photos[i].homography, i), 5 * r.photos[i].error_px) << i;
    }
}

// Of all photographs of stacks that moved by little and by much.
TEST(RegisterStack, StatedErrorsCoverTheTruth) {
    int within1 = 0, within2 = 0, all = 0;
    double squares = 0;
    const auto count = [&](const Scene& scene) {
        Stack stack = open_stack(scene.folder.path());
        const Registration r = register_stack(stack, {});
        for (std::size_t i = 1; i < r.photos.size(); ++i) {
            if (!r.photos[i].registered) continue;
            const double ratio = scene.error_px(r.photos[i].homography, i) / r.photos[i].error_px;
            within1 += ratio < 1;
            within2 += ratio < 2;
            squares += ratio * ratio;
            ++all;
        }
    };
    count(shaken());
    count(Scene(16, 0.6, 0.3, painted(12), 15));
    count(Scene(12, 3, 0.8, painted(23), 35));
    std::cout << fmt::format(
        "[  FIGURE  ] errors within 1 and 2 of those stated: {} and {} of {}, rms {:.2f}\n", within1, within2,
        all, std::sqrt(squares / all));
    EXPECT_GE(within2, 0.85 * all);
    EXPECT_LE(std::sqrt(squares / all), 1.5);
    EXPECT_GE(std::sqrt(squares / all), 0.5);  // nor are they much too large
}

TEST(RegisterStack, RecoversShiftsOfManyPixels) {
    const Scene scene(24, 8, 0);
    Stack stack = open_stack(scene.folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_LE(scene.rms_error_px(r), 0.15);
    EXPECT_LE(scene.rms_jitter_px(r), 0.1);
}

TEST(RegisterStack, FindsNoMotionWhereThereIsNone) {
    Stack stack = open_stack(still().folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_FALSE(r.moved);
    EXPECT_LT(r.typical_drift_px, 0.05);
    EXPECT_THAT(stack.warnings, testing::IsEmpty());
    ASSERT_EQ(stack.photos.size(), 24u);
    for (const StackPhoto& photo : stack.photos) EXPECT_FALSE(photo.homography);
}

TEST(RegisterStack, FindsTheOnePhotographThatMoved) {
    const Scene scene(16, 0, 0);
    const Scene moved(16, 1.5, 0);
    std::filesystem::copy_file(moved.folder / "photo_004.png", scene.folder / "photo_004.png",
                               std::filesystem::copy_options::overwrite_existing);
    Stack stack = open_stack(scene.folder.path());
    const Registration r = register_stack(stack, {});
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(r.photos[i].warped, i == 4) << i;
    EXPECT_LE(moved.error_px(r.photos[4].homography, 4), 0.15);
}

TEST(RegisterStack, RegistersHeldOutPhotographsWithoutTheirSay) {
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
    EXPECT_LE(shaken().error_px(with.held_out[0].homography, 5), 0.3);
    EXPECT_TRUE(some.held_out[0].homography);
}

TEST(RegisterStack, IsTheSameOnAnyNumberOfThreads) {
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

// A stack of 12 in which these photographs are replaced.
std::string warnings_with(const std::vector<int>& replaced, const Image<Rgb>& by, std::size_t& left) {
    const Scene scene(12, 1, 0);
    for (const int i : replaced)
        write_picture(scene.folder / fmt::format("photo_{:03d}.png", i), by, {}, {.bits = 16});
    Stack stack = open_stack(scene.folder.path());
    register_stack(stack, {});
    left = stack.photos.size();
    std::string all;
    for (const std::string& warning : stack.warnings) all += warning;
    return all;
}

Image<Rgb> another_scene() {
    const PaintingTruth truth =
        procedural_painting({.seed = 99, .width = kWidth, .height = kHeight, .mm_per_pixel = 0.4});
    const GeneratorOptions options{.lights = 4, .held_out = 0};
    return render_photo(truth, photography_of(truth, options).photos[1].light, options);
}

TEST(RegisterStack, NamesABlackPhotographAndGoesOn) {
    std::size_t left = 0;
    EXPECT_THAT(warnings_with({4}, Image<Rgb>(kWidth, kHeight, Rgb(0)), left),
                testing::AllOf(testing::HasSubstr("photo_004.png"), testing::HasSubstr("left out 1")));
    EXPECT_EQ(left, 11u);
}

TEST(RegisterStack, NamesAPhotographOfSomethingElseAndGoesOn) {
    std::size_t left = 0;
    EXPECT_THAT(warnings_with({6}, another_scene(), left), testing::HasSubstr("photo_006.png"));
    EXPECT_EQ(left, 11u);
}

// Wherever it is in the tree of lamps: the others are not led astray by it, and it is nobody's reference.
// Where it stands decides what the first reference is, and what its neighbours are compared with.
class AForeignPhotograph : public testing::TestWithParam<std::pair<int, bool>> {};

TEST_P(AForeignPhotograph, MovesNoOther) {
    const auto [foreign, moves] = GetParam();
    const Scene scene(24, moves ? 1.5 : 0, 0);
    const std::string name = fmt::format("photo_{:03d}.png", foreign);
    write_picture(scene.folder / name, another_scene(), {}, {.bits = 16});
    Stack stack = open_stack(scene.folder.path());
    const Registration r = register_stack(stack, {});
    EXPECT_EQ(r.moved, moves);
    EXPECT_EQ(r.reference, foreign == 0 ? "photo_001.png" : "photo_000.png");
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

TEST(RegisterStack, FailsWhereTooFewShowTheSame) {
    const Scene scene(5, 1, 0);
    for (const int i : {1, 2, 3})
        write_picture(scene.folder / fmt::format("photo_{:03d}.png", i), Image<Rgb>(kWidth, kHeight, Rgb(0)),
                      {}, {.bits = 16});
    Stack stack = open_stack(scene.folder.path());
    EXPECT_THAT(error_of([&] { register_stack(stack, {}); }),
                testing::AllOf(testing::HasSubstr("photo_001.png"), testing::HasSubstr("--register off")));
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
    const Scene& scene = still();  // for its frame
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

void expect_still(const char* name, double most_px) {
    TP_DATA(folder, name);
    Stack stack = open_stack(folder);
    const std::size_t photos = stack.photos.size();
    const Registration r = register_stack(stack, {});
    std::cout << "[  FIGURE  ] " << name << ": typical drift " << r.typical_drift_px << " px\n";
    EXPECT_FALSE(r.moved) << name;
    EXPECT_LE(r.typical_drift_px, most_px) << name;
    EXPECT_EQ(stack.photos.size(), photos) << name;
    for (const StackPhoto& photo : stack.photos) EXPECT_FALSE(photo.homography) << photo.light.name;
}

TEST(DataRegistration, FindsNoMotionInFresco) { expect_still("real/fresco", 0.1); }
TEST(DataRegistration, FindsNoMotionInIcon) { expect_still("real/icon", 0.1); }
TEST(DataRegistration, FindsNoMotionInLeaf) { expect_still("real/leaf", 0.1); }
TEST(DataRegistration, FindsNoMotionInImpasto) { expect_still("impasto/png16", 0.05); }
// Metal: highlights are most of what there is to see.
TEST(DataRegistration, FindsNoMotionInCoin) { expect_still("real/coin", 0.4); }

TEST(DataRegistration, HandheldIsRegisteredToWithin0_15Pixels) {
    TP_DATA(folder, "handheld");
    Stack stack = open_stack(folder / "png16");
    const Registration r = register_stack(stack, {});
    std::ifstream file(folder / "gt/cameras.json");
    const auto cameras = nlohmann::json::parse(file);
    ASSERT_EQ(r.photos.size(), cameras.size());
    const glm::dvec2 centre(351.5 - 17 / 0.4261, 263.5);  // of the painting, which is 200 mm wide
    const double half = 100 / 0.4261;
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < r.photos.size(); ++i) {
        const auto& rows = cameras[i].at("H_image_to_reference_z0");
        Homography to_reference(1);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                to_reference[column][row] =
                    rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
        for (double y = -1; y <= 1; y += 0.1)
            for (double x = -1; x <= 1; x += 0.1, count += 1) {
                const glm::dvec2 p = centre + half * glm::dvec2(x, y);
                const glm::dvec2 d = mapped(to_reference, mapped(r.photos[i].homography, p)) - p;
                sum += glm::dot(d, d);
            }
    }
    const double rms = std::sqrt(sum / count);
    std::cout << "[  FIGURE  ] handheld: jitter after registration " << rms << " px rms\n";
    EXPECT_LE(rms, 0.15);
}

}  // namespace
}  // namespace tangi
