// axis_check_slopes_test.cpp: a mirrored axis shows in the curl of the slopes; what has none says nothing.
#include "fit/light_checks/axis_check_slopes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_support.h"

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

glm::dmat2 turned_by(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return {std::cos(a), std::sin(a), -std::sin(a), std::cos(a)};
}

// Lights that are turned are another error, which is told up to half a turn; small ones are none.
TEST(LightSigns, OfTurnedLightsSayByHowMuch) {
    for (const double degrees : {30.0, 45.0, 90.0, 140.0, 270.0}) {
        const SignCheck signs = Normals(0.3, 0.02, turned_by(degrees)).check();
        EXPECT_FALSE(signs.mirrored()) << degrees;
        ASSERT_TRUE(signs.is_turned()) << degrees;
        EXPECT_TRUE(signs.turned.kind_is_sure()) << degrees;
        EXPECT_FALSE(signs.remedy().mirrored) << degrees;
        const double left = std::fmod(signs.remedy().turn_deg + degrees, 180);
        EXPECT_LT(std::min(left, 180 - left), 2) << degrees;
        EXPECT_LT(signs.turned.curl, 0.5 * signs.curl) << degrees;
    }
    EXPECT_FALSE(Normals(0.3, 0.03, turned_by(2)).check().wrong());
    EXPECT_FALSE(Normals(0.3, 0.03, turned_by(180)).check().wrong());
}

TEST(LightSigns, OfExchangedAxesAreMirroredAndTurned) {
    const SignCheck signs = Normals(0.3, 0.02, glm::dmat2(0, 1, 1, 0)).check();
    ASSERT_TRUE(signs.is_turned());
    EXPECT_FALSE(signs.mirrored());
    EXPECT_TRUE(signs.remedy().mirrored);
    EXPECT_EQ(signs.remedy().turn_deg, 90);
    const glm::dvec2 back = signs.remedy().applied({0.25, -0.5});
    EXPECT_EQ(std::abs(back.x), 0.5);
    EXPECT_EQ(std::abs(back.y), 0.25);
}

TEST(LightSigns, OfTurnsCombine) {
    const LightTurn a{true, 30}, b{false, 75}, c{true, 220};
    const glm::dvec2 v(0.3, 0.8);
    for (const LightTurn& first : {a, b, c})
        for (const LightTurn& then : {a, b, c})
            EXPECT_LT(glm::length(then.after(first).applied(v) - then.applied(first.applied(v))), 1e-12);
    EXPECT_LT(glm::length(a.opposite().applied(v) + a.applied(v)), 1e-12);
}

TEST(LightSigns, OfAFlatPaintingSayNothing) {
    const SignCheck signs = Normals(0, 0.03).check();
    EXPECT_FALSE(signs.wrong());
    EXPECT_LT(std::abs(signs.certainty), 6);
    EXPECT_FALSE(Normals(0.01, 0.03, {1, 0, 0, -1}).check().wrong());  // relief below the noise
    EXPECT_FALSE(Normals(0.01, 0.03, turned_by(90)).check().wrong());
    Normals unknown(0.3, 0.01);
    for (float& value : unknown.confidence.pixels()) value = 0;
    EXPECT_EQ(unknown.check().curl, 0);
}

}  // namespace
}  // namespace tangi
