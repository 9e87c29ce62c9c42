// What tells the focal length, and what contradicts it.
#include "capture/sphere_lights/focal_evidence.h"

#include <gmock/gmock.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

constexpr double kDiagonal = 880;

FocalEvidence of(FocalSource source, double focal_px, double relative) {
    return {source, {1 / focal_px, relative / focal_px}};
}

TEST(FocalEvidence, OfLengthsIsThatOfSimilarTriangles) {
    const MeasuredLengths lengths{.sphere_radius_mm = 12, .camera_distance_mm = 600, .sphere_height_mm = 6};
    const auto told = evidence_of_lengths(lengths, {1408 * 12 / 594.0, 0.4});
    ASSERT_TRUE(told);
    EXPECT_NEAR(1 / told->inverse_focal.value, 1408, 1e-6);
    EXPECT_NEAR(told->inverse_focal.sigma / told->inverse_focal.value, std::hypot(0.4 / 28.44, 0.003, 0.001),
                5e-4);
    EXPECT_FALSE(evidence_of_lengths({.sphere_radius_mm = 12}, {28, 0.4}));
    // A height that is only supposed makes it less certain.
    const auto supposed = evidence_of_lengths({.sphere_radius_mm = 12, .camera_distance_mm = 600}, {28, 0.4});
    EXPECT_GT(supposed->inverse_focal.sigma, 1.2 * told->inverse_focal.sigma);
}

TEST(FocalEvidence, OfAnOutlineIsThatOfItsAngle) {
    const double angle = 0.4, offset = 300;
    const auto told = evidence_of_outline({1 / std::cos(angle) - 1, 0.01}, offset, kDiagonal);
    ASSERT_TRUE(told);
    EXPECT_NEAR(told->inverse_focal.value, std::tan(angle) / offset, 1e-9);
    EXPECT_NEAR(told->inverse_focal.sigma,
                0.01 * std::cos(angle) / (std::tan(angle) / std::cos(angle)) /
                    (std::cos(angle) * std::cos(angle)) / offset,
                3e-5);
    EXPECT_FALSE(evidence_of_outline({0.001, 0.02}, 20, kDiagonal));  // every lens makes a circle there
}

TEST(FocalEvidence, WhatContradictsTwoOthersIsLeftOut) {
    const FocalVerdict verdict =
        judge({of(FocalSource::given, 700, 0.003), of(FocalSource::lengths, 1400, 0.02),
               of(FocalSource::highlights, 1450, 0.05)},
              kDiagonal);
    ASSERT_EQ(verdict.disagree.size(), 1u);
    EXPECT_EQ(verdict.disagree[0].source, FocalSource::given);
    EXPECT_NEAR(1 / verdict.inverse_focal.value, 1407, 10);
    EXPECT_EQ(verdict.doubt(), 1);
    EXPECT_EQ(verdict.alternatives().size(), 1u);
    MeasuredLengths lengths{
        .focal_px = 700, .sphere_radius_mm = 12, .camera_distance_mm = 600, .sphere_height_mm = 6};
    const std::string said = contradiction_of(verdict, lengths, {28.4, 0.4});
    EXPECT_THAT(said, HasSubstr("--focal-35mm) 700 would have to be 14"));
    EXPECT_THAT(said, HasSubstr("the highlights say that the focal length is 1450 ± 7"));
    EXPECT_THAT(said, Not(HasSubstr("--camera-distance-mm")));
}

// Of two that contradict each other alone either may be wrong, and any of the lengths.
TEST(FocalEvidence, OfTwoThatContradictEachOtherBothAreNamed) {
    const FocalVerdict verdict =
        judge({of(FocalSource::given, 1400, 0.003), of(FocalSource::lengths, 2800, 0.02)}, kDiagonal);
    EXPECT_EQ(verdict.alternatives().size(), 2u);
    const MeasuredLengths lengths{
        .focal_px = 1400, .sphere_radius_mm = 12, .camera_distance_mm = 1206, .sphere_height_mm = 6};
    const std::string said = contradiction_of(verdict, lengths, {28, 0.4});
    EXPECT_THAT(said, HasSubstr("1400 would have to be 2800 ±"));
    EXPECT_THAT(said, HasSubstr("--camera-distance-mm 1206 would have to be 606"));
    EXPECT_THAT(said, HasSubstr("--sphere-height-mm 6 would have to be 606"));
    EXPECT_THAT(said, HasSubstr("--sphere-radius-mm 12 would have to be 24.00"));
}

TEST(FocalEvidence, ThatAgreesIsNoContradictionAndNoDoubt) {
    const FocalVerdict verdict =
        judge({of(FocalSource::given, 1400, 0.003), of(FocalSource::lengths, 1410, 0.02),
               of(FocalSource::highlights, 1350, 0.05)},
              kDiagonal);
    EXPECT_TRUE(verdict.disagree.empty());
    EXPECT_EQ(verdict.doubt(), 0);
    EXPECT_EQ(contradiction_of(verdict, {.focal_px = 1400}, {28, 0.4}), "");
    EXPECT_EQ(judge({}, kDiagonal).inverse_focal.value, 0);  // far away, to a lens
}

}  // namespace
}  // namespace tangi
