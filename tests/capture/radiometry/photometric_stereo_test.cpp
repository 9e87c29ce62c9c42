// photometric_stereo_test.cpp: recovers the normals and albedos that it was given, also among
// outliers.
#include "capture/radiometry/photometric_stereo.h"

#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A matt surface under the lights: value = irradiance rho_d max(0, n . l).
PixelSamples lambertian(const std::vector<Light>& lights, const glm::dvec3& normal, const glm::dvec3& diffuse,
                        int channels = 3) {
    PixelSamples s;
    s.resize(static_cast<int>(lights.size()), channels);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        s.light[i] = glm::normalize(glm::dvec3(lights[i].direction));
        for (int c = 0; c < channels; ++c) {
            const std::size_t at = i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c);
            s.irradiance[at] = 0.5 + 0.01 * static_cast<double>(i % 7);
            s.value[at] = s.irradiance[at] * diffuse[c] * std::max(0.0, glm::dot(normal, s.light[i]));
            s.sigma[at] = 0.01;
        }
    }
    return s;
}

glm::dvec3 random_normal(Random& random, double smallest_z) {
    return glm::normalize(glm::dvec3(random.direction(smallest_z)));
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

TEST(PhotometricStereo, RecoversNormalAndAlbedoExactlyWhereNothingIsInShadow) {
    Random random(1);
    const std::vector<Light> lights = dome_lights(12, 50);
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 n =
            random_normal(random, 0.8);  // within 37 degrees of the vertical: all lights above 3
        const glm::dvec3 diffuse(random.uniform(0.01, 1), random.uniform(0.01, 1), random.uniform(0.01, 1));
        const LambertEstimate e = photometric_stereo(lambertian(lights, n, diffuse));
        ASSERT_TRUE(e.valid);
        EXPECT_LE(degrees_between(e.normal, n), 1e-6);
        EXPECT_LE(glm::length(e.diffuse - diffuse), 1e-9);
    }
}

TEST(PhotometricStereo, WorksOnGreyPhotographs) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(0.2, -0.1, 1));
    const LambertEstimate e = photometric_stereo(lambertian(dome_lights(8, 40), n, glm::dvec3(0.4), 1));
    ASSERT_TRUE(e.valid);
    EXPECT_LE(degrees_between(e.normal, n), 1e-6);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.diffuse[c], 0.4, 1e-9);
}

TEST(PhotometricStereo, IsNotMisledByAttachedShadows) {
    Random random(2);
    const std::vector<Light> lights = dome_lights(24, 15);
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 n = random_normal(random, 0.4);  // up to 66 degrees: a third of the lights is behind
        const LambertEstimate e = photometric_stereo(lambertian(lights, n, glm::dvec3(0.5)));
        ASSERT_TRUE(e.valid);
        // Samples in shadow keep a weight of 1e-4 of that of the others.
        EXPECT_LE(degrees_between(e.normal, n), 0.05) << n.x << " " << n.y << " " << n.z;
    }
}

TEST(PhotometricStereo, IsRobustToAFifthOfShadowsAndHighlights) {
    Random random(3);
    const std::vector<Light> lights = dome_lights(40, 25);
    std::vector<double> errors;
    for (int i = 0; i < 400; ++i) {
        const glm::dvec3 n = random_normal(random, 0.85);
        PixelSamples s = lambertian(lights, n, {0.5, 0.3, 0.2});
        for (int photo = 0; photo < s.photos(); ++photo) {
            const double luck = random.uniform();
            for (int c = 0; c < 3; ++c) {
                double& value = s.value[static_cast<std::size_t>(photo * 3 + c)];
                if (luck < 0.1)
                    value *= 0.1;  // cast shadow
                else if (luck < 0.2)
                    value += 0.4;  // highlight
                value += 0.001 * random.normal();
            }
        }
        const LambertEstimate e = photometric_stereo(s);
        ASSERT_TRUE(e.valid);
        errors.push_back(degrees_between(e.normal, n));
    }
    std::sort(errors.begin(), errors.end());
    // Noise alone: 0.001 / sqrt(3) of a brightness of 0.17, over 30 lights: 0.05 degrees. Outliers that still
    // pull a little (their weight is (1 + r^2)^-2) add some; one pixel in twenty may have had them on one
    // side.
    EXPECT_LE(errors[errors.size() / 2], 0.2);
    EXPECT_LE(errors[errors.size() * 95 / 100], 1.0);
}

