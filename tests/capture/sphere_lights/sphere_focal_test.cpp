// Numbers that contradict the spheres in the photographs, focal lengths that nobody gave, and things that are
// no spheres: what is stated holds the truth.
#include "capture/sphere_lights/sphere_focal.h"

#include <gmock/gmock.h>

#include "tests/support/capture/sphere_pictures.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

double largest_error_in_sigmas(const SphereCalibration& c, const std::vector<dvec3>& truth) {
    double largest = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (c.lights[i].direction)
            largest = std::max(
                largest, degrees_between(*c.lights[i].direction, truth[i]) / c.lights[i].direction_sigma_deg);
    return largest;
}

// Right would be a radius of 15 mm, 1000 px, 600 mm, 15 mm.
struct Wrong {
    std::string what, said;
    SphereCalibrationOptions options;
};

TP_LONG TEST(SphereFocal, NumbersThatContradictEachOtherAreNamedAndErrorsHoldTheTruth) {
    const TestDir dir;
    const NearScene near;
    const auto paths = write_sphere_photos(dir.path(), near.scene, near.in_radii, true);
    const auto with = [](double radius, double focal, double distance, double height) {
        return SphereCalibrationOptions{
            .spheres = {{{70, 60}, 26, false, "70,60,26"}, {{351, 201}, 26, false, "351,201,26"}},
            .fixed_camera = true,
            .sphere_radius_mm = radius,
            .focal_px = focal,
            .camera_distance_mm = distance,
            .sphere_height_mm = height};
    };
    const Wrong all[] = {
        {"focal length", "the focal length (--focal-px, --focal-35mm) 500 would have to be",
         with(15, 500, 600, 15)},
        {"distance", "--camera-distance-mm 1200 would have to be 60", with(15, 1000, 1200, 15)},
        {"height", "--sphere-height-mm 90 would have to be", with(15, 1000, 600, 90)},
        {"radius", "--sphere-radius-mm 30 would have to be 1", with(30, 1000, 600, 15)}};
    for (const Wrong& wrong : all) {
        SCOPED_TRACE(wrong.what);
        const SphereCalibration c = calibrate_from_spheres(paths, wrong.options);
        EXPECT_THAT(c.poor, Contains(AllOf(HasSubstr("contradicts"), HasSubstr(wrong.said))));
        EXPECT_LT(largest_error_in_sigmas(c, near.lights_mm), 2.5);
        EXPECT_GT(c.calibrated(), 0);
    }
    // A wrong one of two that agree with the spheres otherwise is seen as well.
    const SphereCalibration alone =
        calibrate_from_spheres(paths, {.fixed_camera = true, .sphere_radius_mm = 15, .focal_px = 400});
    EXPECT_THAT(alone.poor, Contains(HasSubstr("the highlights say that the focal length is")));
    EXPECT_LT(largest_error_in_sigmas(alone, near.lights_mm), 2.5);
    EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, with(15, 1000, 20, 15)); }),
                HasSubstr("do not fit between camera and painting"));
}

TP_LONG TEST(SphereFocal, IsFoundWhereNobodyGaveIt) {
    const TestDir dir;
    const NearScene near;
    const auto paths = write_sphere_photos(dir.path(), near.scene, near.in_radii, true);
    const SphereCalibration c = calibrate_from_spheres(paths, {.fixed_camera = true, .sphere_radius_mm = 15});
    ASSERT_TRUE(c.camera.focal_px);
    EXPECT_NEAR(*c.camera.focal_px, 1000, 150);
    EXPECT_THAT(c.warnings,
                Contains(AllOf(HasSubstr("the focal length is not given"), HasSubstr("--focal-px"))));
    EXPECT_EQ(c.calibrated(), 8);
    EXPECT_LT(mean_error_deg(c, near.lights_mm), 2);
    EXPECT_LT(largest_error_in_sigmas(c, near.lights_mm), 2.5);
    for (const CalibratedLight& light : c.lights) EXPECT_TRUE(light.position_mm) << light.name;
}

// One sphere tells a lens from a camera far away by its outline alone, if it is large; a small one says how
// much it matters.
TP_LONG TEST(SphereFocal, OfOneSphereAsideIsToldByItsOutlineOrPartOfTheErrors) {
    const TestDir dir;
    SphereScene scene;
    scene.camera.focal_px = 450;  // 53 mm (35-mm equivalent)
    scene.spheres = {{{230, 70}, 56, 0, 0}};
    const auto lights = lights_around(6, 40);
    const SphereCalibration large =
        calibrate_from_spheres(write_sphere_photos(dir.path(), scene, lights), {.fixed_camera = true});
    EXPECT_LT(mean_error_deg(large, lights), 2);
    EXPECT_LT(largest_error_in_sigmas(large, lights), 2.5);
    EXPECT_THAT(large.warnings, Contains(HasSubstr("by the spheres it is")));
    scene.spheres = {{{245, 40}, 14, 0, 0}};
    const TestDir other;
    const auto paths = write_sphere_photos(other.path(), scene, lights);
    const SphereCalibration small = calibrate_from_spheres(paths, {.fixed_camera = true});
    EXPECT_GT(mean_error_deg(small, lights), 4);
    EXPECT_LT(largest_error_in_sigmas(small, lights), 2.5);
    EXPECT_THAT(small.poor,
                Contains(AllOf(HasSubstr("the focal length is not known"), HasSubstr("--focal-35mm"))));
    const SphereCalibration told = calibrate_from_spheres(paths, {.fixed_camera = true, .focal_px = 450});
    EXPECT_LT(mean_error_deg(told, lights), 1.5);
}

