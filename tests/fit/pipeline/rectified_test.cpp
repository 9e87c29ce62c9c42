// rectified_test.cpp: a painting photographed from aside, through a lens, fitted upright.
#include <gmock/gmock.h>

#include <glm/matrix.hpp>

#include "capture/calibration/calibration_page.h"
#include "fit/evaluate/compare.h"
#include "fit/pipeline/fit_painting.h"
#include "surface/render/relight.h"
#include "tests/support/fit/fit_test_support.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr int kPhotoWidth = 150, kPhotoHeight = 120, kPaintedWidth = 90, kPaintedHeight = 66;
constexpr double kPitch_mm = 0.5, kFocal_px = 420, kTilt = 0.25;

// Waves of 10 degrees in a pattern of colours, matt.
Surface painted() {
    Surface s(kPaintedWidth, kPaintedHeight);
    s.mm_per_pixel = kPitch_mm;
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            const float u = 0.12f * static_cast<float>(x), v = 0.1f * static_cast<float>(y);
            s.confidence(x, y) = 1;
            s.normal(x, y) = normal_of({0.2f * std::sin(u), 0.2f * std::cos(v)});
            s.diffuse(x, y) = {0.5f + 0.2f * std::sin(v), 0.45f + 0.2f * std::cos(u), 0.4f};
        }
    return s;
}

// Turned about y by kTilt, 200 mm away: painting's frame -> camera's frame.
const dmat3 kToCamera(std::cos(kTilt), 0, std::sin(kTilt), 0, 1, 0, -std::sin(kTilt), 0, std::cos(kTilt));
const Lens kLens{kPhotoWidth,
                 kPhotoHeight,
                 {kFocal_px, kFocal_px},
                 {(kPhotoWidth - 1) / 2.0, (kPhotoHeight - 1) / 2.0},
                 {-0.3, 0.1, 0, 0}};

Homography seen() {
    const dmat3 k(kFocal_px, 0, 0, 0, -kFocal_px, 0, -kLens.principal_px.x, -kLens.principal_px.y, -1);
    return k * dmat3(kToCamera[0], kToCamera[1], dvec3(0, 0, -200));
}

Rgb sampled(const Image<Rgb>& picture, const dvec2& p) {
    const int x = std::clamp(static_cast<int>(std::floor(p.x)), 0, picture.width() - 2);
    const int y = std::clamp(static_cast<int>(std::floor(p.y)), 0, picture.height() - 2);
    const auto fx = static_cast<float>(p.x - x), fy = static_cast<float>(p.y - y);
    return glm::mix(glm::mix(picture(x, y), picture(x + 1, y), fx),
                    glm::mix(picture(x, y + 1), picture(x + 1, y + 1), fx), fy);
}

// Photographs of the painting on a grey table; lights in the camera's frame, as a sphere beside it tells
// them.
struct Aside {
    TestDir dir;
    Surface truth = painted();
    Calibration calibration;
    Aside() {
        std::vector<Light> in_camera;
        std::vector<std::filesystem::path> paths;
        const dmat3 to_plane = glm::inverse(seen());
        for (const Light& light : dome_lights(14, 30)) {
            const Image<Rgb> relit = relight(truth, {&light, 1});
            Image<Rgb> photo(kPhotoWidth, kPhotoHeight, Rgb(0.2f));
            for (int y = 0; y < kPhotoHeight; ++y)
                for (int x = 0; x < kPhotoWidth; ++x) {
                    const dvec2 mm = mapped(to_plane, undistorted(kLens, {x, y}));
                    const dvec2 p(mm.x / kPitch_mm + (kPaintedWidth - 1) / 2.0,
                                  (kPaintedHeight - 1) / 2.0 - mm.y / kPitch_mm);
                    if (p.x > -0.5 && p.y > -0.5 && p.x < kPaintedWidth - 0.5 && p.y < kPaintedHeight - 0.5)
                        photo(x, y) = 0.8f * sampled(relit, p);
                }
            write_picture(dir / light.name, photo, Transfer{});
            paths.push_back(dir / light.name);
            in_camera.push_back(distant_light(Vec3(kToCamera * dvec3(light.direction)), light.name));
        }
        write_lights(dir / "lights.lp", in_camera);
        write_bytes(dir / "lens.yml",
                    fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n"
                                "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                                "   data: [ {}, 0., {}, 0., {}, {}, 0., 0., 1. ]\n"
                                "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 4\n"
                                "   dt: d\n   data: [ -0.3, 0.1, 0., 0. ]\n",
                                kPhotoWidth, kPhotoHeight, kFocal_px, kLens.principal_px.x, kFocal_px,
                                kLens.principal_px.y));
        const double w = kPaintedWidth * kPitch_mm / 2, h = kPaintedHeight * kPitch_mm / 2;
        Corners corners = {dvec2(-w, h), dvec2(w, h), dvec2(w, -h), dvec2(-w, -h)};
        for (dvec2& corner : corners) corner = distorted(kLens, mapped(seen(), corner));
        calibration.lights = without_spheres(paths, {.focal_px = kFocal_px});
        calibration.plane = calibrate_plane(paths,
                                            {.corners_px = corners,
                                             .painting_mm = dvec2(2 * w, 2 * h),
                                             .rectify = true,
                                             .lens = dir / "lens.yml"},
                                            nullptr);
        write_calibration(dir / "capture.json", calibration);
    }
    Stack open() const {
        StackOptions options{.transfer = Transfer{}};
        options.capture_file = dir / "capture.json";
        return open_stack(dir.path(), options);
    }
};

