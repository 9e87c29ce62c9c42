// ball_calibration_test.cpp: lights from balls, rendered with known lights, and everything that can
// be wrong with them.
#include "capture/sphere_lights/ball_calibration.h"

#include <gmock/gmock.h>

#include "capture/photo/rejected_photo.h"
#include "tests/support/ball_pictures.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

TEST(MirrorBall, IsFoundAndTellsDirections) {
    const TestDir dir;
    const auto lights = lights_around(10);
    const auto paths = write_ball_photos(dir.path(), BallScene{}, lights);
    const BallCalibration c = calibrate_from_balls(paths, {});
    ASSERT_EQ(c.balls.size(), 1u);
    EXPECT_LT(glm::length(c.balls[0].image.centre_px - dvec2(140.3, 105.7)), 0.1);
    EXPECT_NEAR(c.balls[0].image.radius_px, 40, 0.2);
    ASSERT_EQ(c.calibrated(), 10);
    EXPECT_LT(mean_error_deg(c, lights), 0.4);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        EXPECT_LT(degrees_between(*c.lights[i].direction, lights[i]), 4 * c.lights[i].direction_sigma_deg)
            << i;
        EXPECT_LT(c.lights[i].direction_sigma_deg, 3);
        EXPECT_FALSE(c.lights[i].position_mm);
    }
}

TEST(MirrorBall, IsTakenFromACircleOrABox) {
    const TestDir dir;
    const auto lights = lights_around(5);
    const auto paths = write_ball_photos(dir.path(), BallScene{}, lights);
    for (const GivenBall& given : {circle(143, 103, 43), GivenBall{{140, 104}, 52, true, "88,52,192,156"}}) {
        const BallCalibration c = calibrate_from_balls(paths, {.balls = {given}});
        ASSERT_EQ(c.calibrated(), 5);
        EXPECT_NEAR(c.balls[0].image.radius_px, 40, 0.2);
        EXPECT_LT(mean_error_deg(c, lights), 0.4);
        EXPECT_TRUE(c.balls[0].given);
    }
}

TEST(MirrorBall, IsFollowedWhereTheCameraMoves) {
    const TestDir dir;
    const auto lights = lights_around(8);
    Random random(2);
    const auto paths =
        write_ball_photos(dir.path(), BallScene{}, lights, false, [&](int i, BallScene& scene) {
            if (i > 0) scene.shift_px = {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)};
        });
    const BallCalibration moved = calibrate_from_balls(paths, {});
    EXPECT_TRUE(moved.drifts.moved);
    EXPECT_LT(mean_error_deg(moved, lights), 0.5);
    const BallCalibration taken_for_fixed = calibrate_from_balls(paths, {.fixed_camera = true});
    EXPECT_GT(mean_error_deg(taken_for_fixed, lights), 2 * mean_error_deg(moved, lights));
    EXPECT_FALSE(taken_for_fixed.drifts.moved);
    EXPECT_THAT(taken_for_fixed.poor,
                Contains(AllOf(HasSubstr("--fixed-camera says"),
                               HasSubstr(fmt::format("{:.2f} pixels (rms)", moved.drifts.rms_px)))));
}

TEST(MirrorBall, IsTakenFromACameraThatIsSaidToBeFixedAndIs) {
    const TestDir dir;
    const auto lights = lights_around(8);
    const auto paths = write_ball_photos(dir.path(), BallScene{}, lights);
    const BallCalibration c = calibrate_from_balls(paths, {.fixed_camera = true});
    EXPECT_LT(mean_error_deg(c, lights), 0.4);
    EXPECT_THAT(c.poor, testing::IsEmpty());
    EXPECT_THAT(c.warnings, testing::Each(testing::Not(HasSubstr("--fixed-camera"))));
}

