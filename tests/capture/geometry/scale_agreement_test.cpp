// scale_agreement_test.cpp: of several scales the one is used that most agree with, and what
// contradicts it is told.
#include "capture/geometry/scale_agreement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/colour_chart/chart_order.h"

namespace tangi {
namespace {

using glm::dvec2;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Scale scale(double mm, double sigma, const std::string& method, const dvec2& place = {100, 100}) {
    return {.mm_per_pixel = mm, .sigma = sigma, .place_px = place, .method = method};
}

double straight(const dvec2&) { return 1; }

TEST(ScaleAgreement, TheMostCertainIsUsedWhereAllAgree) {
    std::vector<Scale> scales = {scale(0.1001, 5e-4, "corners"), scale(0.1, 1e-4, "scale bar")};
    rank_scales(scales, straight);
    EXPECT_EQ(scales.front().method, "scale bar");
    EXPECT_THAT(contradictions(scales, straight), IsEmpty());
}

TEST(ScaleAgreement, OneOutvotesNoTwo) {
    std::vector<Scale> scales = {scale(0.12, 1e-6, "ppi"), scale(0.1, 3e-4, "corners"),
                                 scale(0.1002, 1e-4, "scale bar")};
    rank_scales(scales, straight);
    EXPECT_EQ(scales.front().method, "scale bar");
    EXPECT_THAT(contradictions(scales, straight),
                ElementsAre(AllOf(HasSubstr("scale bar is 0.1002"), HasSubstr("ppi 0.12"),
                                  HasSubstr("19.8 % more"))));
}

TEST(ScaleAgreement, DifferencesThatPerspectiveMakesAreNone) {
    const RelativeScale aside = [](const dvec2& place) { return 1 + place.x / 1000; };
    std::vector<Scale> scales = {scale(0.11, 1e-4, "scale bar", {100, 0}),
                                 scale(0.15, 2e-4, "markers", {500, 0})};
    rank_scales(scales, aside);
    EXPECT_THAT(contradictions(scales, aside), IsEmpty());
    EXPECT_EQ(contradictions(scales, straight).size(), 1u);
}

Corners seen(const dvec2& size, double focal_px, double tilt) {
    // A rectangle 1000 px away at this scale, turned around the picture's horizontal through its middle.
    Corners corners;
    const dvec2 half = size / 2.0;
    const dvec2 plane[4] = {{-half.x, half.y}, {half.x, half.y}, {half.x, -half.y}, {-half.x, -half.y}};
    for (std::size_t i = 0; i < 4; ++i) {
        const double y = plane[i].y * std::cos(tilt), z = 1000 + plane[i].y * std::sin(tilt);
        corners[i] = dvec2(500, 400) + focal_px / z * dvec2(plane[i].x, -y);
    }
    return corners;
}

TEST(ScaleAgreement, CornersFitTheSizeFromWhereverTheCameraLooks) {
    for (const double tilt : {0.0, 0.2, -0.5})
        for (const bool known : {false, true})
            EXPECT_FALSE(contradiction_of_corners(seen({400, 300}, 1500, tilt), {400, 300},
                                                  known ? std::optional(1500.0) : std::nullopt, {500, 400},
                                                  1280))
                << tilt;
}

TEST(ScaleAgreement, CornersThatContradictTheSizeAreTold) {
    for (const double tilt : {0.0, 0.1})
        for (const bool known : {false, true}) {
            if (tilt > 0 && !known) continue;  // some camera sees it so
            const auto told =
                contradiction_of_corners(seen({400, 300}, 1500, tilt), {400, 270},
                                         known ? std::optional(1500.0) : std::nullopt, {500, 400}, 1280);
            ASSERT_TRUE(told) << tilt;
            EXPECT_THAT(*told, AllOf(HasSubstr("too high"), HasSubstr("400 x 300"), HasSubstr("11.")));
        }
    Corners mirrored = seen({400, 300}, 1500, 0);
    std::swap(mirrored[1], mirrored[3]);
    EXPECT_THAT(contradiction_of_corners(mirrored, {400, 300}, {}, {500, 400}, 1280).value(),
                HasSubstr("anticlockwise"));
}

}  // namespace
}  // namespace tangi