// Mean angle to the true normals [deg], away from the border.
double normals_error(const Surface& fitted, const Surface& truth) {
    double sum = 0;
    int count = 0;
    for (int y = 4; y < fitted.height() - 4; ++y)
        for (int x = 4; x < fitted.width() - 4; ++x, ++count) {
            const int tx = static_cast<int>(std::lround((x + 0.5) * truth.width() / fitted.width() - 0.5));
            const int ty = static_cast<int>(std::lround((y + 0.5) * truth.height() / fitted.height() - 0.5));
            const float cosine = glm::dot(fitted.normal(x, y), truth.normal(tx, ty));
            sum += std::acos(std::min(cosine, 1.0f)) * 180 / std::numbers::pi;
        }
    return sum / count;
}

TP_LONG TEST(Rectified, APaintingSeenFromAsideIsFittedInItsOwnFrame) {
    const Aside aside;
    EXPECT_NEAR(*aside.calibration.plane->tilt_deg, kTilt * 180 / std::numbers::pi, 0.1);
    EXPECT_FALSE(std::filesystem::exists(aside.dir / "capture.lp"));  // no lights of its own
    const Stack stack = aside.open();
    ASSERT_TRUE(stack.geometry);
    EXPECT_NEAR(stack.width() * *stack.mm_per_pixel, kPaintedWidth * kPitch_mm, 0.5);
    EXPECT_NEAR(stack.height() * *stack.mm_per_pixel, kPaintedHeight * kPitch_mm, 0.5);
    ASSERT_TRUE(stack.camera_mm);
    EXPECT_LT(glm::length(dvec3(*stack.camera_mm) - glm::transpose(kToCamera) * dvec3(0, 0, 200)), 1);
    const FitResult fit = fit_painting(stack, {.white_level = 0.8, .lights_as_given = true});
    EXPECT_TRUE(fit.surface.scale_known);
    EXPECT_LT(normals_error(fit.surface, aside.truth), 0.8);
    EXPECT_GT(compare(fit.surface, stack).all.psnr_db, 38);

    // Lights left in the camera's frame would tilt it all.
    Stack not_carried = stack;
    for (StackPhoto& photo : not_carried.photos)
        photo.light.direction = Vec3(kToCamera * dvec3(photo.light.direction));
    EXPECT_GT(normals_error(fit_painting(not_carried, {.white_level = 0.8, .lights_as_given = true}).surface,
                            aside.truth),
              10);
}

TEST(Rectified, CropsMasksAndBandsAreThoseOfThePicture) {
    const Aside aside;
    StackOptions options{.crop = Region{20, 10, 60, 40}, .transfer = Transfer{}};
    options.capture_file = aside.dir / "capture.json";
    const Stack whole = aside.open(), part = open_stack(aside.dir.path(), options);
    const Band all = StackReader(whole).read(10, 40, Transfer{}),
               cut = StackReader(part).read(0, 30, Transfer{});
    for (int y = 0; y < 30; y += 7)
        for (int x = 0; x < 40; x += 3) EXPECT_EQ(cut.row(3, 1, y)[x], all.row(3, 1, y + 10)[x + 20]);
    // A mask is drawn on a photograph: its left half is kept.
    Image<Rgb> mask(kPhotoWidth, kPhotoHeight);
    for (int y = 0; y < kPhotoHeight; ++y)
        for (int x = 0; x < kPhotoWidth / 2; ++x) mask(x, y) = Rgb(1);
    write_picture(aside.dir / "mask.png", mask, Transfer{});
    options.crop.reset();
    options.mask_file = aside.dir / "mask.png";
    const Stack masked = open_stack(aside.dir.path(), options);
    for (int x = 0; x < masked.width(); ++x)
        EXPECT_EQ(masked.mask(x, 20) != 0,
                  std::lround(masked.geometry->place_in_photo({x, 20}).x) < kPhotoWidth / 2);
    options.mask_file.reset();
    options.crop = Region{0, 0, 5000, 40};
    EXPECT_THAT(error_of([&] { (void)open_stack(aside.dir.path(), options); }),
                testing::HasSubstr("rectified photographs"));
}

TEST(Rectified, ACaptureFileWithoutLightsNeedsThemFromElsewhere) {
    const Aside aside;
    EXPECT_THAT(
        error_of([&] { (void)open_stack(aside.dir.path(), {.lights_file = aside.dir / "capture.json"}); }),
        testing::AllOf(testing::HasSubstr("holds no light"), testing::HasSubstr("--capture")));
    StackOptions both{.lights_file = aside.dir / "capture.json"};
    both.capture_file = aside.dir / "other.json";
    std::filesystem::copy_file(aside.dir / "capture.json", aside.dir / "other.json");
    EXPECT_THAT(error_of([&] { (void)open_stack(aside.dir.path(), both); }), testing::HasSubstr("give one"));
}

}  // namespace
}  // namespace tangi