// It is no motion of the camera, and the light of no photograph.
TEST(BallCalibration, NamesAPhotographOfSomethingElse) {
    const TestDir dir;
    const auto paint = [](int photo, Image<float>& picture) {
        if (photo != 3) return;
        for (int y = 0; y < picture.height(); ++y)
            for (int x = 0; x < picture.width(); ++x)
                picture(x, y) = (x + y) / 15 % 2 == (x + 300 - y) / 17 % 2 ? 0.3f : 0.1f;
    };
    auto paths = write_ball_photos(dir.path(), BallScene{}, lights_around(8), false, {}, paint);
    try {
        (void)calibrate_from_balls(paths, {});
        ADD_FAILURE() << "not named";
    } catch (const PhotoError& error) {
        EXPECT_EQ(error.path(), paths[3]);
        EXPECT_THAT(error.what(), HasSubstr("shows something else than the other photographs"));
    }
    paths.erase(paths.begin() + 3);
    EXPECT_FALSE(calibrate_from_balls(paths, {}).drifts.moved);
}

TEST(MirrorBalls, TellPositionsInPerspective) {
    const TestDir dir;
    const NearScene near;
    const auto paths = write_ball_photos(dir.path(), near.scene, near.in_radii, true);
    const BallCalibration c = calibrate_from_balls(
        paths, {.ball_radius_mm = 15, .focal_px = 1000, .camera_distance_mm = 600, .ball_height_mm = 15});
    ASSERT_EQ(c.balls.size(), 2u);
    ASSERT_EQ(c.calibrated(), 8);
    double sum = 0;
    for (std::size_t i = 0; i < near.lamps_mm.size(); ++i) {
        ASSERT_TRUE(c.lights[i].position_mm);
        const double error = glm::length(*c.lights[i].position_mm - near.lamps_mm[i]);
        sum += error / 8;
        EXPECT_LT(error, 4 * glm::length(c.lights[i].position_sigma_mm)) << i;
    }
    EXPECT_LT(sum, 6);
    EXPECT_LT(mean_error_deg(c, near.lamps_mm), 0.5);
    // Without the radius there are directions, from the picture's middle all the same, and no lengths.
    const BallCalibration unscaled = calibrate_from_balls(paths, {.focal_px = 1000});
    EXPECT_LT(mean_error_deg(unscaled, near.lamps_mm), 1.5);
    for (const CalibratedLight& light : unscaled.lights) EXPECT_FALSE(light.position_mm);
}

TEST(MirrorBall, IsMissingWhereOneIsSaidToBe) {
    const TestDir dir;
    const auto paths = write_ball_photos(dir.path(), BallScene{}, lights_around(5));
    EXPECT_THAT(error_of([&] { calibrate_from_balls(paths, {.balls = {circle(250, 60, 25)}}); }),
                AllOf(HasSubstr("--sphere 250,60,25: no mirror ball there"), HasSubstr("0 of 5")));
    // One that is there is used all the same.
    const BallCalibration c =
        calibrate_from_balls(paths, {.balls = {circle(250, 60, 25), circle(140, 106, 40)}});
    EXPECT_EQ(c.calibrated(), 5);
    EXPECT_EQ(c.balls.size(), 1u);
    EXPECT_THAT(c.warnings, Contains(HasSubstr("--sphere 250,60,25: no mirror ball there")));
    EXPECT_THAT(
        error_of([&] { calibrate_from_balls(paths, {.balls = {circle(900, 60, 25)}}); }),
        HasSubstr("--sphere 900,60,25: its centre does not lie in the photographs, which are 300 x 220"));
}

// Something round with glossy spots all over it is not one, and the result says that it is doubtful.
TEST(MirrorBall, IsDoubtedWhereItsHighlightsComeFromBehindThePainting) {
    const TestDir dir;
    BallScene scene;
    scene.strength = 0;
    const auto paths = write_ball_photos(
        dir.path(), scene, lights_around(12), false, {}, [](int photo, Image<float>& picture) {
            const double angle = 2.4 * photo, radius = 36 * std::sqrt((photo + 0.5) / 12);
            paint_spot(picture, 140.3 + radius * std::cos(angle), 105.7 + radius * std::sin(angle), 2.5,
                       0.8f);
        });
    const BallCalibration c = calibrate_from_balls(paths, {.balls = {circle(140, 106, 40)}});
    EXPECT_THAT(c.poor, testing::Contains(HasSubstr("lamps behind the painting")));
}

