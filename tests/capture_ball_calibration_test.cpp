// Lights from balls: rendered with known lights, and everything that can be wrong with them.
#include "capture/ball_calibration.h"

#include <gmock/gmock.h>

#include <iostream>

#include "ball_pictures.h"
#include "capture/ball_sizes.h"
#include "capture/calibration_page.h"
#include "capture/left_out.h"
#include "surface/atomic_file.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

double mean_error_deg(const BallCalibration& c, const std::vector<dvec3>& truth) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (c.lights[i].direction) sum += degrees_between(*c.lights[i].direction, truth[i]) / c.calibrated();
    return sum;
}

GivenBall circle(double x, double y, double r) {
    return {{x, y}, r, false, fmt::format("{},{},{}", x, y, r)};
}

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

// A glossy bump shows where the lamps are, too; the ball is the one of the size that numbers or most of what
// is seen speak for.
struct BallAndBumps {
    TestDir dir;
    std::vector<std::filesystem::path> paths;

    BallAndBumps() {
        BallScene scene;
        // Where no photograph shows a highlight alone, nothing starts the search for the ball itself.
        scene.balls = {{{100.3, 105.7}, 32, 0, 0}, {{230.2, 60.4}, 11, 0, 0}};
        paths = write_ball_photos(dir.path(), scene, lights_around(9));
    }
};

TEST(MirrorBall, IsOfTheSizeThatNumbersSay) {
    const BallAndBumps scene;
    const auto found = [&](std::optional<double> mm_per_pixel) {
        BallCalibrationOptions options;
        options.ball_radius_mm = 10;
        options.mm_per_pixel = mm_per_pixel;
        return calibrate_from_balls(scene.paths, options);
    };
    for (const double radius_px : {32.0, 11.0}) {
        const BallCalibration c = found(10 / radius_px * 1.1);
        ASSERT_EQ(c.balls.size(), 1u);
        EXPECT_NEAR(c.balls[0].image.radius_px, radius_px, 0.5);
        EXPECT_THAT(c.warnings, Contains(AllOf(HasSubstr("is taken for no mirror ball"),
                                               HasSubstr("as the numbers that are given say"))));
    }
    // Numbers that nothing agrees with decide nothing.
    EXPECT_EQ(found(10 / 70.0).balls.size(), 1u);
}

TEST(BallSizes, FollowFromWhatIsGiven) {
    EXPECT_FALSE(expected_radius_px({.ball_radius_mm = 12, .focal_px = 1400}, 700, 500));
    EXPECT_NEAR(*expected_radius_px({.ball_radius_mm = 12, .mm_per_pixel = 0.5}, 700, 500), 24, 1e-9);
    EXPECT_NEAR(*expected_radius_px({.ball_radius_mm = 12,
                                     .mm_per_pixel = 0.5,
                                     .focal_px = 1400,
                                     .camera_distance_mm = 600,
                                     .ball_height_mm = 40},
                                    700, 500),
                30, 1e-9);
    // 43.27 mm are the diagonal.
    EXPECT_NEAR(*expected_radius_px({.ball_radius_mm = 10, .focal_35mm = 43.2666, .camera_distance_mm = 510},
                                    300, 400),
                10, 1e-3);
}