TP_LONG TEST(MirrorSphere, IsNotTakenAsGivenWhereItsOutlineIsAnother) {
    const TestDir dir;
    const auto lights = lights_around(6, 45);
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights);
    for (const double radius : {22.0, 80.0}) {
        SCOPED_TRACE(radius);
        const SphereCalibration c = calibrate_from_spheres(
            paths, {.spheres = {{{140, 106}, radius, false, "the sphere"}}, .fixed_camera = true});
        EXPECT_THAT(c.poor, Contains(AllOf(
                                HasSubstr("--sphere the sphere: what shows there is the outline of a circle"),
                                HasSubstr("Give --sphere 14"))));
        EXPECT_NEAR(c.spheres[0].image.radius_px, 40, 0.3);
        EXPECT_LT(mean_error_deg(c, lights), 0.5);
    }
}

TP_LONG TEST(MirrorSpheres, OfWhichOneShowsLittleAreBothNamed) {
    const TestDir dir;
    const NearScene near;
    const auto paths =
        write_sphere_photos(dir.path(), near.scene, near.in_radii, true, {}, [](int i, Image<float>& p) {
            if (i >= 3) paint_spot(p, 350.7, 200.9, 25, 0.02f);  // the sphere without a highlight
        });
    const SphereCalibration c = calibrate_from_spheres(paths, {.fixed_camera = true, .focal_px = 1000});
    EXPECT_EQ(c.spheres.size(), 2u);
    EXPECT_THAT(c.warnings,
                Contains(HasSubstr("sphere at (351, 201): shows the light in 3 of 8 photographs only")));
    EXPECT_EQ(c.calibrated(), 8);
    // The same sphere twice is one.
    const GivenSphere first{{70, 60}, 26, false, "70,60,26"}, again{{72, 60}, 25, false, "72,60,25"};
    const SphereCalibration twice =
        calibrate_from_spheres(paths, {.spheres = {first, again}, .fixed_camera = true, .focal_px = 1000});
    EXPECT_EQ(twice.spheres.size(), 1u);
    EXPECT_THAT(twice.warnings,
                Contains(HasSubstr("--sphere 72,60,25: is the same sphere as --sphere 70,60,26")));
}

// A dark round thing that glitters here and there, beside a relief that shows where the lights were.
TP_LONG TEST(MirrorSphere, IsNoneWhoseSpotsDoNotFollowTheLight) {
    const TestDir dir;
    SphereScene scene;
    scene.strength = 0;
    const auto lights = lights_around(12, 50);
    const auto paths =
        write_sphere_photos(dir.path(), scene, lights, false, {}, [&](int photo, Image<float>& picture) {
            paint_relief(picture, lights[static_cast<std::size_t>(photo)]);
            const double angle = 1.7 * ((photo * 7) % 12),
                         radius = 24 * std::sqrt(((photo * 5) % 12 + 0.5) / 12);
            paint_spot(picture, 140.3 + radius * std::cos(angle), 105.7 + radius * std::sin(angle), 2, 0.9f);
        });
    EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, {.fixed_camera = true}); }),
                AllOf(HasSubstr("no mirror sphere found"), HasSubstr("something round at (140, 106)"),
                      HasSubstr("not shaded as the lights")));
    // A sphere in the same place, over the same relief, is one.
    const TestDir other;
    const auto good = write_sphere_photos(other.path(), SphereScene{}, lights, false, {},
                                          [&](int photo, Image<float>& picture) {
                                              Image<float> shaded = picture;
                                              paint_relief(shaded, lights[static_cast<std::size_t>(photo)]);
                                              for (int y = 0; y < picture.height(); ++y)
                                                  for (int x = 0; x < picture.width(); ++x)
                                                      if (std::hypot(x - 140.3, y - 105.7) > 40)
                                                          picture(x, y) = shaded(x, y);
                                          });
    EXPECT_LT(mean_error_deg(calibrate_from_spheres(good, {.fixed_camera = true}), lights), 0.6);
}

TP_LONG TEST(MirrorSphere, IsNoneThatShowsTheLightInHalfOfThePhotographs) {
    const TestDir dir;
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(10), false,
                                           [](int i, SphereScene& scene) {
                                               if (i % 2 == 1 && i > 1) scene.strength = 0;
                                           });
    EXPECT_THAT(
        error_of([&] { calibrate_from_spheres(paths, {.fixed_camera = true}); }),
        AllOf(HasSubstr("no mirror sphere found"), HasSubstr("only 6 of 10 photographs show a highlight"),
              HasSubstr("--sphere 140,106,40")));
}

TP_LONG TEST(MirrorSphere, IsNoneButAMattSphereMayBe) {
    const TestDir dir;
    SphereScene scene;
    scene.matt = true;
    const auto paths = write_sphere_photos(dir.path(), scene, lights_around(6, 45));
    EXPECT_THAT(
        error_of([&] { calibrate_from_spheres(paths, {.fixed_camera = true}); }),
        AllOf(HasSubstr("no mirror sphere found"), HasSubstr("something round at (140, 106), 40 pixels"),
              HasSubstr("add --diffuse-sphere")));
}

}  // namespace
}  // namespace tangi
