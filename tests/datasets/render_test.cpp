// render_test.cpp: the radiometry of rendered photographs, their shadows and their sensor.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/generator.h"
#include "surface/base/parallel.h"
#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

PaintingTruth rendered_painting() {
    return procedural_painting({.width = 64, .height = 48, .brush_width_mm = 2, .crack_distance_mm = 3});
}

Light lit_from(const Vec3& direction, float gain = 1) {
    Light light = distant_light(direction);
    light.gain = Rgb(gain);
    return light;
}

TEST(RenderPhoto, ShowsAMattWhiteThatFacesTheLightAtTheWhiteLevel) {
    const PaintingTruth white(8, 6);
    const GeneratorOptions options{.reflectance = Reflectance::lambert, .white_level = 0.6};
    EXPECT_TRUE(
        images_near(render_photo(white, lit_from({0, 0, 1}), options), Image<Rgb>(8, 6, Rgb(0.6f)), 1e-6));
    const Vec3 slanted = glm::normalize(Vec3(1, 2, 3));
    EXPECT_TRUE(images_near(render_photo(white, lit_from(slanted, 1.5f), options),
                            Image<Rgb>(8, 6, Rgb(0.9f * slanted.z)), 1e-6));
}

TEST(BeamPart, IsHalfAtItsAngleFromTheAxis) {
    const Light light = near_light({0, 0, 500}, "a.png");
    const GeneratorOptions straight{.distance = 1, .beam_deg = 20};
    const float aside = 500 * static_cast<float>(std::tan(20 * kDegree));
    EXPECT_NEAR(beam_part(light, {0, 0, 0}, 500, straight), 1, 1e-12);
    EXPECT_NEAR(beam_part(light, {aside, 0, 0}, 500, straight), 0.5, 1e-6);
    EXPECT_NEAR(beam_part(light, {0, -aside, 0}, 500, straight), 0.5, 1e-6);
    EXPECT_EQ(beam_part(light, {aside, 0, 0}, 500, {.distance = 1}), 1);
    const GeneratorOptions aimed{.distance = 1, .beam_deg = 20, .aim_error = 0.3};
    const auto tilt = [&](const Light& l) { return beam_part(l, {aside, 0, 0}, 500, aimed); };
    EXPECT_NE(tilt(light), 0.5);
    EXPECT_NE(tilt(light), tilt(near_light({0, 0, 500}, "b.png"))) << "each light is aimed by itself";
    EXPECT_THROW(require_valid({.beam_deg = 20}), Error) << "a distant light has no beam";
}

TEST(RenderPhoto, MirrorsAsFresnelSaysWhereTheLightFacesAPolishedSurface) {
    PaintingTruth truth(3, 3);
    truth.diffuse = Image<Rgb>(3, 3, Rgb(0));
    truth.specular = Image<float>(3, 3, 0.04f);
    truth.roughness = Image<float>(3, 3, 0.2f);
    // At normal incidence pi f = pi F0 D(0) / 4 = F0 / (4 alpha^2).
    for (const Reflectance reflectance : {Reflectance::ggx, Reflectance::ward_bounded})
        EXPECT_NEAR(render_photo(truth, lit_from({0, 0, 1}), {.reflectance = reflectance})(1, 1).g,
                    0.75 * 0.04 / (4 * 0.2 * 0.2), 1e-4);
}

TEST(RenderPhoto, IsLinearInTheLight) {
    const PaintingTruth truth = rendered_painting();
    for (const Reflectance reflectance :
         {Reflectance::ggx, Reflectance::ward_bounded, Reflectance::lambert}) {
        const GeneratorOptions options{.reflectance = reflectance, .interreflection = 0.1};
        Image<Rgb> once = render_photo(truth, lit_from({1, 1, 1}), options);
        const Image<Rgb> thrice = render_photo(truth, lit_from({1, 1, 1}, 3), options);
        for (Rgb& value : once.pixels()) value *= 3;
        EXPECT_TRUE(images_near(thrice, once, 1e-5)) << name_of(reflectance);
    }
}

TEST(RenderPhoto, AgreesWithTheReferenceRendererOnTheWardModel) {
    const PaintingTruth truth = rendered_painting();
    const Light light = lit_from({-0.7f, 0.4f, 0.5f}, 1.3f);
    const GeneratorOptions options{
        .reflectance = Reflectance::ward_bounded, .ambient = 0.02, .white_level = 1};
    const Image<Rgb> expected =
        relight(surface_of(truth), std::span(&light, 1),
                {.cast_shadows = true, .light_radius_deg = options.light_radius_deg, .ambient = 0.02});
    EXPECT_TRUE(images_near(render_photo(truth, light, options), expected, 1e-5));
}

TEST(RenderPhoto, DoesNotDependOnTheNumberOfThreads) {
    const PaintingTruth truth = rendered_painting();
    set_thread_count(1);
    const Image<Rgb> one = apply_sensor(render_photo(truth, lit_from({1, -1, 1})), {}, 3);
    set_thread_count(2);
    const Image<Rgb> two = apply_sensor(render_photo(truth, lit_from({1, -1, 1})), {}, 3);
    set_thread_count(0);
    EXPECT_TRUE(images_identical(one, two));
}

