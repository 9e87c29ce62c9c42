// relative_shading_test.cpp: what is the lights' is told from what is the object's.
#include "capture/uncalibrated/relative_shading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "surface/base/noise.h"

namespace tangi {
namespace {

constexpr int kShadedWidth = 24, kShadedHeight = 20, kShadedPhotos = 24;

double noise(int x, int y, int seed) {
    return procedural::uniform(procedural::hash(static_cast<procedural::Seed>(seed), x, y)) - 0.5;
}

// Slopes that know no smooth part, an albedo, and lights all around of unlike strength that fall off to the
// right.
struct Scene {
    std::vector<Image<float>> pictures;
    std::vector<glm::dvec2> lights;
    static constexpr double kFalloff = 0.2;  // of ln of the light, a picture width
    static glm::dvec2 slope(int x, int y) { return {0.2 * noise(x, y, 1), 0.2 * noise(x, y, 2)}; }
    Scene() {
        for (int j = 0; j < kShadedPhotos; ++j) {
            const double angle = 2 * M_PI * j / kShadedPhotos, strength = 0.3 + 0.01 * j;
            lights.emplace_back(std::cos(angle), std::sin(angle));
            Image<float>& picture = pictures.emplace_back(kShadedWidth, kShadedHeight);
            for (int y = 0; y < kShadedHeight; ++y)
                for (int x = 0; x < kShadedWidth; ++x) {
                    const double albedo = 0.5 + 0.8 * (noise(x, y, 3) + 0.5);
                    const double shade = 1 - glm::dot(lights.back(), slope(x, y));
                    const double fall = std::exp(kFalloff * (static_cast<double>(x) / kShadedWidth - 0.5));
                    picture(x, y) = static_cast<float>(albedo * strength * shade * fall);
                }
        }
    }
};

TEST(RelativeShading, HasNeitherAlbedoNorStrengthNorFalloff) {
    const Scene scene;
    const RelativeShading shading = shading_of(scene.pictures, 0.99f);
    for (int j = 0; j < kShadedPhotos; ++j) {
        EXPECT_NEAR(shading.falloff(j, 0), 0, 0.03) << j;  // all photographs share it: it is the albedo's
        double worst = 0;
        for (int y = 0; y < kShadedHeight; ++y)
            for (int x = 0; x < kShadedWidth; ++x) {
                const double expected =
                    -glm::dot(scene.lights[static_cast<std::size_t>(j)], Scene::slope(x, y));
                worst = std::max(worst, std::abs(shading.value(y * kShadedWidth + x, j) - expected));
            }
        EXPECT_LT(worst, 0.06) << j;
    }
    EXPECT_NEAR(shading.log_level[kShadedPhotos - 1] - shading.log_level[0], std::log(0.53 / 0.3), 0.02);
}

TEST(RelativeShading, FalloffOfOnePhotographIsItsLights) {
    Scene scene;
    for (int y = 0; y < kShadedHeight; ++y)
        for (int x = 0; x < kShadedWidth; ++x)
            scene.pictures[3](x, y) *=
                static_cast<float>(std::exp(0.5 * (static_cast<double>(y) / kShadedHeight - 0.5)));
    const RelativeShading shading = shading_of(scene.pictures, 0.99f);
    // It grows downwards, a picture height of 20 pixels; falloff is upwards, a width of 24.
    EXPECT_NEAR(shading.falloff(3, 1), -0.5 * kShadedWidth / kShadedHeight, 0.05);
    EXPECT_NEAR(shading.falloff(4, 1), 0, 0.05);
}

TEST(ShadingFactors, AreFoundInSpiteOfShadowsAndHighlights) {
    const Scene scene;
    RelativeShading shading = shading_of(scene.pictures, 0.99f);
    const ShadingFactors clean = factored(shading);
    EXPECT_GT(clean.explained, 0.98);
    EXPECT_LT(clean.residual, 0.02);
    for (int i = 0; i < kShadedWidth * kShadedHeight; ++i)
        for (int j = 0; j < kShadedPhotos; ++j)
            if (const double draw = noise(i, j, 9) + 0.5; draw < 0.05)
                shading.value(i, j) = draw < 0.025 ? -1 : 2;
    const ShadingFactors spoilt = factored(shading);
    // The factors are known up to a 2 x 2 matrix; their product is not.
    const Eigen::MatrixXd off = spoilt.left * spoilt.right.transpose() - clean.left * clean.right.transpose();
    // Of the 24 samples of a pixel several may be spoilt, so not all pixels can come out right.
    std::vector<double> sizes(static_cast<std::size_t>(off.size()));
    for (std::size_t k = 0; k < sizes.size(); ++k) sizes[k] = std::abs(off.data()[k]);
    std::sort(sizes.begin(), sizes.end());
    EXPECT_LT(sizes[sizes.size() / 2], 0.01);
    EXPECT_LT(sizes[sizes.size() * 9 / 10], 0.03);
}

TEST(RelativeShading, ClippedAndShadowedSamplesDoNotCount) {
    Scene scene;
    scene.pictures[2](5, 6) = 1;
    scene.pictures[4](5, 6) = 0;
    const RelativeShading shading = shading_of(scene.pictures, 0.99f);
    const int at = 6 * kShadedWidth + 5;
    EXPECT_EQ(shading.weight(at, 2), 0);
    EXPECT_EQ(shading.weight(at, 4), 0);
    EXPECT_EQ(shading.weight(at, 3), 1);
}

}  // namespace
}  // namespace tangi
