#include "surface/maps/mean_material.h"

#include <gtest/gtest.h>

#include "surface/render/relight.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

Surface even_surface(int width, int height) {
    Surface s(width, height);
    for (std::size_t i = 0; i < s.diffuse.size(); ++i) {
        s.height_mm.pixels()[i] = 0.5f;
        s.diffuse.pixels()[i] = Rgb(0.4f, 0.3f, 0.2f);
        s.specular.pixels()[i] = 0.05f;
        s.roughness.pixels()[i] = 0.1f;
        s.confidence.pixels()[i] = 0.8f;
    }
    s.mm_per_pixel = 0.25;
    return s;
}

TEST(MeanMaterial, OfAnEvenSurfaceIsTheSurface) {
    const Surface whole = even_surface(7, 5), small = reduced(whole, 3);
    ASSERT_EQ(small.width(), 3);
    ASSERT_EQ(small.height(), 2);
    EXPECT_EQ(small.mm_per_pixel, 0.75);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) {
            EXPECT_NEAR(small.diffuse(x, y).g, 0.3f, 1e-6);
            EXPECT_NEAR(small.specular(x, y), 0.05f, 1e-6);
            EXPECT_NEAR(small.roughness(x, y), 0.1f, 1e-5);
            EXPECT_NEAR(small.height_mm(x, y), 0.5f, 1e-6);
            EXPECT_NEAR(small.confidence(x, y), 0.8f, 1e-6);
        }
}

TEST(MeanMaterial, PixelsThatWereNotMeasuredHaveNoPart) {
    Surface whole = even_surface(4, 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) {
            whole.confidence(x, y) = 0;
            whole.diffuse(x, y) = Rgb(0);
        }
    const Surface small = reduced(whole, 2);
    EXPECT_EQ(small.confidence(0, 0), 0);
    EXPECT_NEAR(small.diffuse(1, 0).r, 0.4f, 1e-6);
    EXPECT_NEAR(small.confidence(1, 0), 0.8f, 1e-6);
}

// Glossy paint of uneven slopes, seen from afar: its lobe is as wide as the slopes spread.
TEST(MeanMaterial, LooksFromAfarAsItsPixelsDoTogether) {
    Surface whole = even_surface(64, 64);
    Random random(7);
    for (Vec3& normal : whole.normal.pixels())
        normal =
            normal_of({static_cast<float>(0.1 * random.normal()), static_cast<float>(0.1 * random.normal())});
    for (float& height : whole.height_mm.pixels()) height = 0;
    const Surface small = reduced(whole, 64);
    // The rms slope of both directions together, and of the microfacets.
    EXPECT_NEAR(small.roughness(0, 0), std::sqrt(0.01 + 2 * 0.01), 0.005);
    for (const float x : {0.0f, 0.15f, 0.4f, 0.8f}) {
        const Light light = distant_light({x, 0, 1});
        const Image<Rgb> near = relight(whole, {&light, 1}, {}), far = relight(small, {&light, 1}, {});
        double sum = 0;
        for (const Rgb& value : near.pixels()) sum += value.g / static_cast<double>(near.size());
        EXPECT_NEAR(far(0, 0).g, sum, 0.04 * sum) << x;
    }
}

}  // namespace
}  // namespace tangi