TEST(BallSizes, KeepThoseThatMostSpeaksFor) {
    const auto ball = [](double radius_px, double coverage) {
        FoundBall result;
        result.image.radius_px = radius_px;
        result.outline_coverage = coverage;
        result.highlights.resize(4);
        for (Highlight& h : result.highlights) h.state = HighlightState::found;
        return result;
    };
    BallSearch search{{ball(9, 0.9), ball(28, 0.8), ball(31, 0.6)}, {}, {}};
    keep_one_size(search, {});
    ASSERT_EQ(search.balls.size(), 2u);
    EXPECT_EQ(search.balls[0].image.radius_px, 28);
    EXPECT_THAT(search.warnings, Contains(HasSubstr("9.0 pixels in radius")));
    BallSearch other{{ball(9, 0.9), ball(28, 0.8), ball(31, 0.6)}, {}, {}};
    keep_one_size(other, 10);
    ASSERT_EQ(other.balls.size(), 1u);
    EXPECT_EQ(other.balls[0].image.radius_px, 9);
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

TEST(MattBall, TellsDirectionsAndItsTransferCurve) {
    const auto lights = lights_around(8, 45);
    for (const Transfer& transfer : {Transfer{}, Transfer{Transfer::Kind::srgb}}) {
        const TestDir dir;
        BallScene scene;
        scene.matt = true;
        scene.transfer = transfer;
        const auto paths = write_ball_photos(dir.path(), scene, lights);
        const BallCalibration c = calibrate_from_balls(paths, {.matt = true});
        ASSERT_EQ(c.calibrated(), 8);
        EXPECT_EQ(c.matt_transfer->name(), transfer.name());
        EXPECT_LT(mean_error_deg(c, lights), 0.6);
        EXPECT_NEAR(c.shadings[0]->brightness, 0.6, 0.03);
    }
}

TEST(MattBall, IsWhereAnIdealCameraWouldSeeIt) {
    const TestDir dir;
    BallScene scene;
    scene.matt = true;
    scene.camera.focal_px = 400;
    scene.balls = {{{235, 60}, 40, 0, 0}};
    scene.lens = Lens{scene.width, scene.height, {400, 400}, scene.camera.principal_px, {-0.6, 0.2, 0, 0}};
    const auto lights = lights_around(6, 45);
    const auto paths = write_ball_photos(dir.path(), scene, lights);
    const BallCalibration without = calibrate_from_balls(paths, {.matt = true, .focal_px = 400}),
                          with = calibrate_from_balls(paths,
                                                      {.matt = true, .focal_px = 400, .lens = scene.lens});
    std::cout << fmt::format(
        "[  FIGURE  ] matt ball under a lens: {:.2f} deg, distortion left in {:.2f} deg\n",
        mean_error_deg(with, lights), mean_error_deg(without, lights));
    EXPECT_LT(mean_error_deg(with, lights), 0.6);
    EXPECT_GT(mean_error_deg(without, lights), 1);
    EXPECT_EQ(with.balls[0].image.centre_px, without.balls[0].image.centre_px);  // as the photographs show it
}

TEST(MattBall, IsNotFoundWhereNothingIsShadedLikeOne) {
    const TestDir dir;
    const auto paths = write_ball_photos(dir.path(), BallScene{}, lights_around(5));
    EXPECT_THAT(error_of([&] { calibrate_from_balls(paths, {.matt = true}); }),
                HasSubstr("no matt ball found"));
    EXPECT_THAT(
        error_of([&] { calibrate_from_balls(paths, {.balls = {circle(140, 106, 40)}, .matt = true}); }),
        HasSubstr("no matt ball at --sphere 140,106,40"));
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

// Mean angle to the lights of the University of Washington, whose photographs are <ball>.<number>.tga.
double mean_error_deg(const BallCalibration& calibration, const std::filesystem::path& lights,
                      const std::string& ball) {
    std::ifstream file(lights);
    int count = 0;
    file >> count;
    double sum = 0;
    int found = 0;
    for (int i = 0; i < count; ++i) {
        dvec3 truth;
        file >> truth.x >> truth.y >> truth.z;
        for (const CalibratedLight& light : calibration.lights)
            if (light.name == fmt::format("{}.{}.tga", ball, i)) {
                sum += degrees_between(light.direction.value_or(dvec3(0, 0, -1)), truth);
                ++found;
            }
    }
    EXPECT_EQ(found, count);
    return sum / count;
}

// The real balls of the University of Washington, and of the handheld set.

TEST(DataMirrorBall, ChromeAgreesWithItsLights) {
    TP_DATA(folder, "spheres");
    std::vector<std::string> warnings;
    const BallCalibration c = calibrate_from_balls(pictures_in(folder / "chrome", warnings), {});
    EXPECT_THAT(warnings, Contains(HasSubstr("mask")));
    EXPECT_LE(mean_error_deg(c, folder / "lights.txt", "chrome"), 3.5);
}

// Around the ball it is as dark as what a code is worth, which tells nothing of lamps.
TEST(DataMirrorBall, ChromeIsFoundInParts) {
    TP_DATA(folder, "spheres");
    std::vector<std::string> warnings;
    const std::vector<std::filesystem::path> all = pictures_in(folder / "chrome", warnings);
    Random random(5);
    for (std::size_t turn = 0; turn < 4; ++turn) {
        std::vector<std::filesystem::path> part = all;
        while (part.size() > (turn < 2 ? 11u : 8u))  // without chrome.0, without chrome.4, and at random
            part.erase(part.begin() + static_cast<std::ptrdiff_t>(
                                          turn == 0 ? 0
                                          : turn == 1
                                              ? 6
                                              : random.uniform(0, static_cast<double>(part.size()) - 1e-9)));
        const BallCalibration c = calibrate_from_balls(part, {});
        ASSERT_EQ(c.balls.size(), 1u);
        EXPECT_NEAR(c.balls[0].image.radius_px, 118.9, 1);
    }
}

// Half of the photographs, in which a bump of the painting glitters as a ball would.
TEST(DataMirrorBalls, HandheldAreFoundBesideABump) {
    TP_DATA(folder, "handheld");
    std::vector<std::string> warnings;
    std::vector<std::filesystem::path> half = pictures_in(folder / "png16", warnings);
    half.resize(12);
    const BallCalibration c = calibrate_from_balls(half, {});
    ASSERT_EQ(c.balls.size(), 2u);
    for (const FoundBall& ball : c.balls) EXPECT_NEAR(ball.image.radius_px, 28.4, 1);
    EXPECT_THAT(c.warnings, Contains(HasSubstr("balls are of one size")));
}

TEST(DataMattBall, GrayAgreesWithItsLights) {
    TP_DATA(folder, "spheres");
    std::vector<std::string> warnings;
    const BallCalibration c = calibrate_from_balls(pictures_in(folder / "gray", warnings), {.matt = true});
    EXPECT_EQ(c.matt_transfer->name(), "linear");
    EXPECT_LE(mean_error_deg(c, folder / "lights.txt", "gray"),
              4.5);  // lights.txt is itself some 3 degrees from the chrome ball's highlights
}

TEST(DataMirrorBalls, HandheldLampsAreWhereTheyWere) {
    TP_DATA(folder, "handheld");
    std::vector<std::string> warnings;
    const BallCalibration c = calibrate_from_balls(pictures_in(folder / "png16", warnings),
                                                   {.ball_radius_mm = 12,
                                                    .focal_px = 1408,
                                                    .principal_px = dvec2(351.5, 263.5),
                                                    .origin_px = dvec2(351.5 - 17 * 1408 / 600.0, 263.5),
                                                    .camera_distance_mm = 600,
                                                    .ball_height_mm = 6});
    ASSERT_EQ(c.balls.size(), 2u);
    EXPECT_EQ(c.calibrated(), 24);
    const auto truth = nlohmann::json::parse(read_text_file(folder / "gt" / "lights.json"));
    double millimetres = 0, degrees = 0;
    int positions = 0;
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        const auto& p = truth["lights"][i]["pos_mm"];
        const dvec3 lamp(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
        if (c.lights[i].position_mm) {
            ++positions;
            millimetres += glm::length(*c.lights[i].position_mm - lamp);
        }
        degrees += degrees_between(c.lights[i].direction.value_or(dvec3(0, 0, -1)), lamp) / 24;
    }
    EXPECT_EQ(positions, 24);
    EXPECT_LE(millimetres / positions, 15);
    EXPECT_LE(degrees, 1);
}

// Real stacks without balls: what glitters in them is not taken for one.
TEST(DataMirrorBall, IsNotFoundInPaintings) {
    for (const char* name : {"real/icon", "real/coin"}) {
        TP_DATA(folder, name);
        std::vector<std::string> warnings;
        EXPECT_THAT(
            error_of([&] { calibrate_from_balls(pictures_in(folder, warnings), {.fixed_camera = true}); }),
            HasSubstr("no mirror ball found"));
    }
}

}  // namespace
}  // namespace tangi
