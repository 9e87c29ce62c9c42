// part_relighter_test.cpp: a painting that is relit in rectangles is the picture of the whole: shadows fall
// over the borders of tiles.
#include "surface/render/part_relighter.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/maps/surface_part.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/painting_tiles.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr float kRidgeTop_mm = 3;

// A plain with ridges along the borders of tiles and across them, lower ones between; 0.05 mm a pixel.
Surface ridged(int width, int height) {
    Surface s(width, height);
    s.mm_per_pixel = 0.05;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool ridge = std::abs(x - kPaintingTile + 30) < 6 || std::abs(y - 20) < 3;
            s.height_mm(x, y) =
                (ridge ? kRidgeTop_mm : 0) + 0.02f * std::sin(0.3f * static_cast<float>(x + 2 * y));
            s.diffuse(x, y) = {0.5f, 0.25f + 0.25f * static_cast<float>(x % 7) / 7, 0.75f};
            s.specular(x, y) = 0.04f;
            s.confidence(x, y) = 1;
        }
    s.normal = normals_of(s.height_mm, s.mm_per_pixel);
    return s;
}

class PartRelighting : public testing::Test {
protected:
    void expect_no_seams(const Light& light, const RelightOptions& options) {
        const Image<Rgb> whole = relight(surface_, std::array{light}, options);
        const PartRelighter by_tiles(tiles_, options);
        EXPECT_TRUE(images_near(by_tiles.draw_all(std::array{light}), whole, 2e-3));
        // A rectangle across the border, of the size of no tile.
        const Region region = {kPaintingTile - 40, 3, kPaintingTile + 55, 37};
        EXPECT_TRUE(images_near(by_tiles.draw(region, std::array{light}), cut(whole, region), 2e-3));
    }

    const TestDir dir_;
    const Surface surface_ = ridged(kPaintingTile + 160, 48);
    const std::shared_ptr<const PaintingReader> tiles_ = [this] {
        write_painting(dir_ / "a.exr", surface_);
        write_tiles(*open_painting(dir_ / "a.exr"), dir_ / "a.tangi");
        return open_painting(dir_ / "a.tangi", 0);
    }();
};

TEST_F(PartRelighting, OfRakingLightHasNoSeamsAtTheBordersOfTiles) {
    for (const Vec3& from : {Vec3(-0.97f, 0.1f, 0.22f), Vec3(0.9f, -0.35f, 0.26f), Vec3(0.1f, 0.95f, 0.3f)})
        expect_no_seams(distant_light(glm::normalize(from)), {.cast_shadows = true, .light_radius_deg = 1.0});
}

TEST_F(PartRelighting, OfANearLightHasNoSeamsEither) {
    Light light;
    light.position_mm = Vec3(-40, 4, 12);
    expect_no_seams(light, {.cast_shadows = true, .light_radius_deg = 0.0});
    light.position_mm = Vec3(24, 0, 9);  // above the painting
    expect_no_seams(light, {.cast_shadows = true, .light_radius_deg = 2.0});
}

// Else the test above would say nothing: the ridge in the left tile darkens the right one.
TEST_F(PartRelighting, ShadowsFallIntoTheNextTile) {
    const Light light = distant_light(glm::normalize(Vec3(-0.97f, 0, 0.22f)));
    const PartRelighter lit(tiles_, {.cast_shadows = true}), unshadowed(tiles_, {.cast_shadows = false});
    const Region beyond = {kPaintingTile + 4, 40, kPaintingTile + 8, 44};
    EXPECT_LT(lit.draw(beyond, std::array{light})(1, 1).g,
              0.2f * unshadowed.draw(beyond, std::array{light})(1, 1).g);
    EXPECT_GE(lit.within_reach(beyond, light).width(), 30);
    EXPECT_EQ(lit.within_reach(beyond, light).x1, beyond.x1 + 2);  // nothing comes from behind
}

}  // namespace
}  // namespace tangi
