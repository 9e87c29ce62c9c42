// fit_odd_lights_test.cpp: a photograph with another light than the listed one is named, and only that one.
#include "fit/odd_lights.h"

#include <gmock/gmock.h>

#include "tests/test_support.h"

namespace tangi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A matt relief of bumps and dabs of paint, of slopes of about `steep`, under 16 lamps of unequal strength.
struct Bumps {
    static constexpr int kWidth = 320, kHeight = 240;
    std::vector<Light> lights;
    Survey survey;

    // `nearness` [1]: half the picture's width by the lamps' distance. `ambient` [1]: light from all around.
    // `same_side`: the second of these lamps stands on the side of the first.
    explicit Bumps(double steep, double nearness = 0, double noise = 0.002, double ambient = 0,
                   std::optional<std::pair<std::size_t, std::size_t>> same_side = {}) {
        for (int i = 0; i < 16; ++i) {
            const bool moved = same_side && same_side->second == static_cast<std::size_t>(i);
            const double angle = 2.4 * (moved ? static_cast<double>(same_side->first) : i),
                         tilt = 0.35 + 0.045 * i;
            lights.push_back(distant_light(Vec3(glm::dvec3(
                std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt)))));
            lights.back().name = fmt::format("photo_{:02}.png", i);
        }
        survey.channels = 1;
        survey.photos.resize(lights.size());
        Random random(11);
        for (int y = 4; y < kHeight; y += 8)
            for (int x = 4; x < kWidth; x += 8) {
                survey.positions.emplace_back(x, y);
                const glm::dvec2 slope =
                    steep * glm::dvec2(std::sin(0.31 * x + 0.17 * y) + 0.3 * random.normal(),
                                       std::cos(0.23 * x - 0.29 * y) + 0.3 * random.normal());
                const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope, 1));
                const double diffuse = random.uniform(0.2, 0.8);
                const glm::dvec3 place((x - kWidth / 2.0) / (kWidth / 2.0),
                                       (kHeight / 2.0 - y) / (kWidth / 2.0), 0);
                for (std::size_t i = 0; i < lights.size(); ++i) {
                    const glm::dvec3 to = glm::dvec3(lights[i].direction) - nearness * place;
                    const double distance = glm::length(to), strength = 0.5 + 0.02 * double(i);
                    const double value =
                        strength * diffuse *
                        (ambient + std::max(0.0, glm::dot(normal, to)) / (distance * distance * distance));
                    survey.values.push_back(static_cast<float>(value + noise * random.normal()));
                }
            }
    }
    LightOutliers check() const { return odd_lights(survey, Transfer{}, lights, kWidth, kHeight); }
    std::vector<std::string> doubts() const {
        std::vector<std::string> names;
        for (const Light& light : lights) names.push_back(light.name);
        return doubts_of(check(), names);
    }
    void turn(std::size_t photo, double degrees) {
        Vec3& d = lights[photo].direction;
        const float a = static_cast<float>(degrees * std::numbers::pi / 180);
        d = Vec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
    }
    void raise(std::size_t photo, double degrees) {
        Vec3& d = lights[photo].direction;
        const float plane = std::hypot(d.x, d.y);
        const float up = std::atan2(d.z, plane) + static_cast<float>(degrees * std::numbers::pi / 180);
        d = Vec3(std::cos(up) * d.x / plane, std::cos(up) * d.y / plane, std::sin(up));
    }
};

TEST(OddLights, NoneWhereAllAreRight) {
    for (const double nearness : {0.0, 0.25}) {
        const LightOutliers outliers = Bumps(0.25, nearness).check();
        EXPECT_TRUE(outliers.odd.empty()) << nearness;
        EXPECT_LT(outliers.scatter_deg, 3) << nearness;
    }
}

