// plane_calibration_test.cpp: scale, tilt and rectification of a plane whose truth is known.
#include "capture/calibration/plane_calibration.h"

#include <gmock/gmock.h>

#include "capture/formats/capture_file.h"
#include "capture/geometry/plane_pose.h"
#include "tests/support/capture/marker_pictures.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;
using testing::HasSubstr;

// A camera with a focal length of 1600 pixels, 520 mm away, that looks at (4, -3) of the plane from aside.
struct View {
    dmat3 to_camera;  // of vectors of the plane's frame; x right, y up, z away from the scene
    dvec3 camera_mm;
    Homography homography{1};  // plane -> pixels
    explicit View(double tilt_x, double tilt_y, double roll) {
        const auto turn = [](double angle, int a, int b) {
            dmat3 m(1);
            m[a][a] = m[b][b] = std::cos(angle);
            m[a][b] = std::sin(angle);
            m[b][a] = -std::sin(angle);
            return m;
        };
        to_camera = turn(roll, 0, 1) * turn(tilt_y, 0, 2) * turn(tilt_x, 1, 2);
        camera_mm = dvec3(4, -3, 0) + glm::transpose(to_camera) * dvec3(0, 0, 520);
        const dmat3 k(1600, 0, 0, 0, -1600, 0, -399.5, -299.5, -1);  // of points with z < 0
        const dvec3 origin = to_camera * -camera_mm;
        homography = k * dmat3(to_camera[0], to_camera[1], origin);
    }
};

std::filesystem::path photograph(const TestDir& dir, const Homography& h,
                                 int dictionary = cv::aruco::DICT_4X4_50) {
    auto path = dir / "photo_000.png";
    write_picture(path, picture_of(kFour, dictionary, h, 0.004), {Transfer::Kind::srgb});
    return path;
}

TEST(PlaneCalibration, ThePoseOfAPlaneIsThatOfTheCameraThatSawIt) {
    for (const View& view : {View(0, 0, 0), View(0.2, -0.1, 0.05), View(-0.4, 0.3, 1.2)}) {
        for (const double sign : {1.0, -1.0, 0.3}) {
            const PlanePose pose = pose_of(sign * view.homography, 1600, {399.5, 299.5});
            EXPECT_LT(glm::length(pose.camera - view.camera_mm), 1e-8);
            for (int c = 0; c < 3; ++c)
                EXPECT_LT(glm::length(pose.turn[c] - glm::transpose(view.to_camera)[c]), 1e-10);
            EXPECT_NEAR(std::cos(pose.tilt_deg * std::numbers::pi / 180), view.to_camera[2].z, 1e-10);
            EXPECT_NEAR(pose.stretch, 1, 1e-10);
        }
    }
    // The plane's height taken for 10 % more than it is.
    const PlanePose pose =
        pose_of(View(0, 0, 0).homography * Homography(1, 0, 0, 0, 1 / 1.1, 0, 0, 0, 1), 1600, {399.5, 299.5});
    EXPECT_NEAR(pose.stretch, 1.1, 1e-9);
}