TEST(MirrorBall, IsNotFoundInPhotographsWithoutOne) {
    const TestDir dir;
    BallScene empty;
    empty.balls.clear();
    const auto paths = write_ball_photos(dir.path(), empty, lights_around(5));
    EXPECT_THAT(error_of([&] { calibrate_from_balls(paths, {}); }),
                AllOf(HasSubstr("no mirror ball found"), HasSubstr("--sphere X,Y,R")));
}

// Photograph 3 of 8 is spoilt; it alone is left out, and the warning names it and says why.
struct Spoilt {
    std::string name, said;
    ChangeScene change;
    ChangePicture paint;
};

TEST(MirrorBall, LeavesOutPhotographsWhoseHighlightIsNone) {
    const auto at3 = [](auto action) {
        return [action](int i, auto& what) {
            if (i == 3) action(what);
        };
    };
    const Spoilt all[] = {
        {"absent", "no highlight on it", at3([](BallScene& s) { s.strength = 0; }), {}},
        {"off the ball", "off the ball or across its outline", at3([](BallScene& s) { s.strength = 0; }),
         at3([](Image<float>& p) { paint_spot(p, 140.3 + 45, 105.7, 2.5); })},
        {"across the outline", "off the ball or across its outline",
         at3([](BallScene& s) { s.strength = 0; }),
         at3([](Image<float>& p) { paint_spot(p, 140.3 + 39.5, 105.7, 3); })},
        {"clipped",
         "clipped over too large a part of the ball",
         at3([](BallScene& s) { s.strength = 4000; }),
         {}},
        {"two", "two highlights of about the same brightness", at3([](BallScene& s) { s.strength = 0; }),
         at3([](Image<float>& p) {
             paint_spot(p, 130, 100, 3);
             paint_spot(p, 155, 112, 3);
         })}};
    const auto lights = lights_around(8, 40);
    for (const Spoilt& spoilt : all) {
        SCOPED_TRACE(spoilt.name);
        const TestDir dir;
        const auto paths =
            write_ball_photos(dir.path(), BallScene{}, lights, false, spoilt.change, spoilt.paint);
        const BallCalibration c = calibrate_from_balls(paths, {.fixed_camera = true});
        EXPECT_EQ(c.calibrated(), 7);
        EXPECT_FALSE(c.lights[3].direction);
        EXPECT_THAT(c.warnings, Contains(AllOf(HasSubstr("ball_03.png: left out"),
                                               HasSubstr("ball 1 at (140, 106)"), HasSubstr(spoilt.said))));
        EXPECT_LT(mean_error_deg(c, lights), 0.5);
        EXPECT_EQ(c.usable_lights().size(), 7u);
    }
}

TEST(MirrorBalls, GoOnWithOneWhereTheOtherShowsNothing) {
    const TestDir dir;
    const NearScene near;
    const auto paths =
        write_ball_photos(dir.path(), near.scene, near.in_radii, true, {}, [](int i, Image<float>& p) {
            if (i == 2) paint_spot(p, 70.4, 60.2, 20, 0.02f);
        });
    const BallCalibration c = calibrate_from_balls(
        paths, {.ball_radius_mm = 15, .focal_px = 1000, .camera_distance_mm = 600, .ball_height_mm = 15});
    ASSERT_EQ(c.calibrated(), 8);
    EXPECT_FALSE(c.lights[2].position_mm);
    EXPECT_EQ(c.lights[2].balls_used, 1);
    EXPECT_LT(degrees_between(*c.lights[2].direction, near.lamps_mm[2]), 3);
    EXPECT_THAT(c.warnings, Contains(AllOf(HasSubstr("ball_02.png: ball 1"), HasSubstr("no highlight"))));
}

TEST(BallCalibration, RefusesPhotographsOfTwoSizesAndBothFocalLengths) {
    const TestDir dir;
    auto paths = write_ball_photos(dir.path(), BallScene{}, lights_around(3));
    EXPECT_THAT(error_of([&] { calibrate_from_balls(paths, {.focal_px = 1000, .focal_35mm = 50}); }),
                HasSubstr("not both"));
    write_map(paths[1], Image<float>(299, 220, 0.5f));
    EXPECT_THAT(error_of([&] { calibrate_from_balls(paths, {}); }),
                AllOf(HasSubstr("ball_01.png: is 299 x 220"), HasSubstr("the same size")));
}

}  // namespace
}  // namespace tangi