// A wall 2 mm high along the left, light from the left: its shadow is height / tan(elevation) long.
TEST(RenderPhoto, CastsShadowsAsLongAsTheStepIsHigh) {
    constexpr int width = 200, edge = 40;
    PaintingTruth truth(width, 9, 0.1);
    for (int y = 0; y < truth.height(); ++y)
        for (int x = 0; x < edge; ++x) truth.height_mm(x, y) = 2;
    for (const double elevation : {15.0, 30.0, 50.0}) {
        const Vec3 direction(-std::cos(elevation * kDegree), 0, std::sin(elevation * kDegree));
        const Image<Rgb> photo = render_photo(truth, lit_from(direction), {.light_radius_deg = 0.05});
        int dark = 0;
        for (int x = edge; x < width; ++x) dark += photo(x, 4).g < 0.01f;
        EXPECT_NEAR(dark, 2 / std::tan(elevation * kDegree) / truth.mm_per_pixel, 1.0) << elevation;
    }
    const Image<Rgb> lit = render_photo(truth, lit_from({-1, 0, 0.3f}), {.cast_shadows = false});
    EXPECT_GT(lit(edge, 4).g, 0.1f);
}

// At a flat pixel d away from a light h above the centre: inverse square (h/d)^2, cosine h/d.
TEST(RenderPhoto, FallsOffWithTheInverseSquareOfTheDistanceToANearLight) {
    const PaintingTruth white(101, 101, 1);
    const Light light = near_light({0, 0, 80});
    const Image<Rgb> photo =
        render_photo(white, light, {.reflectance = Reflectance::lambert, .white_level = 1});
    EXPECT_NEAR(photo(50, 50).g, 1, 1e-6);
    for (const int x : {0, 20, 77, 100}) {
        const double d = std::hypot(x - 50.0, 80.0);
        EXPECT_NEAR(photo(x, 50).g, std::pow(80 / d, 3), 1e-5);
    }
}

TEST(RenderPhoto, ShinesWithoutLightByItsAmbientPart) {
    PaintingTruth truth(4, 4);
    truth.normal = Image<Vec3>(4, 4, glm::normalize(Vec3(-1, 0, 0.2f)));
    const GeneratorOptions options{.ambient = 0.1, .interreflection = 0.2, .white_level = 0.5};
    const Light light = lit_from({0.8f, 0, 0.6f}, 2);  // behind the slope
    EXPECT_NEAR(render_photo(truth, light, options)(2, 2).g, 0.5 * (0.1 + 0.2 * 2 * 0.6), 1e-6);
}

struct Moments {
    double mean = 0, variance = 0;
};

Moments moments(const Image<Rgb>& picture) {
    double sum = 0, squares = 0;
    const double count = 3 * static_cast<double>(picture.size());
    for (const Rgb& value : picture.pixels())
        for (int c = 0; c < 3; ++c) sum += value[c];
    for (const Rgb& value : picture.pixels())
        for (int c = 0; c < 3; ++c) squares += std::pow(value[c] - sum / count, 2);
    return {sum / count, squares / count};
}

// 3 * 200 * 200 samples: the mean is known to sigma / sqrt(n), the variance to a part of sqrt(2 / n).
TEST(ApplySensor, AddsTheNoiseThatItsElectronsHave) {
    const GeneratorOptions options{.full_well_electrons = 8000, .read_noise_electrons = 12};
    const double count = 3 * 200 * 200;
    for (const float level : {0.05f, 0.3f, 0.8f}) {
        const Moments m = moments(apply_sensor(Image<Rgb>(200, 200, Rgb(level)), options, 0));
        const double step = 1.0 / 4095;
        const double expected = (level * 8000 + 12 * 12) / (8000.0 * 8000) + step * step / 12;
        EXPECT_NEAR(m.mean, level, 4 * std::sqrt(expected / count)) << level;
        EXPECT_NEAR(m.variance / expected, 1, 4 * std::sqrt(2 / count)) << level;
    }
}

TEST(ApplySensor, HasOtherNoiseInEachPhotographAndForEachSeed) {
    const Image<Rgb> grey(32, 32, Rgb(0.4f));
    EXPECT_TRUE(images_identical(apply_sensor(grey, {}, 0), apply_sensor(grey, {}, 0)));
    EXPECT_FALSE(images_identical(apply_sensor(grey, {}, 0), apply_sensor(grey, {}, 1)));
    EXPECT_FALSE(images_identical(apply_sensor(grey, {}, 0), apply_sensor(grey, {.seed = 2}, 0)));
}

TEST(ApplySensor, ClipsAndQuantises) {
    const Image<Rgb> bright = apply_sensor(Image<Rgb>(16, 16, Rgb(3)), {.adc_bits = 8}, 0);
    EXPECT_TRUE(images_identical(bright, Image<Rgb>(16, 16, Rgb(1))));
    const Image<Rgb> grey = apply_sensor(Image<Rgb>(16, 16, Rgb(0.5f)), {.adc_bits = 8}, 0);
    for (const Rgb& value : grey.pixels()) ASSERT_NEAR(value.g * 255, std::round(value.g * 255), 1e-4);
}

TEST(ApplySensor, LeavesLightAloneWhereThereIsNoSensor) {
    const Image<Rgb> bright(16, 16, Rgb(3.14159f));
    EXPECT_TRUE(images_identical(apply_sensor(bright, {.sensor_noise = false}, 0), bright));
}

}  // namespace
}  // namespace tangi
