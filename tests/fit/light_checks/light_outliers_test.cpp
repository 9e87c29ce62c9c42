// light_outliers_test.cpp: a photograph with another light than the listed one is named, and only that one.
#include "fit/light_checks/light_outliers.h"

#include <gmock/gmock.h>

#include "tests/support/fit/bumps.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

LightOutliers check(const Bumps& bumps) {
    return light_outliers(bumps.survey, Transfer{}, bumps.lights, Bumps::kWidth, Bumps::kHeight);
}
std::vector<std::string> doubts(const Bumps& bumps) {
    std::vector<std::string> names;
    for (const Light& light : bumps.lights) names.push_back(light.name);
    return doubts_of(check(bumps), names);
}

TEST(LightOutliers, NoneWhereAllAreRight) {
    for (const double inverse_distance : {0.0, 0.25}) {
        const LightOutliers outliers = check(Bumps(0.25, inverse_distance));
        EXPECT_TRUE(outliers.odd.empty()) << inverse_distance;
        EXPECT_LT(outliers.scatter_deg, 3) << inverse_distance;
    }
}

TEST(LightOutliers, TwoThatAreExchangedAreNamedTogether) {
    for (const double inverse_distance : {0.0, 0.25}) {
        Bumps bumps(0.25, inverse_distance);
        std::swap(bumps.lights[3].direction, bumps.lights[8].direction);
        const LightOutliers outliers = check(bumps);
        ASSERT_EQ(outliers.odd.size(), 2u) << inverse_distance;
        EXPECT_EQ(outliers.odd[0].photo, 3u);
        EXPECT_EQ(outliers.odd[0].exchanged_with, 8u);
        EXPECT_EQ(outliers.odd[1].exchanged_with, 3u);
        EXPECT_THAT(doubts(bumps), ElementsAre(HasSubstr("photo_03.png and photo_08.png: each is shaded by "
                                                         "the other's light")));
    }
}

TEST(LightOutliers, OneThatIsTurnedIsNamedWithTheLightThatItShows) {
    Bumps bumps(0.25);
    const Vec3 right = bumps.lights[12].direction;
    bumps.turn(12, 25);
    const LightOutliers outliers = check(bumps);
    ASSERT_EQ(outliers.odd.size(), 1u);
    EXPECT_EQ(outliers.odd[0].photo, 12u);
    EXPECT_FALSE(outliers.odd[0].exchanged_with);
    EXPECT_LT(glm::length(outliers.odd[0].shown - right), 0.05);
    EXPECT_THAT(doubts(bumps), ElementsAre(HasSubstr("photo_12.png: is shaded by a light")));
}

// Lights are as high as the list says, but for one; light from all around raises all of them alike.
TEST(LightOutliers, OneOfWrongHeightIsNamedWithTheHeightThatItShows) {
    for (const double degrees : {25.0, -25.0}) {
        Bumps bumps(0.25, 0, 0.002, 0.05);
        const Vec3 right = bumps.lights[9].direction;
        bumps.raise(9, degrees);
        const LightOutliers outliers = check(bumps);
        EXPECT_LT(outliers.height_scatter_deg, 3);
        ASSERT_EQ(outliers.odd.size(), 1u);
        EXPECT_EQ(outliers.odd[0].photo, 9u);
        ASSERT_TRUE(outliers.odd[0].higher_deg.has_value());
        EXPECT_NEAR(*outliers.odd[0].higher_deg, -degrees, 4);
        EXPECT_LT(glm::length(outliers.odd[0].shown - right), 0.07);
        EXPECT_THAT(doubts(bumps),
                    ElementsAre(testing::AllOf(
                        HasSubstr("photo_09.png: is shaded by a light"),
                        HasSubstr(degrees > 0 ? "degrees lower than" : "degrees higher than"))));
    }
}

TEST(LightOutliers, TwoOnOneSideThatAreExchangedAreNamedTogether) {
    Bumps bumps(0.25, 0, 0.002, 0, Bumps::spiral(std::pair<std::size_t, std::size_t>(3, 12)));
    std::swap(bumps.lights[3].direction, bumps.lights[12].direction);
    EXPECT_THAT(doubts(bumps), ElementsAre(HasSubstr("photo_03.png and photo_12.png: each is shaded by the "
                                                     "other's light")));
}

// What tells nothing of lights says nothing of them.
TEST(LightOutliers, NoneOnAFlatPaintingOrInFewPhotographs) {
    Bumps flat(0);
    std::swap(flat.lights[3].direction, flat.lights[8].direction);
    EXPECT_TRUE(check(flat).odd.empty());
    Bumps noisy(0.01, 0, 0.03);  // relief below the noise
    std::swap(noisy.lights[3].direction, noisy.lights[8].direction);
    EXPECT_TRUE(check(noisy).odd.empty());
    Survey few;
    few.channels = 1;
    few.photos.resize(5);
    const std::vector<Light> lights(noisy.lights.begin(), noisy.lights.begin() + 5);
    EXPECT_TRUE(light_outliers(few, Transfer{}, lights, 10, 10).odd.empty());
}

// Lights of which most are wrong are no slips of a line or two.
TEST(LightOutliers, NoneWhereTheWholeListIsAnother) {
    Bumps bumps(0.25);
    std::vector<Vec3> directions;
    for (const Light& light : bumps.lights) directions.push_back(light.direction);
    for (std::size_t i = 0; i < directions.size(); ++i)
        bumps.lights[i].direction = directions[(5 * i + i * i) % directions.size()];
    EXPECT_TRUE(check(bumps).odd.empty());
}

}  // namespace
}  // namespace tangi
