// Whether photographs are shaded as lights in given directions would shade them.
#include "capture/spheres/light_plausibility.h"

#include <gtest/gtest.h>

#include "tests/support/capture/sphere_pictures.h"

namespace tangi {
namespace {

struct Shaded {
    GreyPhotos photos;
    CameraMotions drifts;
    std::vector<std::optional<glm::dvec3>> directions;

    explicit Shaded(bool relief, int count = 12) {
        photos.width = 120, photos.height = 90;
        drifts.photos.resize(static_cast<std::size_t>(count));
        Random random(3);
        for (const glm::dvec3& light : lights_around(count, 50)) {
            // Lights of any strength: only what differs inside a photograph counts.
            Image<float> photo(120, 90, static_cast<float>(random.uniform(0.1, 0.5)));
            if (relief) paint_relief(photo, light);
            for (float& value : photo.pixels()) value += 0.002f * static_cast<float>(random.normal());
            photos.mean.push_back(photo);
            directions.emplace_back(light);
        }
    }
    std::optional<double> chance() const { return chance_of_directions(photos, drifts, directions, {}); }
};

TEST(LightPlausibility, IsHighForTheLightsThatShadedThePhotographs) {
    const Shaded right(true);
    ASSERT_TRUE(right.chance());
    EXPECT_LT(*right.chance(), 0.02);
}

TEST(LightPlausibility, IsAsOfRandomDirectionsForOthers) {
    Shaded wrong(true);
    double sum = 0;
    for (int turn = 1; turn <= 5; ++turn) {
        for (std::size_t i = 0; i < 12; ++i)
            wrong.directions[i] = lights_around(12, 50)[(i * 5 + 7 * i * i) % 12];
        std::rotate(wrong.directions.begin(), wrong.directions.begin() + turn, wrong.directions.end());
        ASSERT_TRUE(wrong.chance());
        sum += *wrong.chance() / 5;
    }
    EXPECT_GT(sum, kLargestChance);
}

TEST(LightPlausibility, IsNotToldByAFlatPictureOrFewPhotographs) {
    EXPECT_FALSE(Shaded(false).chance());
    EXPECT_FALSE(Shaded(true, 6).chance());
}

// A black cloth, of which the file keeps a code or two.
TEST(LightPlausibility, IsNotToldByWhatIsAsDarkAsRounding) {
    Shaded dark(true);
    ASSERT_TRUE(dark.chance());
    for (Image<float>& photo : dark.photos.mean)
        for (float& value : photo.pixels())
            value = dark.photos.step * std::round(0.02f * value / dark.photos.step);
    EXPECT_FALSE(dark.chance());
    Shaded noisy(true);
    Random random(8);
    for (Image<float>& photo : noisy.photos.mean)
        for (float& value : photo.pixels()) value += 0.15f * static_cast<float>(random.normal());
    EXPECT_FALSE(noisy.chance());
}

}  // namespace
}  // namespace tangi