// Lights are known in the camera's frame, as spheres tell them; the picture's frame is the painting's.
TP_LONG TEST(PlaneCalibration, MarkersRectifyAndCarryLightsAndCameraIntoThePaintingsFrame) {
    const View view(0.22, -0.12, 0.04);
    const TestDir dir;
    const std::vector<std::filesystem::path> photos = {photograph(dir, view.homography)};
    const PlaneCalibration c =
        calibrate_plane(photos, {.marker_mm = kSide_mm, .rectify = true, .focal_px = 1600}, nullptr);
    EXPECT_EQ(c.rectified_by, "markers");
    EXPECT_EQ(c.markers.markers.size(), 4u);
    EXPECT_EQ(c.markers_in, "photo_000.png");
    ASSERT_TRUE(c.geometry && c.geometry->mm_per_pixel && c.geometry->camera_mm && c.tilt_deg);
    const double tilt = std::acos(view.to_camera[2].z) * 180 / std::numbers::pi;
    EXPECT_NEAR(*c.tilt_deg, tilt, 0.4);
    EXPECT_GT(c.tilt_sigma_deg, 0.005);
    EXPECT_LT(c.tilt_sigma_deg, 0.6);
    const PictureGeometry& g = *c.geometry;
    // Distances on the plane are right everywhere in the picture.
    const dmat3 to_plane = glm::inverse(view.homography);
    const auto on_plane = [&](const dvec2& pixel) { return mapped(to_plane, g.place_in_photo(pixel)); };
    for (const dvec2 a : {dvec2(100, 100), dvec2(500, 120), dvec2(150, 450)})
        for (const dvec2 step : {dvec2(100, 0), dvec2(0, 100)})
            EXPECT_NEAR(glm::length(on_plane(a + step) - on_plane(a)) / (100 * *g.mm_per_pixel), 1, 4e-3);
    // What is level in the photographs' middle is level in the picture.
    const dvec2 middle = g.place_in_picture({399.5, 299.5}), right = g.place_in_picture({400.5, 299.5});
    EXPECT_NEAR(right.y, middle.y, 1e-6);
    EXPECT_GT(right.x, middle.x);
    // All of the photograph is in the picture, which has black corners.
    EXPECT_LT(c.photo_outside, 0.01);
    EXPECT_GT(c.picture_outside, 0.02);
    EXPECT_LT(c.picture_outside, 0.5);

    // The picture's frame: origin at its centre, x to the right in it.
    const dvec2 centre((g.width - 1) / 2.0, (g.height - 1) / 2.0);
    const dvec2 origin = on_plane(centre), x = glm::normalize(on_plane(centre + dvec2(1, 0)) - origin);
    const auto in_picture_frame = [&](const dvec3& v) {
        return dvec3(glm::dot(dvec2(v), x), glm::dot(dvec2(v), dvec2(-x.y, x.x)), v.z);
    };
    EXPECT_LT(glm::length(*g.camera_mm - in_picture_frame(view.camera_mm - dvec3(origin, 0))), 5);
    CaptureFile capture;
    capture.width = 800, capture.height = 600;
    capture.origin_px = {380, 290};
    // As calibration from spheres has it: the camera straight above the origin's surroundings, in any height.
    capture.camera_mm = Vec3(12, -7, 530);
    capture.geometry = g;
    const std::vector<dvec3> lights = {{300, 100, 400}, {-200, 250, 350}, {50, -300, 500}};  // plane's frame
    for (const dvec3& light : lights)
        capture.lights.push_back(
            near_light(*capture.camera_mm + Vec3(view.to_camera * (light - view.camera_mm))));
    const CaptureFile carried = in_picture(capture);
    EXPECT_EQ(carried.width, g.width);
    EXPECT_EQ(carried.mm_per_pixel, g.mm_per_pixel);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const dvec3 truth = in_picture_frame(lights[i] - dvec3(origin, 0));
        ASSERT_TRUE(carried.lights[i].position_mm);
        EXPECT_LT(glm::length(dvec3(*carried.lights[i].position_mm) - truth), 5) << i;
        EXPECT_LT(glm::length(dvec3(carried.lights[i].direction) - glm::normalize(truth)), 0.01) << i;
    }
    // Distant lights turn alone.
    for (Light& light : capture.lights) light.position_mm.reset();
    capture.lights[0].direction = Vec3(view.to_camera * glm::normalize(dvec3(0.3, 0.2, 0.9)));
    EXPECT_LT(glm::length(dvec3(in_picture(capture).lights[0].direction) -
                          in_picture_frame(glm::normalize(dvec3(0.3, 0.2, 0.9)))),
              0.01);
}

TEST(PlaneCalibration, CornersMakeAPictureOfThePaintingAlone) {
    const View view(0.2, 0.1, 0.3);
    const TestDir dir;
    const std::vector<std::filesystem::path> photos = {photograph(dir, view.homography)};
    const Corners corners = {mapped(view.homography, {-60, 40}), mapped(view.homography, {60, 40}),
                             mapped(view.homography, {60, -40}), mapped(view.homography, {-60, -40})};
    for (const bool by_markers : {false, true}) {
        PlaneOptions options{.corners_px = corners, .rectify = true, .focal_px = 1600};
        if (by_markers)
            options.marker_mm = kSide_mm;
        else
            options.painting_mm = dvec2(120, 80);
        const PlaneCalibration c = calibrate_plane(photos, options, nullptr);
        EXPECT_EQ(c.rectified_by, "corners");
        EXPECT_NEAR(c.geometry->width * *c.geometry->mm_per_pixel, 120, 0.5);
        EXPECT_NEAR(c.geometry->height * *c.geometry->mm_per_pixel, 80, 0.5);
        const dvec2 top_left = c.geometry->place_in_photo({-0.5, -0.5});
        EXPECT_LT(glm::length(top_left - corners[0]), 0.5);
        EXPECT_NEAR(c.picture_outside, 0, 1e-9);
        EXPECT_GT(c.photo_outside, 0.2);
        EXPECT_LT(glm::length(*c.geometry->camera_mm - view.camera_mm), by_markers ? 4 : 0.1);
    }
}

TEST(PlaneCalibration, TheMostCertainScaleIsUsedAndADisagreementIsTold) {
    const View view(0, 0, 0);
    const TestDir dir;
    const std::vector<std::filesystem::path> photos = {photograph(dir, view.homography)};
    const double truth = 520.0 / 1600;
    const auto bar = [&](double length_mm) {
        return PlaneOptions{.bar = ScaleBar{{100, 300}, {500, 300}, length_mm}, .marker_mm = kSide_mm};
    };
    const PlaneCalibration c = calibrate_plane(photos, bar(400 * truth), nullptr);
    ASSERT_EQ(c.scales.size(), 2u);
    EXPECT_LE(c.scales[0].sigma / c.scales[0].mm_per_pixel, c.scales[1].sigma / c.scales[1].mm_per_pixel);
    EXPECT_NEAR(c.scale()->mm_per_pixel, truth, 2e-3 * truth);
    EXPECT_THAT(c.warnings, testing::IsEmpty());
    EXPECT_FALSE(c.geometry);
    EXPECT_THAT(c.poor, testing::IsEmpty());
    EXPECT_THAT(calibrate_plane(photos, bar(420 * truth), nullptr).poor,
                testing::ElementsAre(HasSubstr("mm per pixel")));
    EXPECT_NEAR(calibrate_plane(photos, {.pixels_per_inch = 300}, nullptr).scale()->mm_per_pixel, 25.4 / 300,
                1e-9);
}

