// uncalibrated_test.cpp: lights of which nothing is written down.
#include "capture/uncalibrated/uncalibrated.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <numbers>

#include "capture/stack/grey_photos.h"
#include "capture/stack/stack.h"
#include "datasets/generator.h"
#include "surface/base/median.h"
#include "tests/support/long_test.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

double mean_error_deg(const std::vector<glm::dvec3>& found, const std::vector<glm::dvec3>& right) {
    double sum = 0;
    for (std::size_t i = 0; i < found.size(); ++i) sum += angle_deg(found[i], right[i]);
    return sum / static_cast<double>(found.size());
}

// The lights as if hills were valleys.
std::vector<glm::dvec3> mirrored(std::vector<glm::dvec3> directions) {
    for (glm::dvec3& d : directions) d = {-d.x, -d.y, d.z};
    return directions;
}

std::string told(const UncalibratedLights& u) {
    return fmt::format(
        "strengths differ by {:.3f}, residual {:.4f}, explained {:.3f}, curl {:.3f}, falloff {:.2f}, "
        "convexity {:.2f}",
        u.strength_scatter, u.residual, u.explained, u.curl, u.falloff, u.convexity);
}

struct Rendered {
    std::vector<Image<float>> pictures;
    std::vector<glm::dvec3> directions;
};

Rendered rendered(GeneratorOptions options, std::uint64_t seed = 5) {
    options.held_out = 0;
    const PaintingTruth painting =
        procedural_painting({.seed = seed, .width = 80, .height = 80, .mm_per_pixel = 0.4});
    const Photography photography = photography_of(painting, options);
    Rendered result;
    int number = 0;
    for (const Photography::Photo& photo : photography.photos) {
        const Image<Rgb> linear =
            apply_sensor(render_photo(painting, photo.light, options), options, number++);
        Image<float>& picture = result.pictures.emplace_back(linear.width(), linear.height());
        for (std::size_t i = 0; i < picture.size(); ++i) {
            const Rgb& value = linear.pixels()[i];
            picture.pixels()[i] = (value.r + value.g + value.b) / 3;
        }
        result.directions.emplace_back(photo.light.direction);
    }
    return result;
}

TP_LONG TEST(Uncalibrated, LightsOfAGeneratedPaintingAreFound) {
    for (const Reflectance reflectance : {Reflectance::lambert, Reflectance::ggx}) {
        const Rendered r = rendered({.lights = 32, .reflectance = reflectance});
        const UncalibratedLights u = uncalibrated_lights(r.pictures, 0.99f);
        const double error = mean_error_deg(u.directions, r.directions);
        const double other = mean_error_deg(mirrored(u.directions), r.directions);
        std::cout << fmt::format("{}: {:.2f} deg, mirrored {:.2f}; {}\n", name_of(reflectance), error, other,
                                 told(u));
        EXPECT_LE(error, reflectance == Reflectance::lambert ? 1.5 : 4);
    }
}

TP_LONG TEST(Uncalibrated, NearLightsOfDifferentStrength) {
    const Rendered r = rendered({.lights = 32, .distance = 2, .gain_min = 0.7, .gain_max = 1.4});
    const UncalibratedLights u = uncalibrated_lights(r.pictures, 0.99f);
    const double error = mean_error_deg(u.directions, r.directions);
    const double other = mean_error_deg(mirrored(u.directions), r.directions);
    std::cout << fmt::format("{:.2f} deg, mirrored {:.2f}; {}\n", error, other, told(u));
    EXPECT_LE(error, 11);
    EXPECT_GE(u.falloff, 0.9);
}

// Lights of paintings that are matt or glossy, under lights that are near, or of unlike strength.
TP_LONG TEST(Uncalibrated, StatedErrorsCoverTheTruth) {
    int within = 0, all = 0;
    double squares = 0;
    const auto count = [&](const GeneratorOptions& options, std::uint64_t seed) {
        const Rendered r = rendered(options, seed);
        const UncalibratedLights u = uncalibrated_lights(r.pictures, 0.99f);
        const auto other = mirrored(u.directions);
        const bool reading = mean_error_deg(u.directions, r.directions) < mean_error_deg(other, r.directions);
        for (std::size_t i = 0; i < r.directions.size(); ++i) {
            const double ratio =
                angle_deg(reading ? u.directions[i] : other[i], r.directions[i]) / u.sigma_deg[i];
            within += ratio < 2;
            squares += ratio * ratio;
            ++all;
        }
    };
    count({.lights = 24}, 6);
    count({.lights = 24, .min_elevation_deg = 15, .ambient = 0.03}, 8);
    count({.lights = 24, .gain_min = 0.85, .gain_max = 1.2}, 10);
    count({.lights = 24, .distance = 2}, 5);
    std::cout << fmt::format(
        "[  FIGURE  ] {} of {} lights within two of their stated errors, rms {:.2f} of them\n", within, all,
        std::sqrt(squares / all));
    EXPECT_GE(within, 0.85 * all);
    EXPECT_GE(std::sqrt(squares / all), 0.3);  // nor are they much too large
}