TEST(OddLights, TwoThatAreExchangedAreNamedTogether) {
    for (const double nearness : {0.0, 0.25}) {
        Bumps bumps(0.25, nearness);
        std::swap(bumps.lights[3].direction, bumps.lights[8].direction);
        const LightOutliers outliers = bumps.check();
        ASSERT_EQ(outliers.odd.size(), 2u) << nearness;
        EXPECT_EQ(outliers.odd[0].photo, 3u);
        EXPECT_EQ(outliers.odd[0].exchanged_with, 8u);
        EXPECT_EQ(outliers.odd[1].exchanged_with, 3u);
        EXPECT_THAT(bumps.doubts(), ElementsAre(HasSubstr("photo_03.png and photo_08.png: each is shaded by "
                                                          "the other's light")));
    }
}

TEST(OddLights, OneThatIsTurnedIsNamedWithTheLightThatItShows) {
    Bumps bumps(0.25);
    const Vec3 right = bumps.lights[12].direction;
    bumps.turn(12, 25);
    const LightOutliers outliers = bumps.check();
    ASSERT_EQ(outliers.odd.size(), 1u);
    EXPECT_EQ(outliers.odd[0].photo, 12u);
    EXPECT_FALSE(outliers.odd[0].exchanged_with);
    EXPECT_LT(glm::length(outliers.odd[0].shown - right), 0.05);
    EXPECT_THAT(bumps.doubts(), ElementsAre(HasSubstr("photo_12.png: is shaded by a light")));
}

// Lamps are as high as the list says, but for one; light from all around raises all of them alike.
TEST(OddLights, OneOfWrongHeightIsNamedWithTheHeightThatItShows) {
    for (const double degrees : {25.0, -25.0}) {
        Bumps bumps(0.25, 0, 0.002, 0.05);
        const Vec3 right = bumps.lights[9].direction;
        bumps.raise(9, degrees);
        const LightOutliers outliers = bumps.check();
        EXPECT_LT(outliers.height_scatter_deg, 3);
        ASSERT_EQ(outliers.odd.size(), 1u);
        EXPECT_EQ(outliers.odd[0].photo, 9u);
        ASSERT_TRUE(outliers.odd[0].higher_deg.has_value());
        EXPECT_NEAR(*outliers.odd[0].higher_deg, -degrees, 4);
        EXPECT_LT(glm::length(outliers.odd[0].shown - right), 0.07);
        EXPECT_THAT(bumps.doubts(),
                    ElementsAre(testing::AllOf(
                        HasSubstr("photo_09.png: is shaded by a light"),
                        HasSubstr(degrees > 0 ? "degrees lower than" : "degrees higher than"))));
    }
}

TEST(OddLights, TwoOnOneSideThatAreExchangedAreNamedTogether) {
    Bumps bumps(0.25, 0, 0.002, 0, std::pair<std::size_t, std::size_t>(3, 12));
    std::swap(bumps.lights[3].direction, bumps.lights[12].direction);
    EXPECT_THAT(bumps.doubts(), ElementsAre(HasSubstr("photo_03.png and photo_12.png: each is shaded by the "
                                                      "other's light")));
}

// What tells nothing of lights says nothing of them.
TEST(OddLights, NoneOnAFlatPaintingOrInFewPhotographs) {
    Bumps flat(0);
    std::swap(flat.lights[3].direction, flat.lights[8].direction);
    EXPECT_TRUE(flat.check().odd.empty());
    Bumps noisy(0.01, 0, 0.03);  // relief below the noise
    std::swap(noisy.lights[3].direction, noisy.lights[8].direction);
    EXPECT_TRUE(noisy.check().odd.empty());
    Survey few;
    few.channels = 1;
    few.photos.resize(5);
    const std::vector<Light> lights(noisy.lights.begin(), noisy.lights.begin() + 5);
    EXPECT_TRUE(odd_lights(few, Transfer{}, lights, 10, 10).odd.empty());
}

// Lights of which most are wrong are no slips of a line or two.
TEST(OddLights, NoneWhereTheWholeListIsAnother) {
    Bumps bumps(0.25);
    std::vector<Vec3> directions;
    for (const Light& light : bumps.lights) directions.push_back(light.direction);
    for (std::size_t i = 0; i < directions.size(); ++i)
        bumps.lights[i].direction = directions[(5 * i + i * i) % directions.size()];
    EXPECT_TRUE(bumps.check().odd.empty());
}

}  // namespace
}  // namespace tangi
