// sphere_calibration_test.cpp: lights from spheres, rendered with known lights, and everything that can
// be wrong with them.
#include "capture/sphere_lights/sphere_calibration.h"

#include <gmock/gmock.h>

#include "capture/photo/rejected_photo.h"
#include "tests/support/capture/sphere_pictures.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

TP_LONG TEST(MirrorSphere, IsFoundAndTellsDirections) {
    const TestDir dir;
    const auto lights = lights_around(10);
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights);
    const SphereCalibration c = calibrate_from_spheres(paths, {});
    ASSERT_EQ(c.spheres.size(), 1u);
    EXPECT_LT(glm::length(c.spheres[0].image.centre_px - dvec2(140.3, 105.7)), 0.1);
    EXPECT_NEAR(c.spheres[0].image.radius_px, 40, 0.2);
    ASSERT_EQ(c.calibrated(), 10);
    EXPECT_LT(mean_error_deg(c, lights), 0.4);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        EXPECT_LT(degrees_between(*c.lights[i].direction, lights[i]), 4 * c.lights[i].direction_sigma_deg)
            << i;
        EXPECT_LT(c.lights[i].direction_sigma_deg, 3);
        EXPECT_FALSE(c.lights[i].position_mm);
    }
}

TP_LONG TEST(MirrorSphere, IsTakenFromACircleOrABox) {
    const TestDir dir;
    const auto lights = lights_around(5);
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights);
    for (const GivenSphere& given :
         {circle(143, 103, 43), GivenSphere{{140, 104}, 52, true, "88,52,192,156"}}) {
        const SphereCalibration c = calibrate_from_spheres(paths, {.spheres = {given}});
        ASSERT_EQ(c.calibrated(), 5);
        EXPECT_NEAR(c.spheres[0].image.radius_px, 40, 0.2);
        EXPECT_LT(mean_error_deg(c, lights), 0.4);
        EXPECT_TRUE(c.spheres[0].given);
    }
}

TP_LONG TEST(MirrorSphere, IsFollowedWhereTheCameraMoves) {
    const TestDir dir;
    const auto lights = lights_around(8);
    Random random(2);
    const auto paths =
        write_sphere_photos(dir.path(), SphereScene{}, lights, false, [&](int i, SphereScene& scene) {
            if (i > 0) scene.shift_px = {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
        });
    const SphereCalibration moved = calibrate_from_spheres(paths, {});
    EXPECT_TRUE(moved.drifts.moved);
    EXPECT_LT(mean_error_deg(moved, lights), 0.5);
    const SphereCalibration taken_for_fixed = calibrate_from_spheres(paths, {.fixed_camera = true});
    EXPECT_GT(mean_error_deg(taken_for_fixed, lights), 2 * mean_error_deg(moved, lights));
    EXPECT_FALSE(taken_for_fixed.drifts.moved);
    EXPECT_THAT(taken_for_fixed.poor,
                Contains(AllOf(HasSubstr("--fixed-camera says"),
                               HasSubstr(fmt::format("{:.2f} pixels (rms)", moved.drifts.rms_px)))));
}

TP_LONG TEST(MirrorSphere, IsTakenFromACameraThatIsSaidToBeFixedAndIs) {
    const TestDir dir;
    const auto lights = lights_around(8);
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights);
    const SphereCalibration c = calibrate_from_spheres(paths, {.fixed_camera = true});
    EXPECT_LT(mean_error_deg(c, lights), 0.4);
    EXPECT_THAT(c.poor, testing::IsEmpty());
    EXPECT_THAT(c.warnings, testing::Each(testing::Not(HasSubstr("--fixed-camera"))));
}