TEST(Uncalibrated, TheOtherReadingIsTheMirrorImage) {
    const Rendered r = rendered({.lights = 16});
    const UncalibratedLights one = uncalibrated_lights(r.pictures, 0.99f);
    const UncalibratedLights other = uncalibrated_lights(r.pictures, 0.99f, {.inverted = true});
    EXPECT_LE(mean_error_deg(mirrored(one.directions), other.directions), 1e-6);
    for (std::size_t i = 0; i < one.slopes.size(); ++i)
        EXPECT_EQ(one.slopes.pixels()[i], -other.slopes.pixels()[i]);
    EXPECT_GE(one.convexity, 0);
    EXPECT_EQ(other.convexity, -one.convexity);
}

TEST(Uncalibrated, OfTooLittleIsAnError) {
    const std::vector<Image<float>> few(7, Image<float>(32, 32, 0.5f));
    EXPECT_THAT(error_of([&] { uncalibrated_lights(few, 0.99f); }), testing::HasSubstr("at least 8"));
    const std::vector<Image<float>> flat(9, Image<float>(32, 32, 0.5f));
    EXPECT_THAT(error_of([&] { uncalibrated_lights(flat, 0.99f); }), testing::HasSubstr("no relief"));
    const std::vector<Image<float>> black(9, Image<float>(32, 32, 0));
    EXPECT_THAT(error_of([&] { uncalibrated_lights(black, 0.99f); }), testing::HasSubstr("can't be told"));
    const std::vector<Image<float>> tiny(9, Image<float>(8, 8, 0.5f));
    EXPECT_THAT(error_of([&] { uncalibrated_lights(tiny, 0.99f); }), testing::HasSubstr("too small"));
}

// What the object's gloss or colour hides is found to be doubtful: `worst_deg` is empty there.
TEST(DataUncalibrated, DirectionsOfRealStacksAreFoundOrCalledDoubtful) {
    TP_DATA(real, "real");
    struct Expected {
        const char* name;
        std::optional<double> worst_deg;
        Transfer transfer{};
    };
    const Transfer gamma = *transfer_named("2.2");
    const std::vector<Expected> stacks = {{"real/fresco", 9},
                                          {"real/leaf", 18},
                                          {"real/coin", 12},
                                          {"synth_canvas/uniform_1/Dome", 22, gamma},
                                          {"impasto/png16", 11},
                                          {"real/door", {}},
                                          {"real/icon", {}, gamma},
                                          {"real/canvas", {}},
                                          {"synth_canvas/varied_5/Dome", {}, gamma}};
    for (const Expected& expected : stacks) {
        const Stack stack = open_stack(real.parent_path() / expected.name);
        std::vector<std::filesystem::path> paths;
        std::vector<glm::dvec3> listed;
        for (const StackPhoto& photo : stack.photos) {
            paths.push_back(photo.path);
            listed.emplace_back(photo.light.direction);
        }
        std::vector<Image<float>> pictures = read_grey_photos(paths, {}, paths.size() * 128 * 128).mean;
        for (Image<float>& picture : pictures)
            for (float& value : picture.pixels()) value = expected.transfer.decode(value);
        const UncalibratedLights u = uncalibrated_lights(pictures, expected.transfer.decode(0.99f));
        const double error = mean_error_deg(u.directions, listed);
        const double other = mean_error_deg(mirrored(u.directions), listed);
        std::cout << fmt::format("[  FIGURE  ] {}: {:.1f} deg, mirrored {:.1f}, stated {:.1f}; {}\n",
                                 expected.name, error, other, median(u.sigma_deg), told(u));
        const double sigma_deg = median(u.sigma_deg);
        EXPECT_LE(std::min(error, other), 3 * sigma_deg) << expected.name;
        if (expected.worst_deg)
            EXPECT_LE(std::min(error, other), *expected.worst_deg) << expected.name;
        else
            EXPECT_FALSE(u.warnings.empty()) << expected.name;
    }
}

}  // namespace
}  // namespace tangi
