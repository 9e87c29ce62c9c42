// surface_test.cpp: slopes, normals of a height map, planes: conversions that lose nothing.
#include "surface/maps/surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Height [mm] of a function of (x, y) in mm from the centre, y up.
template <class Function>
Image<float> height_map(int width, int height, double mm_per_pixel, Function&& z) {
    Image<float> map(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            map(x, y) = static_cast<float>(
                z((x - (width - 1) / 2.0) * mm_per_pixel, ((height - 1) / 2.0 - y) * mm_per_pixel));
    return map;
}

TEST(Slope, RoundTripsThroughTheNormal) {
    Random random(1);
    for (int i = 0; i < 10000; ++i) {
        const Vec3 n = random.direction(0.05);
        const Vec3 back = normal_of(slope_of(n));
        EXPECT_LE(glm::length(back - n), 1e-6f);  // a few roundings of numbers up to 1 (slopes: 20)
        EXPECT_NEAR(glm::length(back), 1, 1e-6);
    }
}

TEST(Slope, RisesAgainstTheNormalsLean) {
    const Vec3 n = normal_of({0.5f, -0.25f});  // rises to the right, falls towards the top
    EXPECT_LT(n.x, 0);
    EXPECT_GT(n.y, 0);
    EXPECT_GT(n.z, 0);
}

TEST(NormalsOf, APlaneAreItsNormalEverywhere) {
    for (const double mm_per_pixel : {1.0, 0.05, 3.0}) {
        const auto map =
            height_map(9, 7, mm_per_pixel, [](double x, double y) { return 0.3 * x - 0.7 * y + 2; });
        const Vec3 expected = normal_of({0.3f, -0.7f});
        // Heights up to 20 mm have a rounding of 1e-6, over a distance of two pixels (0.1 mm at least).
        EXPECT_TRUE(images_near(normals_of(map, mm_per_pixel), Image<Vec3>(9, 7, expected), 5e-6))
            << mm_per_pixel;
    }
}

TEST(NormalsOf, ASpherePointAwayFromItsCentre) {
    constexpr double radius = 40;  // [mm]
    constexpr int size = 41;
    constexpr double pixel = 0.5;
    const auto map = height_map(
        size, size, pixel, [](double x, double y) { return std::sqrt(radius * radius - x * x - y * y); });
    const Image<Vec3> normals = normals_of(map, pixel);
    for (int y = 1; y < size - 1; ++y)
        for (int x = 1; x < size - 1; ++x) {
            const Vec3 expected = Vec3(glm::dvec3((x - 20) * pixel, (20 - y) * pixel, map(x, y)) / radius);
            // Central differences err by the third derivative: z''' pixel^2 / 6 < 3 (0.35 / 40^2) 0.25 / 6 <
            // 1e-4.
            EXPECT_LE(glm::length(normals(x, y) - expected), 1e-4f) << x << ", " << y;
        }
}

TEST(NormalsOf, KnowThatRowsRunDownwards) {
    Image<float> map(3, 3);
    for (int x = 0; x < 3; ++x) map(x, 0) = 1;  // the top edge is raised: the surface rises with y
    EXPECT_LT(normals_of(map, 1)(1, 0).y, 0);
    EXPECT_LT(normals_of(map, 1)(1, 1).y, 0);
    EXPECT_EQ(normals_of(map, 1)(1, 1).x, 0);
}

TEST(NormalsOf, WorkOnOneRowOneColumnAndOnePixel) {
    for (const auto& [width, height] : {std::pair{5, 1}, std::pair{1, 5}, std::pair{1, 1}})
        EXPECT_TRUE(images_near(normals_of(Image<float>(width, height, 3.0f), 1),
                                Image<Vec3>(width, height, Vec3(0, 0, 1)), 0));
}

TEST(BestPlane, FindsThePlaneItWasGiven) {
    const auto map = height_map(31, 20, 1, [](double x, double y) { return 0.02 * x - 0.05 * y + 3.5; });
    const Plane plane = best_plane(map, {});
    // Heights near 4 have a rounding error of 2e-7.
    EXPECT_NEAR(plane.a, 0.02, 1e-7);
    EXPECT_NEAR(plane.b, -0.05, 1e-7);
    EXPECT_NEAR(plane.c, 3.5, 1e-6);
}

TEST(BestPlane, LeavesARestWithoutTiltAndMean) {
    Random random(2);
    auto map = height_map(40, 30, 1, [&](double x, double y) { return x / 9 + y / 7 - 4 + random.normal(); });
    subtract(best_plane(map, {}), map);
    const Plane rest = best_plane(map, {});
    EXPECT_NEAR(rest.a, 0, 1e-7);
    EXPECT_NEAR(rest.b, 0, 1e-7);
    EXPECT_NEAR(rest.c, 0, 1e-6);
}

TEST(BestPlane, SeesOnlyWhatHasWeight) {
    auto map = height_map(20, 20, 1, [](double x, double y) { return 0.1 * x + 0.2 * y + 1; });
    Image<float> weight(20, 20, 1.0f);
    for (int y = 3; y < 9; ++y)
        for (int x = 10; x < 17; ++x) {
            map(x, y) = x % 2 ? 1e4f : std::nanf("");
            weight(x, y) = 0;
        }
    const Plane plane = best_plane(map, weight);
    EXPECT_NEAR(plane.a, 0.1, 1e-6);
    EXPECT_NEAR(plane.b, 0.2, 1e-6);
    EXPECT_NEAR(plane.c, 1, 1e-6);
}

TEST(BestPlane, CountsAPixelOfWeightTwoTwice) {
    // Two pixels in a row determine the mean only: heights 0 (weight 1) and 3 (weight 2).
    Image<float> map(2, 1), weight(2, 1, 1.0f);
    map(1, 0) = 3;
    weight(1, 0) = 2;
    EXPECT_NEAR(best_plane(map, weight).c, 2, 1e-12);
}

TEST(BestPlane, OfNothingMeasuredIsZero) {
    const Plane plane = best_plane(Image<float>(4, 4, 7.0f), Image<float>(4, 4, 0.0f));
    EXPECT_EQ(plane.a, 0);
    EXPECT_EQ(plane.b, 0);
    EXPECT_EQ(plane.c, 0);
}

TEST(Surface, IsFlatAndUnmeasuredAtFirst) {
    const Surface s(4, 3);
    EXPECT_NO_THROW(require_consistent(s));
    EXPECT_EQ(s.width(), 4);
    EXPECT_EQ(s.height(), 3);
    EXPECT_EQ(s.normal(2, 1), Vec3(0, 0, 1));
    EXPECT_EQ(s.confidence(2, 1), 0);
    EXPECT_EQ(s.diffuse(2, 1), Rgb(0));
}

TEST(Surface, HasItsOriginInTheCentreAndYUp) {
    Surface s(5, 3);
    s.mm_per_pixel = 0.5;
    s.height_mm(0, 0) = 7;
    EXPECT_EQ(s.point_mm(2, 1), Vec3(0, 0, 0));
    EXPECT_EQ(s.point_mm(0, 0), Vec3(-1, 0.5f, 7));
    EXPECT_EQ(s.point_mm(4, 2), Vec3(1, -0.5f, 0));
}

TEST(Surface, WithMapsOfDifferentSizeBreaksTheContract) {
    Surface s(4, 3);
    s.roughness = Image<float>(3, 4);
    EXPECT_THROW(require_consistent(s), ContractError);
}

Photography two_photos() {
    Photography p;
    Light first = distant_light({0, 0.6f, 0.8f}, "a.jpg"), second = near_light({100, 0, 200}, "b.jpg");
    first.gain = {1, 2, 3};
    second.gain = Rgb(0.5f);
    p.photos = {{first, true}, {second, false}};
    return p;
}

TEST(FindPhoto, ComparesNameAndLight) {
    const Photography p = two_photos();
    EXPECT_EQ(find_photo(p, distant_light({0, 0.6f, 0.8f}, "a.jpg")), &p.photos[0]);
    EXPECT_EQ(find_photo(p, distant_light({0, 0.61f, 0.79f}, "a.jpg")), &p.photos[0]);  // 0.8 degrees
    EXPECT_EQ(find_photo(p, distant_light({0, 0.7f, 0.7f}, "a.jpg")), nullptr);         // 8 degrees
    EXPECT_EQ(find_photo(p, distant_light({0, 0.6f, 0.8f}, "b.jpg")), nullptr);
    EXPECT_EQ(find_photo(Photography{}, distant_light({0, 0, 1})), nullptr);
}

TEST(AsPhotographed, TakesTheLightOfItsPhotograph) {
    const Photography p = two_photos();
    EXPECT_EQ(as_photographed(distant_light({0, 0.6f, 0.8f}, "a.jpg"), p).gain, Rgb(1, 2, 3));
    const Light near = as_photographed(distant_light({1, 0, 2}, "b.jpg"), p);
    EXPECT_EQ(near.gain, Rgb(0.5f));
    EXPECT_EQ(near.position_mm, Vec3(100, 0, 200));
}

TEST(AsPhotographed, LeavesALightThatNoPhotographHadAsItIs) {
    Light light = distant_light({0, 0.6f, 0.8f}, "new");
    light.gain = {4, 5, 6};
    EXPECT_EQ(as_photographed(light, two_photos()).gain, Rgb(4, 5, 6));
    EXPECT_FALSE(as_photographed(light, two_photos()).position_mm);
}

}  // namespace
}  // namespace tangi
