// diffuse_sphere_test.cpp: lights from the shading of a diffuse sphere.
#include "capture/sphere_lights/sphere_calibration.h"

#include <gmock/gmock.h>

#include <iostream>

#include "tests/support/capture/sphere_pictures.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using testing::HasSubstr;

TP_LONG TEST(DiffuseSphere, TellsDirectionsAndItsTransferCurve) {
    const auto lights = lights_around(8, 45);
    for (const Transfer& transfer : {Transfer{}, Transfer{Transfer::Kind::srgb}}) {
        const TestDir dir;
        SphereScene scene;
        scene.matt = true;
        scene.transfer = transfer;
        const auto paths = write_sphere_photos(dir.path(), scene, lights);
        const SphereCalibration c = calibrate_from_spheres(paths, {.matt = true});
        ASSERT_EQ(c.calibrated(), 8);
        EXPECT_EQ(c.matt_transfer->name(), transfer.name());
        EXPECT_LT(mean_error_deg(c, lights), 0.6);
        EXPECT_NEAR(c.shadings[0]->brightness, 0.6, 0.03);
    }
}

TP_LONG TEST(DiffuseSphere, IsWhereAnIdealCameraWouldSeeIt) {
    const TestDir dir;
    SphereScene scene;
    scene.matt = true;
    scene.camera.focal_px = 400;
    scene.spheres = {{{235, 60}, 40, 0, 0}};
    scene.lens = Lens{scene.width, scene.height, {400, 400}, scene.camera.principal_px, {-0.6, 0.2, 0, 0}};
    const auto lights = lights_around(6, 45);
    const auto paths = write_sphere_photos(dir.path(), scene, lights);
    const SphereCalibration without = calibrate_from_spheres(paths, {.matt = true, .focal_px = 400}),
                            with = calibrate_from_spheres(
                                paths, {.matt = true, .focal_px = 400, .lens = scene.lens});
    std::cout << fmt::format(
        "[  FIGURE  ] diffuse sphere under a lens: {:.2f} deg, distortion left in {:.2f} deg\n",
        mean_error_deg(with, lights), mean_error_deg(without, lights));
    EXPECT_LT(mean_error_deg(with, lights), 0.6);
    EXPECT_GT(mean_error_deg(without, lights), 1);
    EXPECT_EQ(with.spheres[0].image.centre_px,
              without.spheres[0].image.centre_px);  // as the photographs show it
}

TP_LONG TEST(DiffuseSphere, IsNotFoundWhereNothingIsShadedLikeOne) {
    const TestDir dir;
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(5));
    EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, {.matt = true}); }),
                HasSubstr("no diffuse sphere found"));
    EXPECT_THAT(
        error_of([&] { calibrate_from_spheres(paths, {.spheres = {circle(140, 106, 40)}, .matt = true}); }),
        HasSubstr("no diffuse sphere at --sphere 140,106,40"));
}

}  // namespace
}  // namespace tangi
