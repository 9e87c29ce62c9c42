// fit_light_signs_test.cpp: a mirrored axis shows in the curl of the slopes; what has none says nothing.
#include "fit/light_signs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/test_support.h"

namespace tangi {
namespace {

// Normals of bumps of all directions, of slopes of about `steep`, with noise, turned and mirrored afterwards.
struct Normals {
    Image<Vec3> map{128, 96};
    Image<float> confidence{128, 96, 1};

    Normals(double steep, double noise, const glm::dmat2& by = glm::dmat2(1)) {
        Random random(7);
        struct Wave {
            double kx, ky, phase;
        };
        std::vector<Wave> waves;
        for (int i = 0; i < 40; ++i) {
            const double k = random.uniform(0.2, 0.9), turn = random.uniform(0, 2 * std::numbers::pi);
            waves.push_back({k * std::cos(turn), k * std::sin(turn), random.uniform(0, 6.28)});
        }
        for (int y = 0; y < map.height(); ++y)
            for (int x = 0; x < map.width(); ++x) {
                glm::dvec2 slope(noise * random.normal(), noise * random.normal());
                for (const Wave& wave : waves) {
                    const double c = steep / 4.5 * std::cos(wave.kx * x - wave.ky * y + wave.phase);
                    slope += c * glm::normalize(glm::dvec2(wave.kx, wave.ky));
                }
                slope = by * slope;
                map(x, y) = glm::normalize(Vec3(glm::dvec3(-slope, 1)));
            }
    }
    SignCheck check() const { return check_signs(map, confidence); }
};

TEST(LightSigns, OfASurfaceAreRight) {
    const SignCheck signs = Normals(0.3, 0.01).check();
    EXPECT_FALSE(signs.mirrored());
    EXPECT_LT(signs.curl, 0.2 * signs.curl_mirrored);
    EXPECT_LT(signs.certainty, -10);
    // Both axes: the same with hills for valleys.
    EXPECT_FALSE(Normals(0.3, 0.01, glm::dmat2(-1)).check().mirrored());
}

TEST(LightSigns, OfOneMirroredAxisAreWrong) {
    for (const glm::dmat2& mirror : {glm::dmat2(1, 0, 0, -1), glm::dmat2(-1, 0, 0, 1)}) {
        const SignCheck signs = Normals(0.3, 0.03, mirror).check();
        EXPECT_TRUE(signs.mirrored());
        EXPECT_GT(signs.curl, 2 * signs.curl_mirrored);
        EXPECT_GT(signs.certainty, 10);
    }
}

// Lights that are turned are another error.
TEST(LightSigns, OfTurnedLightsAreNotCalledMirrored) {
    for (const double degrees : {20.0, 45.0, 90.0, 140.0}) {
        const double a = degrees * std::numbers::pi / 180;
        EXPECT_FALSE(
            Normals(0.3, 0.03, {std::cos(a), std::sin(a), -std::sin(a), std::cos(a)}).check().mirrored())
            << degrees;
    }
}

TEST(LightSigns, OfAFlatPaintingSayNothing) {
    const SignCheck signs = Normals(0, 0.03).check();
    EXPECT_FALSE(signs.mirrored());
    EXPECT_LT(std::abs(signs.certainty), 6);
    EXPECT_FALSE(Normals(0.01, 0.03, {1, 0, 0, -1}).check().mirrored());  // relief below the noise
    Normals unknown(0.3, 0.01);
    for (float& value : unknown.confidence.pixels()) value = 0;
    EXPECT_EQ(unknown.check().curl, 0);
}

}  // namespace
}  // namespace tangi
