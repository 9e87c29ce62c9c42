// positions_test.cpp: positions see the painting that is photographed as a whole, each from its own place.
#include "datasets/positions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

using glm::dvec2;

constexpr PaintingOptions kWall{.width = 200, .height = 150, .brush_width_mm = 3, .crack_distance_mm = 4};
// Where the camera is exactly where it should be.
constexpr PositionsOptions kExact{.position_shift = 0,
                                  .position_roll_deg = 0,
                                  .position_tilt_deg = 0,
                                  .position_zoom = 0,
                                  .position_exposure = 0};

TEST(CameraPositions, CoverThePaintingWithTheOverlapAskedFor) {
    const std::vector<CameraPosition> positions = camera_positions(kWall, kExact);
    ASSERT_EQ(positions.size(), 6u);
    const double width = positions[0].view.width;
    const auto corner = [&](std::size_t i) { return mapped(positions[i].to_painting, dvec2(0)); };
    EXPECT_NEAR(corner(1).x - corner(0).x, 0.7 * width, 1e-9);
    EXPECT_NEAR(corner(1).y, corner(0).y, 1e-9);
    EXPECT_NEAR(corner(3).x, corner(0).x, 1e-9);
    EXPECT_NEAR(corner(3).y - corner(0).y, 0.7 * positions[0].view.height, 1e-9);
    EXPECT_EQ(positions[5].name, "r1_c2");
    EXPECT_NEAR(corner(0).x, 0, 2);  // what is left over is less than a pixel a position
    EXPECT_NEAR(mapped(positions[5].to_painting, {width - 1, 0}).x, 199, 2);
}

TEST(CameraPositions, StayWithinThePainting) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        PaintingOptions painting = kWall;
        painting.seed = seed;
        for (const CameraPosition& p :
             camera_positions(painting, {.position_roll_deg = 2, .position_tilt_deg = 2})) {
            const double right = p.view.width - 1, bottom = p.view.height - 1;
            for (const dvec2& c : {dvec2(0), dvec2(right, 0), dvec2(right, bottom), dvec2(0, bottom)}) {
                const dvec2 at = mapped(p.to_painting, c);
                EXPECT_GE(at.x, -0.5);
                EXPECT_GE(at.y, -0.5);
                EXPECT_LE(at.x, 199.5);
                EXPECT_LE(at.y, 149.5);
            }
        }
    }
}

// The same painting, sampled elsewhere: what is in a pixel of one is in the pixel of the other.
TEST(CameraPositions, SeeThePaintingItself) {
    PositionsOptions shifted = kExact;
    shifted.overlap = 0.5;  // an even number of pixels, so that pixels fall on pixels
    PaintingOptions painting = kWall;
    painting.width = 180, painting.height = 150;
    const PaintingTruth all = procedural_painting(painting);
    for (const CameraPosition& p : camera_positions(painting, shifted)) {
        const PaintingTruth seen = procedural_painting(painting, p.view);
        const dvec2 corner = mapped(p.to_painting, dvec2(0));
        ASSERT_NEAR(corner.x, std::round(corner.x), 1e-6) << p.name;
        ASSERT_NEAR(corner.y, std::round(corner.y), 1e-6) << p.name;
        const int x0 = static_cast<int>(std::lround(corner.x)), y0 = static_cast<int>(std::lround(corner.y));
        double height = 0, normal = 0, diffuse = 0;
        for (int y = 0; y < seen.height(); ++y)
            for (int x = 0; x < seen.width(); ++x) {
                height += std::abs(seen.height_mm(x, y) - all.height_mm(x0 + x, y0 + y));
                normal += glm::length(seen.normal(x, y) - all.normal(x0 + x, y0 + y));
                diffuse += glm::length(seen.diffuse(x, y) - all.diffuse(x0 + x, y0 + y));
            }
        const auto pixels = static_cast<double>(seen.height_mm.size());
        EXPECT_LT(height / pixels, 1e-4) << p.name;
        EXPECT_LT(normal / pixels, 1e-3) << p.name;
        EXPECT_LT(diffuse / pixels, 1e-3) << p.name;
    }
}

// Without relief, a normal is that of the painting's plane in the camera's frame, and the height its slope.
TEST(CameraPositions, TiltedCamerasSeeATiltedPlane) {
    PaintingOptions flat = kWall;
    flat.weave_mm = 0, flat.impasto = 0, flat.coverage = 0, flat.craquelure = 0, flat.losses = false;
    flat.varnish = flat.retouch = false;
    PositionsOptions tilted = kExact;
    tilted.position_tilt_deg = 2, tilted.position_roll_deg = 3;
    for (const CameraPosition& p : camera_positions(flat, tilted)) {
        const PaintingTruth seen = procedural_painting(flat, p.view);
        const Vec3 up(p.view.rotation[2]);
        Vec3 mean(0);
        for (const Vec3& n : seen.normal.pixels()) mean += n / static_cast<float>(seen.normal.size());
        EXPECT_LT(glm::length(mean - up), 0.002f) << p.name;
        const Plane plane = best_plane(seen.height_mm, {});
        EXPECT_NEAR(plane.a / p.view.mm_per_pixel, -up.x / up.z, 0.002) << p.name;
        EXPECT_NEAR(plane.b / p.view.mm_per_pixel, -up.y / up.z, 0.002) << p.name;
        EXPECT_GT(std::hypot(up.x, up.y), 0.001f) << p.name;
    }
}

TEST(CameraPositions, RefuseAPaintingThatIsTooSmall) {
    EXPECT_THROW(camera_positions({.width = 40, .height = 40}, {.columns = 8, .rows = 8, .overlap = 0}),
                 Error);
}

TEST(WritePositions, WritesAStackForEachAndTheWhole) {
    const TestDir dir;
    PaintingOptions painting = kWall;
    painting.width = 80, painting.height = 60, painting.supersampling = 1;
    const nlohmann::json written =
        write_positions(dir.path(), painting, {.columns = 2, .rows = 1}, {.lights = 3, .held_out = 0});
    ASSERT_EQ(written["positions"].size(), 2u);
    for (const char* file : {"r0_c0/img_002.png", "r0_c1/lights.lp", "r0_c1/gt/normal.exr", "gt/height.exr"})
        EXPECT_TRUE(std::filesystem::exists(dir / file)) << file;
    EXPECT_NE(written["positions"][0]["exposure"], written["positions"][1]["exposure"]);
}

}  // namespace
}  // namespace tangi