using Paths = std::vector<std::filesystem::path>;

// What one photograph alone shows is texture that looks like a marker.
TEST(PlaneCalibration, MarkersAreSeenTwice) {
    const View view(0.1, 0, 0);
    const TestDir dir;
    const auto path = photograph(dir, view.homography);
    write_picture(dir / "photo_001.png", Image<Rgb>(800, 600, Rgb(0.4f)), {Transfer::Kind::srgb});
    EXPECT_THAT(
        error_of([&] {
            (void)calibrate_plane(Paths{path, dir / "photo_001.png"}, {.marker_mm = kSide_mm}, nullptr);
        }),
        HasSubstr("no ArUco marker is found in any two of the 2 photographs"));
    std::filesystem::copy_file(path, dir / "photo_002.png");
    const PlaneCalibration c = calibrate_plane(Paths{path, dir / "photo_001.png", dir / "photo_002.png"},
                                               {.marker_mm = kSide_mm}, nullptr);
    EXPECT_EQ(c.markers.markers.size(), kFour.size());
    // Nor is another dictionary than the wanted one proposed for the sake of one photograph.
    const auto refusal = [&](const Paths& photos) {
        return error_of(
            [&] { (void)calibrate_plane(photos, {.marker_mm = kSide_mm, .dictionary = "7x7_50"}, nullptr); });
    };
    EXPECT_THAT(refusal({path, dir / "photo_001.png"}), HasSubstr("no ArUco marker is found in any two"));
    EXPECT_THAT(refusal({path, dir / "photo_001.png", dir / "photo_002.png"}),
                testing::AllOf(HasSubstr("no marker of dictionary 7x7_50, but 4 of dictionary"),
                               HasSubstr("ask for that one")));
}

TEST(PlaneCalibration, RefusesWhatCannotBe) {
    const View view(0.1, 0, 0);
    const TestDir dir;
    const std::vector<std::filesystem::path> photos = {
        photograph(dir, view.homography, cv::aruco::DICT_5X5_50)};
    const auto refusal = [&](const PlaneOptions& options) {
        return error_of([&] { (void)calibrate_plane(photos, options, nullptr); });
    };
    EXPECT_THAT(refusal({.marker_mm = 25, .dictionary = "4x4_50"}),
                testing::AllOf(HasSubstr("photo_000.png"), HasSubstr("5x5_50")));
    EXPECT_THAT(refusal({.marker_mm = 25, .dictionary = "9x9"}), HasSubstr("no dictionary"));
    EXPECT_THAT(refusal({.rectify = true}), HasSubstr("--rectify: by what?"));
    write_bytes(dir / "lens.yml", "%YAML:1.0\n---\nimage_width: 640\n");
    EXPECT_THAT(refusal({.lens = dir / "lens.yml"}), HasSubstr("camera_matrix"));
    const Corners mirrored = {dvec2(500, 100), dvec2(100, 100), dvec2(100, 400), dvec2(500, 400)};
    EXPECT_THAT(refusal({.corners_px = mirrored, .painting_mm = dvec2(120, 80), .rectify = true}),
                HasSubstr("anticlockwise"));
    const TestDir empty;
    write_picture(empty / "none.png", Image<Rgb>(64, 48, Rgb(0.4f)), Transfer{});
    const std::vector<std::filesystem::path> none = {empty / "none.png"};
    EXPECT_THAT(error_of([&] { (void)calibrate_plane(none, {.marker_mm = 25}, nullptr); }),
                HasSubstr("no ArUco marker"));
}

// Undoing a lens's distortion moves a few per cent out of the picture; of a wrong file much more.
TEST(PlaneCalibration, OfALensThatMovesMuchOutOfThePictureIsPoor) {
    const TestDir dir;
    write_picture(dir / "photo.png", Image<Rgb>(640, 480, Rgb(0.4f)), Transfer{});
    const std::vector<std::filesystem::path> photos = {dir / "photo.png"};
    const auto with = [&](double k1, double k2) {
        write_bytes(dir / "lens.yml",
                    fmt::format("%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n"
                                "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                                "   data: [ 500., 0., 319.5, 0., 500., 239.5, 0., 0., 1. ]\n"
                                "distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n"
                                "   data: [ {}, {}, 0., 0. ]\n",
                                k1, k2));
        return calibrate_plane(photos, {.lens = dir / "lens.yml"}, nullptr).poor;
    };
    EXPECT_THAT(with(-0.12, 0.02), testing::IsEmpty());
    EXPECT_THAT(with(-0.3, 0.05), testing::ElementsAre(HasSubstr("% of the photographs lie outside")));
    EXPECT_THAT(with(0.5, 0), testing::ElementsAre(HasSubstr("lens.yml")));
}

}  // namespace
}  // namespace tangi
