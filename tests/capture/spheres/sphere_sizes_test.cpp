// sphere_sizes_test.cpp: of several round things that show lights, the spheres are those of one size.
#include "capture/sphere_lights/sphere_calibration.h"

#include <gmock/gmock.h>

#include "capture/spheres/sphere_sizes.h"
#include "tests/support/capture/sphere_pictures.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

// A glossy bump shows where the lights are, too; the sphere is the one of the size that numbers or most of
// what is seen speak for.
struct SphereAndBumps {
    TestDir dir;
    std::vector<std::filesystem::path> paths;

    SphereAndBumps() {
        SphereScene scene;
        // Where no photograph shows a highlight alone, nothing starts the search for the sphere itself.
        scene.spheres = {{{100.3, 105.7}, 32, 0, 0}, {{230.2, 60.4}, 11, 0, 0}};
        paths = write_sphere_photos(dir.path(), scene, lights_around(9));
    }
};

TP_LONG TEST(MirrorSphere, IsOfTheSizeThatNumbersSay) {
    const SphereAndBumps scene;
    const auto found = [&](std::optional<double> mm_per_pixel) {
        SphereCalibrationOptions options;
        options.sphere_radius_mm = 10;
        options.mm_per_pixel = mm_per_pixel;
        return calibrate_from_spheres(scene.paths, options);
    };
    for (const double radius_px : {32.0, 11.0}) {
        const SphereCalibration c = found(10 / radius_px * 1.1);
        ASSERT_EQ(c.spheres.size(), 1u);
        EXPECT_NEAR(c.spheres[0].image.radius_px, radius_px, 0.5);
        EXPECT_THAT(c.warnings, Contains(AllOf(HasSubstr("is taken for no mirror sphere"),
                                               HasSubstr("as the numbers that are given say"))));
    }
    // Numbers that nothing agrees with decide nothing.
    EXPECT_EQ(found(10 / 70.0).spheres.size(), 1u);
}

TEST(SphereSizes, FollowFromWhatIsGiven) {
    EXPECT_FALSE(expected_radius_px({.sphere_radius_mm = 12, .focal_px = 1400}, 700, 500));
    EXPECT_NEAR(*expected_radius_px({.sphere_radius_mm = 12, .mm_per_pixel = 0.5}, 700, 500), 24, 1e-9);
    EXPECT_NEAR(*expected_radius_px({.sphere_radius_mm = 12,
                                     .mm_per_pixel = 0.5,
                                     .focal_px = 1400,
                                     .camera_distance_mm = 600,
                                     .sphere_height_mm = 40},
                                    700, 500),
                30, 1e-9);
    // 43.27 mm are the diagonal.
    EXPECT_NEAR(*expected_radius_px(
                    {.sphere_radius_mm = 10, .focal_35mm = 43.2666, .camera_distance_mm = 510}, 300, 400),
                10, 1e-3);
}

TEST(SphereSizes, KeepThoseThatMostSpeaksFor) {
    const auto sphere = [](double radius_px, double coverage) {
        FoundSphere result;
        result.image.radius_px = radius_px;
        result.outline_coverage = coverage;
        result.highlights.resize(4);
        for (Highlight& h : result.highlights) h.state = HighlightState::found;
        return result;
    };
    SphereSearch search{{sphere(9, 0.9), sphere(28, 0.8), sphere(31, 0.6)}, {}, {}};
    keep_one_size(search, {});
    ASSERT_EQ(search.spheres.size(), 2u);
    EXPECT_EQ(search.spheres[0].image.radius_px, 28);
    EXPECT_THAT(search.warnings, Contains(HasSubstr("9.0 pixels in radius")));
    SphereSearch other{{sphere(9, 0.9), sphere(28, 0.8), sphere(31, 0.6)}, {}, {}};
    keep_one_size(other, 10);
    ASSERT_EQ(other.spheres.size(), 1u);
    EXPECT_EQ(other.spheres[0].image.radius_px, 9);
}

}  // namespace
}  // namespace tangi
