// mirror_sphere_rings_test.cpp: a clear mirror sphere beside a painting has rings in it, and its outline
// fades where what it mirrors looks like what lies behind.
#include <gmock/gmock.h>

#include "tests/support/capture/mirrored_painting.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

// A painting with relief, and beside it a plain board with a sphere on it: the dark room shows within 0.71
// radii, the board and the table around that, and the painting in a crescent.
MirroredPainting beside_a_painting(double radius_px) {
    MirroredPainting scene;
    scene.width = 340;
    scene.height = 240;
    scene.plain_from = 210;
    scene.table = 0.16;  // nearly as bright as the board, as mirrored
    scene.finest = 4;
    scene.noise = 0.002;
    scene.light_deg = 3;
    scene.spheres = {{{272.4, 120.7}, radius_px, 0, 0}};
    return scene;
}

// A gentle relief.
float shaded(float value, int x, int y, const glm::dvec3& light) {
    const glm::dvec2 slope = 0.1 * glm::dvec2(std::sin(0.31 * x + 0.11 * y), std::cos(0.23 * y - 0.07 * x));
    return value *
           static_cast<float>(std::max(0.1, 1 + glm::dot(slope, glm::dvec2(light)) / std::max(light.z, 0.2)));
}

std::vector<std::filesystem::path> write_beside(const TestDir& dir, const MirroredPainting& scene,
                                                const std::vector<glm::dvec3>& lights) {
    const Image<float> reflectance = scene.painting();
    std::vector<std::filesystem::path> paths;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        Image<float> picture = scene.picture({{lights[i], 40}}, reflectance);
        for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.plain_from; ++x)
                picture(x, y) = std::min(shaded(picture(x, y), x, y, lights[i]), 1.0f);
        paths.push_back(dir / sphere_photo_name(static_cast<int>(i)));
        write_map(paths.back(), picture);
    }
    return paths;
}

TP_LONG TEST(MirrorSphere, WithRingsIsFoundByWhatItShows) {
    for (const double radius : {24.0, 40.0}) {
        SCOPED_TRACE(radius);
        const TestDir dir;
        const MirroredPainting scene = beside_a_painting(radius);
        const std::vector<glm::dvec3> lights = lights_above(20);
        const SphereCalibration c = calibrate_from_spheres(write_beside(dir, scene, lights), {});
        ASSERT_EQ(c.spheres.size(), 1u);
        const SphereImage &found = c.spheres[0].image, &truth = scene.spheres[0];
        std::cout << "circle " << found.centre_px.x << " " << found.centre_px.y << " " << found.radius_px
                  << " +- " << found.centre_sigma_px << " " << found.radius_sigma_px << ", lights off "
                  << mean_error_deg(c, lights) << " degrees\n";
        EXPECT_LT(glm::length(found.centre_px - truth.centre_px), 3 * std::max(found.centre_sigma_px, 0.3));
        EXPECT_NEAR(found.radius_px, truth.radius_px, 3 * std::max(found.radius_sigma_px, 0.3));
        EXPECT_LT(mean_error_deg(c, lights), 2);
    }
}

}  // namespace
}  // namespace tangi
