// turned_photos_test.cpp: photographs whose pixels lie otherwise than the others' are told by name.
#include "fit/light_checks/turned_photos.h"

#include <gmock/gmock.h>

#include <functional>
#include <map>

#include "tests/support/fit/bumps.h"

namespace tangi {
namespace {

using testing::IsEmpty;

// The pixels of a photograph, each at the place that `from` gives of it.
void move_pixels(Bumps& bumps, std::size_t photo, const std::function<glm::ivec2(glm::ivec2)>& from) {
    Survey& survey = bumps.survey;
    const std::size_t photos = survey.photos.size();
    std::map<std::pair<int, int>, float> value;
    for (std::size_t k = 0; k < survey.positions.size(); ++k)
        value[{survey.positions[k].x, survey.positions[k].y}] = survey.values[k * photos + photo];
    for (std::size_t k = 0; k < survey.positions.size(); ++k) {
        const glm::ivec2 at = from(survey.positions[k]);
        survey.values[k * photos + photo] = value.at({at.x, at.y});
    }
}

// bumps.h samples at 4, 12, …: mirrored with its middle between pixels, as a picture is.
void centre(Bumps& bumps) {
    for (std::size_t k = 0; k < bumps.survey.positions.size(); ++k) {
        glm::ivec2& at = bumps.survey.positions[k];
        if (at.x >= Bumps::kWidth / 2) --at.x;
        if (at.y >= Bumps::kHeight / 2) --at.y;
    }
}

std::vector<TurnedPhoto> turned_in(const Bumps& bumps) {
    return turned_photos(bumps.survey, bumps.lights, Bumps::kWidth, Bumps::kHeight);
}

glm::ivec2 half_turn(glm::ivec2 at) { return {Bumps::kWidth - 1 - at.x, Bumps::kHeight - 1 - at.y}; }

TEST(TurnedPhotos, AreNamed) {
    for (const std::size_t count : {1u, 4u, 7u}) {
        Bumps bumps(0.25);
        centre(bumps);
        for (std::size_t i = 0; i < count; ++i) move_pixels(bumps, 2 * i, half_turn);
        const std::vector<TurnedPhoto> turned = turned_in(bumps);
        ASSERT_EQ(turned.size(), count);
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_EQ(turned[i].photo, 2 * i);
            EXPECT_EQ(in_words(turned[i].pose), "turned by 180 degrees");
        }
    }
}

TEST(TurnedPhotos, HalfOfThemAreOneOfTwoGroups) {
    Bumps bumps(0.25);
    centre(bumps);
    for (std::size_t i = 0; i < 16; i += 2) move_pixels(bumps, i, half_turn);
    EXPECT_EQ(turned_in(bumps).size(), 8u);
}

TEST(TurnedPhotos, MirroredOnesAreNamedAsThat) {
    Bumps bumps(0.25);
    centre(bumps);
    move_pixels(bumps, 3, [](glm::ivec2 at) { return glm::ivec2(Bumps::kWidth - 1 - at.x, at.y); });
    move_pixels(bumps, 5, [](glm::ivec2 at) { return glm::ivec2(at.x, Bumps::kHeight - 1 - at.y); });
    const std::vector<TurnedPhoto> turned = turned_in(bumps);
    ASSERT_EQ(turned.size(), 2u);
    EXPECT_EQ(in_words(turned[0].pose), "mirrored left to right");
    EXPECT_EQ(in_words(turned[1].pose), "mirrored top to bottom");
}

TEST(TurnedPhotos, AreNotSeenWhereNoneIs) {
    for (const double steep : {0.0, 0.1, 0.5})
        for (const double inverse_distance : {0.0, 0.25}) {
            Bumps bumps(steep, inverse_distance);
            centre(bumps);
            EXPECT_THAT(turned_in(bumps), IsEmpty()) << steep << ' ' << inverse_distance;
        }
    // Lights in another order predict nothing, and turn nothing.
    Bumps bumps(0.25);
    centre(bumps);
    std::rotate(bumps.lights.begin(), bumps.lights.begin() + 5, bumps.lights.end());
    EXPECT_THAT(turned_in(bumps), IsEmpty());
}

}  // namespace
}  // namespace tangi