// It is no motion of the camera, and the light of no photograph.
TP_LONG TEST(SphereCalibration, NamesAPhotographOfSomethingElse) {
    const TestDir dir;
    const auto paint = [](int photo, Image<float>& picture) {
        if (photo != 3) return;
        for (int y = 0; y < picture.height(); ++y)
            for (int x = 0; x < picture.width(); ++x)
                picture(x, y) = (x + y) / 15 % 2 == (x + 300 - y) / 17 % 2 ? 0.3f : 0.1f;
    };
    auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(8), false, {}, paint);
    try {
        (void)calibrate_from_spheres(paths, {});
        ADD_FAILURE() << "not named";
    } catch (const PhotoError& error) {
        EXPECT_EQ(error.path(), paths[3]);
        EXPECT_THAT(error.what(), HasSubstr("shows something else than the other photographs"));
    }
    paths.erase(paths.begin() + 3);
    EXPECT_FALSE(calibrate_from_spheres(paths, {}).drifts.moved);
}

TP_LONG TEST(MirrorSpheres, TellPositionsInPerspective) {
    const TestDir dir;
    const NearScene near;
    const auto paths = write_sphere_photos(dir.path(), near.scene, near.in_radii, true);
    const SphereCalibration c = calibrate_from_spheres(
        paths, {.sphere_radius_mm = 15, .focal_px = 1000, .camera_distance_mm = 600, .sphere_height_mm = 15});
    ASSERT_EQ(c.spheres.size(), 2u);
    ASSERT_EQ(c.calibrated(), 8);
    double sum = 0;
    for (std::size_t i = 0; i < near.lights_mm.size(); ++i) {
        ASSERT_TRUE(c.lights[i].position_mm);
        const double error = glm::length(*c.lights[i].position_mm - near.lights_mm[i]);
        sum += error / 8;
        EXPECT_LT(error, 4 * glm::length(c.lights[i].position_sigma_mm)) << i;
    }
    EXPECT_LT(sum, 6);
    EXPECT_LT(mean_error_deg(c, near.lights_mm), 0.5);
    // Without the radius there are directions, from the picture's middle all the same, and no lengths.
    const SphereCalibration unscaled = calibrate_from_spheres(paths, {.focal_px = 1000});
    EXPECT_LT(mean_error_deg(unscaled, near.lights_mm), 1.5);
    for (const CalibratedLight& light : unscaled.lights) EXPECT_FALSE(light.position_mm);
}

TP_LONG TEST(MirrorSphere, IsMissingWhereOneIsSaidToBe) {
    const TestDir dir;
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(5));
    EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, {.spheres = {circle(250, 60, 25)}}); }),
                AllOf(HasSubstr("--sphere 250,60,25: no mirror sphere there"), HasSubstr("0 of 5")));
    // One that is there is used all the same.
    const SphereCalibration c =
        calibrate_from_spheres(paths, {.spheres = {circle(250, 60, 25), circle(140, 106, 40)}});
    EXPECT_EQ(c.calibrated(), 5);
    EXPECT_EQ(c.spheres.size(), 1u);
    EXPECT_THAT(c.warnings, Contains(HasSubstr("--sphere 250,60,25: no mirror sphere there")));
    EXPECT_THAT(
        error_of([&] { calibrate_from_spheres(paths, {.spheres = {circle(900, 60, 25)}}); }),
        HasSubstr("--sphere 900,60,25: its centre does not lie in the photographs, which are 300 x 220"));
}

// Something round with glossy spots all over it is not one, and the result says that it is doubtful.
TP_LONG TEST(MirrorSphere, IsDoubtedWhereItsHighlightsComeFromBehindThePainting) {
    const TestDir dir;
    SphereScene scene;
    scene.strength = 0;
    const auto paths = write_sphere_photos(
        dir.path(), scene, lights_around(12), false, {}, [](int photo, Image<float>& picture) {
            const double angle = 2.4 * photo, radius = 36 * std::sqrt((photo + 0.5) / 12);
            paint_spot(picture, 140.3 + radius * std::cos(angle), 105.7 + radius * std::sin(angle), 2.5,
                       0.8f);
        });
    const SphereCalibration c = calibrate_from_spheres(paths, {.spheres = {circle(140, 106, 40)}});
    EXPECT_THAT(c.poor, testing::Contains(HasSubstr("lights behind the painting")));
}

TP_LONG TEST(MirrorSphere, IsNotFoundInPhotographsWithoutOne) {
    const TestDir dir;
    SphereScene empty;
    empty.spheres.clear();
    const auto paths = write_sphere_photos(dir.path(), empty, lights_around(5));
    EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, {}); }),
                AllOf(HasSubstr("no mirror sphere found"), HasSubstr("--sphere X,Y,R")));
}

