// looks_test.cpp: ways to look at a painting otherwise than it is seen.
#include "tests/support/viewer/viewer_support.h"
#include "viewer/render/renderer.h"

namespace tangi {
namespace {

using Looks = Drawing;

TEST_F(Looks, EveryWayToLookGivesAPictureOfItsOwn) {
    const Surface s = painted_surface(64, 64);
    show(s);
    std::vector<Image<Rgb>> pictures;
    for (const ViewModeTraits& look : view_modes()) {
        Scene scene{.lights = {distant_light({-0.5f, 0.5f, 0.7f})}, .mode = look.mode};
        if (look.coarser_levels > 0) scene.sharpness = static_cast<float>(look.coarser_levels);
        if (look.strongest > 0) scene.strength = look.strongest;
        const auto picture = drawn(scene, pixel_by_pixel(s), false);
        for (const Rgb& c : picture.pixels())
            ASSERT_TRUE(c.r >= 0 && c.r <= 1 && c.g >= 0 && c.g <= 1 && c.b >= 0 && c.b <= 1) << look.name;
        for (const auto& other : pictures) EXPECT_LT(part_within(picture, other, 2), 0.9) << look.name;
        pictures.push_back(picture);
    }
}

// Mean curvature of a sphere is 1 / R everywhere; of a hollow one, less than 0; of a cylinder, half.
TEST_F(Looks, CurvatureIsThatOfSpheresAndCylinders) {
    constexpr float kRadius_mm = 40;
    const auto colour = [&](float sign, bool cylinder) {
        Surface s(96, 96);
        s.mm_per_pixel = 0.25;
        for (int y = 0; y < 96; ++y)
            for (int x = 0; x < 96; ++x) {
                const Vec3 at = s.point_mm(x, y);
                Vec3 n(sign * at.x / kRadius_mm, cylinder ? 0 : sign * at.y / kRadius_mm, 0);
                n.z = std::sqrt(1 - n.x * n.x - n.y * n.y);
                s.normal(x, y) = n;
            }
        show(s);
        const Scene scene{.mode = ViewMode::curvature, .most_curvature = 2 / kRadius_mm};
        const auto picture = drawn(scene, pixel_by_pixel(s), true);
        const Rgb middle = picture(48, 48);
        for (const auto& [x, y] : {std::pair(10, 20), {80, 50}, {33, 90}}) {
            const Rgb off = glm::abs(picture(x, y) - middle);
            EXPECT_LT(std::max({off.r, off.g, off.b}), 0.02f) << "the same everywhere";
        }
        return middle;
    };
    const Rgb grey(0.35f), bump(0.85f, 0.22f, 0.005f), hollow(0.01f, 0.12f, 0.60f);
    const auto expect_near = [](const Rgb& is, const Rgb& should) {
        EXPECT_LT(glm::length(is - should), 0.02f) << is.r << " " << is.g << " " << is.b;
    };
    expect_near(colour(1, false), glm::mix(grey, bump, 0.5f));
    expect_near(colour(-1, false), glm::mix(grey, hollow, 0.5f));
    expect_near(colour(1, true), glm::mix(grey, bump, 0.25f));
}

}  // namespace
}  // namespace tangi
