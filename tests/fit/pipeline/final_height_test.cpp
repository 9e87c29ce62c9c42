// final_height_test.cpp: shadows in photographs say how steep relief is between its pixels.
#include "fit/pipeline/final_height.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "fit/height/subpixel_slopes.h"
#include "fit/shadows/light_angular_radius.h"
#include "surface/render/cast_shadows.h"
#include "surface/render/relight.h"
#include "tests/support/fit/fit_test_support.h"

namespace tangi {
namespace {

constexpr int kSide = 96;

// Hills of all directions, matt and grey, as a fit finds their normals.
Surface hills() {
    Random random(7);
    Surface s(kSide, kSide);
    struct Wave {
        double kx, ky, phase;
    };
    std::vector<Wave> waves;
    for (int i = 0; i < 20; ++i) {
        const double k = random.uniform(0.2, 0.7), turn = random.uniform(0, 2 * std::numbers::pi);
        waves.push_back({k * std::cos(turn), k * std::sin(turn), random.uniform(0, 6.28)});
    }
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            glm::dvec2 slope(0);
            for (const Wave& wave : waves)
                slope += 0.2 * std::cos(wave.kx * x - wave.ky * y + wave.phase) *
                         glm::normalize(glm::dvec2(wave.kx, wave.ky));
            s.normal(x, y) = normal_of({static_cast<float>(slope.x), static_cast<float>(slope.y)});
            s.diffuse(x, y) = Rgb(0.5f);
            s.confidence(x, y) = 0.99f;
        }
    return s;
}

// What photographs of relief with these normals and this height show, at every other pixel.
Survey photographed(const Surface& surface, const Image<float>& height_mm, const std::vector<Light>& lights,
                    double radius_deg = Rig::kPointLight_deg) {
    Survey survey;
    survey.channels = 1;
    survey.photos.resize(lights.size());
    const CastShadows shadows(height_mm, surface.mm_per_pixel, radius_deg);
    for (int y = 0; y < kSide; y += 2)
        for (int x = 0; x < kSide; x += 2) {
            survey.positions.emplace_back(x, y);
            for (const Light& light : lights)
                survey.values.push_back(0.5f *
                                        std::max(glm::dot(surface.normal(x, y), light.direction), 0.0f) *
                                        shadows.visible_part(x, y, light.direction));
        }
    return survey;
}

std::vector<Light> ring(double elevation_deg) {
    std::vector<Light> lights;
    for (int i = 0; i < 8; ++i) {
        const double azimuth = i * std::numbers::pi / 4, e = elevation_deg * std::numbers::pi / 180;
        lights.push_back(distant_light(
            Vec3(std::cos(azimuth) * std::cos(e), std::sin(azimuth) * std::cos(e), std::sin(e))));
    }
    return lights;
}

constexpr HeightOptions kNoCliffs{.robust_sweeps = 0};

Image<float> height_with(const Surface& surface, double mixing) {
    Image<float> z;
    integrate_normals(
        {mixing > 0 ? steepened_normals(surface.normal, surface.confidence, mixing) : surface.normal,
         surface.confidence, surface.mm_per_pixel},
        z, kNoCliffs);
    subtract(best_plane(z, surface.confidence), z);
    return z;
}

FinalHeight found(Surface& surface, const Image<float>& height_mm, const std::vector<Light>& lights,
                  const HeightEvidence& evidence = {.shadows_tell = true}, const Progress& progress = {}) {
    return final_height(surface,
                        {photographed(surface, height_mm, lights), {}, {.lights = lights, .rig = {}}},
                        kNoCliffs, evidence, nullptr, progress);
}

TEST(FinalHeight, ShadowsSayWhetherSlopesAreSteeperThanTheyLook) {
    Surface surface = hills();
    const Image<float> plain = height_with(surface, 0);
    for (const double mixing : {0.0, 0.2, 0.4, 0.8}) {
        const Image<float> truth = height_with(surface, mixing);
        const FinalHeight result = found(surface, truth, ring(25));
        EXPECT_EQ(result.choice.mixing, mixing);
        EXPECT_TRUE(result.report.converged);
        EXPECT_LT(rms_difference(surface.height_mm, truth), 0.01) << mixing;
        EXPECT_GE(rms_difference(plain, truth), mixing > 0 ? 0.03 : 0) << mixing;
    }
}

TEST(FinalHeight, WithoutShadowsSlopesAreTakenAsTheyAre) {
    Surface surface = hills();
    const Image<float> steep = height_with(surface, 0.8);
    EXPECT_EQ(found(surface, steep, ring(80)).choice.mixing, 0);
    EXPECT_LT(rms_difference(surface.height_mm, height_with(surface, 0)), 1e-6);
    // Nor where the photographs are not explained.
    EXPECT_EQ(found(surface, steep, ring(25), {}).choice.mixing, 0);
}

// Half of it may be too much.
TEST(FinalHeight, ItsErrorSaysThatHowSteepSlopesAreIsRoughlyKnown) {
    Surface surface = hills();
    Image<HalfError> errors, alone;
    final_height(
        surface,
        {photographed(surface, height_with(surface, 0.8), ring(25)), {}, {.lights = ring(25), .rig = {}}},
        kNoCliffs, {.shadows_tell = true}, &errors, {});
    Image<float> z;
    integrate_normals({steepened_normals(surface.normal, surface.confidence, 0.8), surface.confidence,
                       surface.mm_per_pixel},
                      z, kNoCliffs, {}, {.error_mm = &alone});
    const double off = rms_difference(height_with(surface, 0.8), height_with(surface, 0.4));
    double sum = 0, expected = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        sum += std::pow(errors.pixels()[i], 2) / static_cast<double>(errors.size());
        expected += std::pow(alone.pixels()[i], 2) / static_cast<double>(errors.size());
    }
    EXPECT_NEAR(std::sqrt(sum - expected), off, 0.2 * off);
}