// Photograph 3 of 8 is spoilt; it alone is rejected, and the warning names it and says why.
struct Spoilt {
    std::string name, said;
    ChangeScene change;
    ChangePicture paint;
};

TP_LONG TEST(MirrorSphere, LeavesOutPhotographsWhoseHighlightIsNone) {
    const auto at3 = [](auto action) {
        return [action](int i, auto& what) {
            if (i == 3) action(what);
        };
    };
    const Spoilt all[] = {{"absent", "no highlight on it", at3([](SphereScene& s) { s.strength = 0; }), {}},
                          {"off the sphere", "off the sphere or across its outline",
                           at3([](SphereScene& s) { s.strength = 0; }),
                           at3([](Image<float>& p) { paint_spot(p, 140.3 + 45, 105.7, 2.5); })},
                          {"across the outline", "off the sphere or across its outline",
                           at3([](SphereScene& s) { s.strength = 0; }),
                           at3([](Image<float>& p) { paint_spot(p, 140.3 + 39.5, 105.7, 3); })},
                          {"clipped",
                           "clipped over too large a part of the sphere",
                           at3([](SphereScene& s) { s.strength = 4000; }),
                           {}},
                          {"two", "two highlights of about the same brightness",
                           at3([](SphereScene& s) { s.strength = 0; }), at3([](Image<float>& p) {
                               paint_spot(p, 130, 100, 3);
                               paint_spot(p, 155, 112, 3);
                           })}};
    const auto lights = lights_around(8, 40);
    for (const Spoilt& spoilt : all) {
        SCOPED_TRACE(spoilt.name);
        const TestDir dir;
        const auto paths =
            write_sphere_photos(dir.path(), SphereScene{}, lights, false, spoilt.change, spoilt.paint);
        const SphereCalibration c = calibrate_from_spheres(paths, {.fixed_camera = true});
        EXPECT_EQ(c.calibrated(), 7);
        EXPECT_FALSE(c.lights[3].direction);
        EXPECT_THAT(c.warnings, Contains(AllOf(HasSubstr("sphere_03.png: rejected"),
                                               HasSubstr("sphere 1 at (140, 106)"), HasSubstr(spoilt.said))));
        EXPECT_LT(mean_error_deg(c, lights), 0.5);
        EXPECT_EQ(c.usable_lights().size(), 7u);
    }
}

TP_LONG TEST(MirrorSpheres, GoOnWithOneWhereTheOtherShowsNothing) {
    const TestDir dir;
    const NearScene near;
    const auto paths =
        write_sphere_photos(dir.path(), near.scene, near.in_radii, true, {}, [](int i, Image<float>& p) {
            if (i == 2) paint_spot(p, 70.4, 60.2, 20, 0.02f);
        });
    const SphereCalibration c = calibrate_from_spheres(
        paths, {.sphere_radius_mm = 15, .focal_px = 1000, .camera_distance_mm = 600, .sphere_height_mm = 15});
    ASSERT_EQ(c.calibrated(), 8);
    EXPECT_FALSE(c.lights[2].position_mm);
    EXPECT_EQ(c.lights[2].spheres_used, 1);
    EXPECT_LT(degrees_between(*c.lights[2].direction, near.lights_mm[2]), 3);
    EXPECT_THAT(c.warnings, Contains(AllOf(HasSubstr("sphere_02.png: sphere 1"), HasSubstr("no highlight"))));
}

TEST(SphereCalibration, RefusesPhotographsOfTwoSizesAndBothFocalLengths) {
    const TestDir dir;
    auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(3));
    EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, {.focal_px = 1000, .focal_35mm = 50}); }),
                HasSubstr("not both"));
    write_map(paths[1], Image<float>(299, 220, 0.5f));
    EXPECT_THAT(error_of([&] { calibrate_from_spheres(paths, {}); }),
                AllOf(HasSubstr("sphere_01.png: is 299 x 220"), HasSubstr("the same size")));
}

}  // namespace
}  // namespace tangi
