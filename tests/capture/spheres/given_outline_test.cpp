// given_outline_test.cpp: circles that are given for spheres whose outlines hardly show, spheres that are
// counted once, and lights that are not alone in a mirror.
#include "capture/spheres/given_outline.h"

#include <gmock/gmock.h>

#include "capture/spheres/sphere_sizes.h"
#include "tests/support/capture/mirrored_painting.h"
#include "tests/support/long_test.h"

namespace tangi {
namespace {

using glm::dvec2;
using glm::dvec3;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

std::vector<std::vector<MirroredLight>> one_each(const std::vector<dvec3>& lights) {
    std::vector<std::vector<MirroredLight>> photos;
    for (const dvec3& light : lights) photos.push_back({{light, 40}});
    return photos;
}

SphereCrops crops_of(const MirroredPainting& scene, const std::vector<dvec3>& lights) {
    SphereCrops crops{.region = {0, 0, scene.width, scene.height},
                      .photos = {},
                      .drift = std::vector<CameraMotion>(lights.size())};
    const Image<float> reflectance = scene.painting();
    for (const dvec3& light : lights) crops.photos.push_back(scene.picture({{light, 40}}, reflectance));
    return crops;
}

MirroredPainting textured(int number, Random& random) {
    MirroredPainting scene;
    scene.seed = static_cast<std::uint64_t>(number) + 10;
    scene.contrast = random.uniform(0.15, 0.9);
    scene.finest = 1 << number % 4;
    scene.table = number % 2 ? 0.25 : 0;
    scene.spheres = {{{random.uniform(50, 60), random.uniform(50, 60)}, 26, 0, 0}};
    return scene;
}

// Whole pixels that somebody reads off are a pixel off at most. What is stated holds, whatever the painting.
TP_LONG TEST(GivenSphere, ErrorsHoldOnTexturedPaintings) {
    constexpr int kPaintings = 40;
    Random random(3);
    int inside = 0, all = 0;
    double squares = 0, given_squares = 0;
    for (int i = 0; i < kPaintings; ++i) {
        const MirroredPainting scene = textured(i, random);
        const SphereImage truth = scene.spheres[0];
        const SphereCrops crops = crops_of(scene, lights_above(6));
        SphereImage given = truth;
        given.centre_px += dvec2(random.uniform(-1, 1), random.uniform(-1, 1));
        given.radius_px += random.uniform(-1, 1);
        given = with_click_errors(given);
        const SphereImage found = judge_outline(crops, given, refine_outline(crops, given, {}), {}).sphere;
        const dvec2 off = glm::abs(found.centre_px - truth.centre_px);
        for (const double error : {off.x, off.y}) {
            inside += error < 2 * found.centre_sigma_px;
            squares += error * error;
        }
        inside += std::abs(found.radius_px - truth.radius_px) < 2 * found.radius_sigma_px;
        all += 3;
        const dvec2 before = given.centre_px - truth.centre_px;
        given_squares += glm::dot(before, before);
        EXPECT_LE(found.centre_sigma_px, given.centre_sigma_px);
    }
    EXPECT_GE(inside, 0.95 * all);
    // And edges are of use where they tell more than that.
    EXPECT_LT(squares, 0.95 * given_squares);
}

TP_LONG TEST(GivenSphere, IsWhereItIsGivenOnTexturedPaintings) {
    const auto lights = lights_above(10);
    Random random(5);
    for (int i = 0; i < 4; ++i) {
        SCOPED_TRACE(i);
        const TestDir dir;
        const MirroredPainting scene = textured(i, random);
        const SphereImage truth = scene.spheres[0];
        const SphereCalibration c = calibrate_from_spheres(
            write_mirrored(dir.path(), scene, one_each(lights)),
            {.spheres = {circle(truth.centre_px.x, truth.centre_px.y, 26)}, .fixed_camera = true});
        ASSERT_EQ(c.calibrated(), 10);
        EXPECT_LT(mean_error_deg(c, lights), 1.5);
        EXPECT_LT(glm::length(c.spheres[0].image.centre_px - truth.centre_px),
                  2 * c.spheres[0].image.centre_sigma_px);
        EXPECT_NEAR(c.spheres[0].image.radius_px, 26, 2 * c.spheres[0].image.radius_sigma_px);
        EXPECT_THAT(c.warnings, Contains(HasSubstr("does not stand out from what is around it")));
    }
}

// A circle that is some pixels off is no reason to miss an outline that everybody sees.
TP_LONG TEST(GivenSphere, IsCorrectedWhereItsOutlineIsClear) {
    const TestDir dir;
    const auto lights = lights_around(5);
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights);
    const SphereCalibration coarse = calibrate_from_spheres(paths, {.spheres = {circle(143, 103, 43)}});
    EXPECT_NEAR(coarse.spheres[0].image.radius_px, 40, 0.2);
    EXPECT_THAT(coarse.warnings, Contains(HasSubstr("pixels from it, and is used: 140.")));
    // One that is right to a pixel counts, too.
    const SphereCalibration near = calibrate_from_spheres(paths, {.spheres = {circle(141, 105, 40)}});
    EXPECT_LT(glm::length(near.spheres[0].image.centre_px - dvec2(140.3, 105.7)), 0.15);
    EXPECT_LT(mean_error_deg(near, lights), 0.5);
    EXPECT_THAT(near.warnings, Each(Not(HasSubstr("--sphere"))));
}

// Mirrored rings of one sphere's outline, and of what is around, are no more spheres.
TP_LONG TEST(MirrorSpheres, AreSolid) {
    const TestDir dir;
    MirroredPainting scene;
    scene.width = 260;
    scene.height = 200;
    scene.plain_from = 150;
    scene.spheres = {{{190, 45}, 28, 0, 0}, {{200, 145}, 28, 0, 0}};
    const auto lights = lights_above(12);
    const SphereCalibration c = calibrate_from_spheres(write_mirrored(dir.path(), scene, one_each(lights)),
                                                       {.fixed_camera = true, .sphere_radius_mm = 10});
    ASSERT_EQ(c.spheres.size(), 2u);
    for (int i = 0; i < 2; ++i) {
        const auto at = static_cast<std::size_t>(i);
        EXPECT_LT(glm::length(c.spheres[at].image.centre_px - scene.spheres[at].centre_px), 1);
        EXPECT_NEAR(c.spheres[at].image.radius_px, 28, 1);
    }
}

TP_LONG TEST(MirrorSpheres, CannotBeInEachOther) {
    const SphereImage sphere{{100, 100}, 30, 0, 0};
    EXPECT_TRUE(cannot_both_be(sphere, {{100, 100}, 34, 0, 0}));
    EXPECT_TRUE(cannot_both_be(sphere, {{93, 100}, 37, 0, 0}));
    EXPECT_FALSE(cannot_both_be(sphere, {{100, 160}, 30, 0, 0}));
    EXPECT_FALSE(cannot_both_be(sphere, {{100, 145}, 30, 0, 0}));  // one behind the other, seen aslant
}

// A reflector on the other side is a tenth as bright, and cut off in the photographs as the light is.
TP_LONG TEST(MirrorSphere, ShowsTheLightBesideAReflector) {
    const TestDir dir;
    MirroredPainting scene;
    scene.plain_from = 0;
    const auto lights = lights_above(10);
    std::vector<std::vector<MirroredLight>> photos;
    for (const dvec3& l : lights) photos.push_back({{l, 40}, {{-l.x, -l.y, l.z}, 4}});
    const SphereCalibration c =
        calibrate_from_spheres(write_mirrored(dir.path(), scene, photos),
                               {.spheres = {circle(54.3, 55.6, 26)}, .fixed_camera = true});
    EXPECT_EQ(c.calibrated(), 10);
    EXPECT_LT(mean_error_deg(c, lights), 2);
    EXPECT_THAT(c.warnings, Contains(HasSubstr("more than one bright spot")));
    // Two lights that are equally bright are told from nothing, and are said to be what they are.
    for (auto& photo : photos) photo[1].strength = 40;
    const TestDir other;
    EXPECT_THAT(error_of([&] {
                    calibrate_from_spheres(write_mirrored(other.path(), scene, photos),
                                           {.spheres = {circle(54.3, 55.6, 26)}, .fixed_camera = true});
                }),
                AllOf(HasSubstr("no light is told from the other there"),
                      HasSubstr("show two that are about equally bright"),
                      Not(HasSubstr("Give spheres with --sphere"))));
    // From below the picture's plane comes what the table shines back.
    for (auto& photo : photos) photo[1].direction = glm::normalize(dvec3(-dvec2(photo[0].direction), -0.3));
    const TestDir table;
    const SphereCalibration above =
        calibrate_from_spheres(write_mirrored(table.path(), scene, photos),
                               {.spheres = {circle(54.3, 55.6, 26)}, .fixed_camera = true});
    EXPECT_EQ(above.calibrated(), 10);
    EXPECT_LT(mean_error_deg(above, lights), 2);
}

// What would be refused is not recommended.
TP_LONG TEST(MirrorSphere, IsNotRecommendedWhereItWouldBeRefused) {
    const TestDir dir;
    const auto paths = write_sphere_photos(dir.path(), SphereScene{}, lights_around(12), false,
                                           [](int i, SphereScene& scene) {
                                               if (i > 0) scene.strength = 0;
                                           });
    const std::string refused = error_of(
        [&] { calibrate_from_spheres(paths, {.spheres = {circle(140, 106, 40)}, .fixed_camera = true}); });
    EXPECT_THAT(refused, AllOf(HasSubstr("--sphere 140,106,40: no mirror sphere there: only 1 of 12"),
                               Not(HasSubstr("Give --sphere")), Not(HasSubstr("Give spheres with --sphere")),
                               Not(HasSubstr("taken as given"))));
}

}  // namespace
}  // namespace tangi
