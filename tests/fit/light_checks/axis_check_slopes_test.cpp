// axis_check_slopes_test.cpp: a mirrored axis shows in the curl of the slopes; what has none says nothing.
#include "fit/light_checks/axis_check_slopes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/fit/relief_normals.h"

namespace tangi {
namespace {

TEST(LightSigns, OfASurfaceAreRight) {
    const SignCheck signs = ReliefNormals(0.3, 0.01).check();
    EXPECT_FALSE(signs.mirrored());
    EXPECT_LT(signs.curl, 0.2 * signs.curl_mirrored);
    EXPECT_LT(signs.certainty, -10);
    // Both axes: the same with hills for valleys.
    EXPECT_FALSE(ReliefNormals(0.3, 0.01, glm::dmat2(-1)).check().mirrored());
}

TEST(LightSigns, OfOneMirroredAxisAreWrong) {
    for (const glm::dmat2& mirror : {glm::dmat2(1, 0, 0, -1), glm::dmat2(-1, 0, 0, 1)}) {
        const SignCheck signs = ReliefNormals(0.3, 0.03, mirror).check();
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
        const SignCheck signs = ReliefNormals(0.3, 0.02, turned_by(degrees)).check();
        EXPECT_FALSE(signs.mirrored()) << degrees;
        ASSERT_TRUE(signs.is_turned()) << degrees;
        EXPECT_TRUE(signs.turned.kind_is_sure()) << degrees;
        EXPECT_FALSE(signs.remedy().mirrored) << degrees;
        const double left = std::fmod(signs.remedy().turn_deg + degrees, 180);
        EXPECT_LT(std::min(left, 180 - left), 2) << degrees;
        EXPECT_LT(signs.turned.curl, 0.5 * signs.curl) << degrees;
    }
    EXPECT_FALSE(ReliefNormals(0.3, 0.03, turned_by(2)).check().wrong());
    EXPECT_FALSE(ReliefNormals(0.3, 0.03, turned_by(180)).check().wrong());
}

TEST(LightSigns, OfExchangedAxesAreMirroredAndTurned) {
    const SignCheck signs = ReliefNormals(0.3, 0.02, glm::dmat2(0, 1, 1, 0)).check();
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
    const SignCheck signs = ReliefNormals(0, 0.03).check();
    EXPECT_FALSE(signs.wrong());
    EXPECT_LT(std::abs(signs.certainty), 6);
    EXPECT_FALSE(ReliefNormals(0.01, 0.03, {1, 0, 0, -1}).check().wrong());  // relief below the noise
    EXPECT_FALSE(ReliefNormals(0.01, 0.03, turned_by(90)).check().wrong());
    ReliefNormals unknown(0.3, 0.01);
    for (float& value : unknown.confidence.pixels()) value = 0;
    EXPECT_EQ(unknown.check().curl, 0);
}

}  // namespace
}  // namespace tangi
