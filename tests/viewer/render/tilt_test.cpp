// tilt_test.cpp: rotations of the thesis, and a hand that lets go.
#include "viewer/render/tilt.h"

#include <glm/matrix.hpp>
#include <numbers>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

void expect_near(const glm::dvec3& a, const glm::dvec3& b) { EXPECT_LT(glm::length(a - b), 1e-12); }

TEST(Tilt, RotationsAreThoseOfTheThesis) {
    expect_near(rotation_x(kQuarter) * glm::dvec3(0, 1, 0), {0, 0, 1});  // eq. 3.10
    expect_near(rotation_y(kQuarter) * glm::dvec3(0, 0, 1), {1, 0, 0});  // eq. 3.11
    expect_near(rotation_z(kQuarter) * glm::dvec3(1, 0, 0), {0, 1, 0});  // eq. 3.12
    const glm::dmat3 all = rotation_xyz(0.3, -0.5, 1.1),
                     product = rotation_x(0.3) * rotation_y(-0.5) * rotation_z(1.1);
    for (int i = 0; i < 3; ++i) expect_near(all[i], product[i]);  // eq. 3.13
    EXPECT_NEAR(glm::determinant(all), 1, 1e-12);
}

TEST(Tilt, FollowsTheHandAsFarAsItCanBeSeen) {
    Tilt tilt = dragged({}, 0.1, 0, 0.02);
    EXPECT_NEAR(tilt.angle_deg.y, 12, 1e-9);
    EXPECT_EQ(tilt.angle_deg.x, 0);
    // What is dragged to the right turns its right edge away: the left one comes nearer.
    EXPECT_LT((tilt.rotation() * glm::dvec3(1, 0, 0)).z, 0);
    EXPECT_GT((dragged({}, 0, 0.1, 0.02).rotation() * glm::dvec3(0, 1, 0)).z, 0);
    for (int i = 0; i < 50; ++i) tilt = dragged(tilt, 0.1, -0.1, 0.02);
    EXPECT_EQ(tilt.angle_deg, glm::dvec2(-Tilt::kMost_deg, Tilt::kMost_deg));
}

TEST(Tilt, GoesOnAndComesToRestWhateverTheFrames) {
    Tilt once = {.speed_deg_per_s = {80, -40}}, often = once;
    once = advanced(once, 0.1);
    for (int i = 0; i < 100; ++i) often = advanced(often, 0.001);
    EXPECT_LT(glm::length(once.angle_deg - often.angle_deg), 1e-9);
    EXPECT_GT(once.angle_deg.x, 5);
    for (int i = 0; i < 200; ++i) once = advanced(once, 0.016);
    EXPECT_FALSE(once.moves());
    EXPECT_LT(once.angle_deg.x, 80);
}

TEST(Tilt, StopsWhereItIsHeldAndAtTheEnd) {
    EXPECT_FALSE(held({.speed_deg_per_s = {80, 0}}).moves());
    Tilt end = {.angle_deg = {74, 0}, .speed_deg_per_s = {500, 0}};
    end = advanced(end, 0.1);
    EXPECT_EQ(end.angle_deg.x, Tilt::kMost_deg);
    EXPECT_FALSE(end.moves());
}

TEST(Tilt, ReturnsWhenSentBack) {
    Tilt tilt = sent_back({.angle_deg = {40, -60}});
    EXPECT_TRUE(tilt.moves());
    for (int i = 0; i < 100; ++i) tilt = advanced(tilt, 0.016);
    EXPECT_EQ(tilt.angle_deg, glm::dvec2(0));
    EXPECT_FALSE(tilt.moves());
    EXPECT_FALSE(sent_back({}).moves());
}

TEST(Tilt, SpeedIsThatOfTheHand) {
    Tilt tilt;
    for (int i = 0; i < 60; ++i) tilt = dragged(tilt, 0.001, 0, 0.01);
    EXPECT_NEAR(tilt.speed_deg_per_s.y, 12, 0.5);
    for (int i = 0; i < 30; ++i) tilt = dragged(tilt, 0, 0, 0.05);  // rests before it lets go
    EXPECT_LT(glm::length(tilt.speed_deg_per_s), 0.01);
}

}  // namespace
}  // namespace tangi