TEST(FinalHeight, TellsWhatItTriedAndThatItIsDone) {
    Surface surface = hills();
    const Image<float> truth = height_with(surface, 0.2);
    double tried = 0;
    const FinalHeight result =
        found(surface, truth, ring(25), {.shadows_tell = true}, [&](std::string_view stage, double done) {
            if (stage == "cliffs") {
                EXPECT_GE(done, tried);
                tried = done;
            }
            return true;
        });
    EXPECT_EQ(tried, 1);  // though 0.8 was not tried
    const nlohmann::json written = to_json(result.choice);
    EXPECT_EQ(written["cliffs"], false);
    EXPECT_EQ(written["subpixel_slope_bias"], 0.2);
    ASSERT_EQ(written["tried"].size(), 3u);
    EXPECT_EQ(written["tried"][2]["subpixel_slope_bias"], 0.4);
    EXPECT_LT(written["tried"][1]["shadow_misfit"], written["tried"][0]["shadow_misfit"]);
    EXPECT_LT(written["tried"][1]["shadow_misfit"], written["tried"][2]["shadow_misfit"]);
}

// A plateau whose walls no slope shows: only the height that the second pass had throws its shadow.
TEST(FinalHeight, IsThatBeforeRefiningWhereOnlyItCastsTheShadows) {
    for (const bool shadows_tell : {false, true}) {
        Surface flat(kSide, kSide);
        for (Rgb& diffuse : flat.diffuse.pixels()) diffuse = Rgb(0.5f);
        for (float& confidence : flat.confidence.pixels()) confidence = 0.99f;
        Image<float> plateau(kSide, kSide);
        for (int y = 30; y < 60; ++y)
            for (int x = 30; x < 60; ++x) plateau(x, y) = 4;
        subtract(best_plane(plateau, flat.confidence), plateau);
        const HeightEvidence evidence{.shadows_tell = shadows_tell, .refined = true};
        Surface surface = flat;
        surface.height_mm = plateau;
        const FinalHeight kept = found(surface, plateau, ring(25), evidence);
        EXPECT_TRUE(kept.choice.before_refining);
        EXPECT_EQ(rms_difference(surface.height_mm, plateau), 0);
        EXPECT_EQ(to_json(kept.choice)["tried"].back()["before_refining"], true);
        // Photographs without that shadow do not believe in it.
        surface = flat;
        surface.height_mm = plateau;
        EXPECT_FALSE(found(surface, Image<float>(kSide, kSide), ring(25), evidence).choice.before_refining);
        EXPECT_LT(rms_difference(surface.height_mm, Image<float>(kSide, kSide)), 1e-6);
    }
}

double found_radius_deg(double radius_deg, double elevation_deg, float higher = 1) {
    Surface surface = hills();
    surface.height_mm = height_with(surface, 0);
    const std::vector<Light> lights = ring(elevation_deg);
    const Survey survey = photographed(surface, surface.height_mm, lights, radius_deg);
    for (float& z : surface.height_mm.pixels()) z *= higher;
    return find_light_angular_radius(surface, {survey, {}, {.lights = lights, .rig = {}}}).deg;
}

TEST(LightAngularRadius, IsThatOfTheLightsWhoseShadowsAreSeen) {
    for (const double deg : {1.5, 2.0, 3.0, 4.0, 5.0})
        EXPECT_NEAR(found_radius_deg(deg, 25) / deg, 1, 0.25) << deg;
    EXPECT_EQ(found_radius_deg(12, 25), 8);  // larger ones are not looked for
}

TEST(LightAngularRadius, IsSmallWhereShadowsAreHardOrNone) {
    EXPECT_EQ(found_radius_deg(0, 25), 0.25);
    EXPECT_EQ(found_radius_deg(0.25, 25), 0.25);
    EXPECT_EQ(found_radius_deg(4, 75), 0.25);
}

TEST(LightAngularRadius, OfAHeightThatIsOffIsNotBelowTheTrueOne) {
    for (const double deg : {0.25, 2.0, 4.0}) EXPECT_GE(found_radius_deg(deg, 25, 1.1f), 0.85 * deg);
}

}  // namespace
}  // namespace tangi