// Beside a ridge: a third of low lights all around, all those from one side, are hidden, and only two are
// high.
TEST(PhotometricStereo, IsNotMisledByShadowsFromOneSide) {
    std::vector<Light> lights = dome_lights(14, 15);
    for (Light& light : lights) {
        const double across = std::hypot(light.direction.x, light.direction.y);
        light.direction = Vec3(glm::vec2(light.direction) * static_cast<float>(0.966 / across), 0.259f);
    }
    lights.push_back(distant_light(glm::normalize(Vec3(0, 0.174f, 0.985f))));
    lights.push_back(distant_light(glm::normalize(Vec3(0, -0.174f, 0.985f))));
    Random random(5);
    std::vector<double> errors;
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 n = random_normal(random, 0.9);
        PixelSamples s = lambertian(lights, n, {0.5, 0.3, 0.2});
        int hidden = 0;
        for (int photo = 0; photo < s.photos(); ++photo) {
            const glm::dvec3 l(lights[static_cast<std::size_t>(photo)].direction);
            if (l.z > 0.5 || l.x < 0.45) continue;
            ++hidden;
            for (int c = 0; c < 3; ++c) s.value[static_cast<std::size_t>(photo * 3 + c)] *= 0.02;
        }
        ASSERT_GE(hidden, 4);
        const LambertEstimate e = photometric_stereo(s, {.shadow = 0.2});
        ASSERT_TRUE(e.valid);
        errors.push_back(degrees_between(e.normal, n));
    }
    std::sort(errors.begin(), errors.end());
    // Started from samples that are in shadow as well, a tenth of the pixels are 34 degrees off and more.
    EXPECT_LE(errors[errors.size() / 2], 0.4);
    EXPECT_LE(errors[errors.size() * 9 / 10], 3.0);
}

TEST(PhotometricStereo, LeavesOutSamplesOfSigmaZero) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(-0.3, 0.2, 1));
    PixelSamples s = lambertian(dome_lights(12, 45), n, {0.6, 0.5, 0.4});
    for (const int photo : {0, 5, 11}) {  // clipped in one channel only: the whole sample goes
        s.sigma[static_cast<std::size_t>(photo * 3 + 1)] = 0;
        for (int c = 0; c < 3; ++c) s.value[static_cast<std::size_t>(photo * 3 + c)] = 77;
    }
    const LambertEstimate e = photometric_stereo(s);
    ASSERT_TRUE(e.valid);
    EXPECT_LE(degrees_between(e.normal, n), 1e-6);
    EXPECT_LE(glm::length(e.diffuse - glm::dvec3(0.6, 0.5, 0.4)), 1e-9);
}

TEST(PhotometricStereo, OfADarkPixelIsInvalid) {
    EXPECT_FALSE(photometric_stereo(lambertian(dome_lights(12), {0, 0, 1}, glm::dvec3(0))).valid);
    EXPECT_FALSE(photometric_stereo(lambertian(dome_lights(12), {0, 0, 1}, glm::dvec3(1e-6))).valid);
    EXPECT_TRUE(photometric_stereo(lambertian(dome_lights(12), {0, 0, 1}, glm::dvec3(1e-3))).valid);
}

TEST(PhotometricStereo, OfTooFewSamplesIsInvalid) {
    EXPECT_FALSE(photometric_stereo(lambertian({}, {0, 0, 1}, glm::dvec3(1))).valid);
    EXPECT_FALSE(photometric_stereo(lambertian(dome_lights(2), {0, 0, 1}, glm::dvec3(1))).valid);
    EXPECT_TRUE(photometric_stereo(lambertian(dome_lights(3), {0, 0, 1}, glm::dvec3(1))).valid);
    PixelSamples clipped = lambertian(dome_lights(12), {0, 0, 1}, glm::dvec3(1));
    for (std::size_t i = 6; i < clipped.sigma.size(); ++i) clipped.sigma[i] = 0;
    EXPECT_FALSE(photometric_stereo(clipped).valid);
}

TEST(PhotometricStereo, UnderLightsInOnePlaneIsInvalid) {
    std::vector<Light> lights;
    for (const float x : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f}) lights.push_back(distant_light({x, 0, 1}));
    EXPECT_FALSE(photometric_stereo(lambertian(lights, {0, 0, 1}, glm::dvec3(1))).valid);
}

TEST(PhotometricStereo, GivesUnitNormalsTowardsTheViewerForAnyNumbers) {
    Random random(4);
    const std::vector<Light> lights = dome_lights(10, 5);
    for (int i = 0; i < 2000; ++i) {
        PixelSamples s = lambertian(lights, {0, 0, 1}, glm::dvec3(1));
        for (double& value : s.value) value = random.uniform() < 0.5 ? 0 : random.uniform(0, 2);
        const LambertEstimate e = photometric_stereo(s);
        if (!e.valid) continue;
        ASSERT_NEAR(glm::length(e.normal), 1, 1e-9);
        ASSERT_GE(e.normal.z, 0.1 - 1e-12);
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(e.diffuse[c] >= 0 && std::isfinite(e.diffuse[c]));
    }
}

TEST(PhotometricStereo, KnowsAmbientLight) {
    Random random(8);
    const std::vector<Light> lights = dome_lights(12, 50);
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 n = random_normal(random, 0.8);
        PixelSamples s = lambertian(lights, n, {0.3, 0.5, 0.7});
        for (std::size_t photo = 0; photo < s.light.size(); ++photo) {
            s.ambient[photo] = 0.3;
            for (std::size_t c = 0; c < 3; ++c)
                s.value[photo * 3 + c] +=
                    0.3 * s.irradiance[photo * 3 + c] * (0.3 + 0.2 * static_cast<double>(c));
        }
        const LambertEstimate e = photometric_stereo(s, {.iterations = 20});
        ASSERT_TRUE(e.valid);
        EXPECT_LE(degrees_between(e.normal, n), 0.01);
        EXPECT_LE(glm::length(e.diffuse - glm::dvec3(0.3, 0.5, 0.7)), 1e-3);
    }
}

}  // namespace
}  // namespace tangi
