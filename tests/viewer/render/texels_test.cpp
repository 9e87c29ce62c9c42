// texels_test.cpp: packed maps come back as they were, and levels of detail conserve what they must.
#include "viewer/render/texels.h"

#include "tests/support/viewer/viewer_support.h"

namespace tangi {
namespace {

TEST(Texels, ComeBackAsTheyWere) {
    const Surface s = painted_surface(64, 48);
    const TexelRange range = range_of(s, 5);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            const Material a = material_at(s, x, y), b = unpack(pack(a, range), range);
            EXPECT_LT(glm::length(a.normal - b.normal), 6e-5f);
            EXPECT_LT(glm::length(a.diffuse - b.diffuse), 2e-3f);
            EXPECT_NEAR(a.specular, b.specular, 1e-5);
            EXPECT_NEAR(a.roughness / b.roughness, 1, 3e-4);
            EXPECT_NEAR(a.height_mm, b.height_mm, 1e-6);
            EXPECT_NEAR(a.confidence, b.confidence, 0.002);
        }
}

TEST(Texels, ColoursOfLobesComeBack) {
    const Surface s = gilded_surface(64, 48);
    const TexelRange range = range_of(s, 5);
    ASSERT_TRUE(range.coloured_specular);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            const Material a = material_at(s, x, y), b = unpack(pack(a, range), range);
            EXPECT_LT(glm::length(a.specular_colour - b.specular_colour), 0.006f);
            EXPECT_LT(glm::length(a.normal - b.normal), 6e-5f);
            EXPECT_NEAR(a.specular, b.specular, 1e-4);
            EXPECT_NEAR(a.roughness / b.roughness, 1, 1e-3);
            EXPECT_NEAR(a.height_mm, b.height_mm, 5e-5);
            EXPECT_NEAR(a.confidence, b.confidence, 0.009);
        }
    // A mean of colours has no channel of 1; what it reflects is kept.
    const Material mean{.specular = 0.1f, .roughness = 0.2f, .specular_colour = Rgb(0.4f, 0.8f, 0.6f)};
    const Material back = unpack(pack(mean, range), range);
    EXPECT_LT(glm::length(back.specular * back.specular_colour - mean.specular * mean.specular_colour),
              1e-3f);
    EXPECT_EQ(back.specular_colour.g, 1);
}

TEST(Texels, StretchesOfLobesComeBack) {
    Surface s = brushed_surface(64, 48);
    const TexelRange range = range_of(s, 5);
    ASSERT_TRUE(range.anisotropic_specular);
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x) {
            const Material a = material_at(s, x, y), b = unpack(pack(a, range), range);
            EXPECT_LT(glm::length(a.stretch - b.stretch), 0.006f);
            EXPECT_LT(glm::length(a.specular_colour - b.specular_colour), 0.006f);
            EXPECT_LT(glm::length(a.normal - b.normal), 5e-4f);
            EXPECT_LT(glm::length(a.diffuse - b.diffuse), 4e-3f);
            EXPECT_NEAR(a.specular, b.specular, 2e-4);
            EXPECT_NEAR(a.roughness / b.roughness, 1, 2e-3);
            EXPECT_NEAR(a.height_mm, b.height_mm, 1e-4);
            EXPECT_NEAR(a.confidence, b.confidence, 0.08);
        }
    const Material plain{.roughness = 0.2f};
    EXPECT_EQ(unpack(pack(plain, range), range).stretch, Stretch(0)) << "exactly";
    s.specular_colour = {};
    EXPECT_EQ(unpack(pack(material_at(s, 40, 9), range_of(s)), range_of(s)).specular_colour, Rgb(1));
}

// From afar, slopes that differ along one direction draw a lobe out, and a stretch that all have is kept.
TEST(Texels, LevelsOfDetailKeepStretches) {
    Surface s(32, 32);
    s.lobe_axes = Image<LobeAxes>(32, 32, axes_of({0.3f, 0.4f}, 0.2f));
    for (float& alpha : s.roughness.pixels()) alpha = 0.2f;
    for (float& rho : s.specular.pixels()) rho = 0.1f;
    const TexelTiles even(s, range_of(s));
    const Material same = unpack(even.at(0, 0, 1), even.range());
    EXPECT_NEAR(same.roughness, 0.2, 1e-3);
    EXPECT_LT(glm::length(same.stretch - Stretch(0.3f, 0.4f)), 0.01f);
    for (LobeAxes& axes : s.lobe_axes.pixels()) axes = {0.2f, 0};
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) s.normal(x, y) = normal_of({x % 2 ? 0.15f : -0.15f, 0});
    const TexelTiles ridges(s, range_of(s));
    const Material mean = unpack(ridges.at(0, 0, 1), ridges.range());
    // Variances of slopes: alpha^2 / 2 across the ridges, and 0.15^2 more along x.
    const double along = std::sqrt(0.04 + 2 * 0.15 * 0.15);
    const LobeAxes axes = axes_of(mean.stretch, mean.roughness);
    EXPECT_NEAR(axes.roughness_v, 0.2, 3e-3);
    EXPECT_NEAR(mean.roughness * mean.roughness / axes.roughness_v, along, 4e-3);
    EXPECT_NEAR(axes.tangent, 0, 0.02);
}

TEST(Texels, GrazingNormalsKeepTheirDirection) {
    for (const float z : {1e-3f, 0.01f, 0.1f})
        for (float angle = 0; angle < 6.28f; angle += 0.1f) {
            const float r = std::sqrt(1 - z * z);
            const Material m{.normal = {r * std::cos(angle), r * std::sin(angle), z}};
            EXPECT_LT(glm::length(unpack(pack(m, {}), {}).normal - m.normal), 1e-4f);
        }
}

TEST(Texels, BeyondTheRangeAreClamped) {
    const TexelRange range{.diffuse_max = 1, .specular_max = 0.25f, .height_min_mm = -1, .height_max_mm = 1};
    const Material m = unpack(pack({{0, 0, 1}, Rgb(9), 5, 1e9f, 50, 2}, range), range);
    EXPECT_FLOAT_EQ(m.diffuse.g, 1);
    EXPECT_FLOAT_EQ(m.specular, 0.25f);
    EXPECT_FLOAT_EQ(m.roughness, 64);
    EXPECT_FLOAT_EQ(m.height_mm, 1);
    EXPECT_FLOAT_EQ(m.confidence, 1);
}

TEST(TexelTiles, LevelsAreMeansOfWhatIsThere) {
    Surface s = painted_surface(1300, 130);
    for (Vec3& n : s.normal.pixels()) n = {0, 0, 1};
    const TexelTiles tiles(s, range_of(s));
    ASSERT_EQ(tiles.levels(), 8);
    // The texel in the lower right corner holds 4 x 2 pixels: their mean, not darkened by what is not there.
    glm::dvec3 sum(0);
    for (int y = 128; y < 130; ++y)
        for (int x = 1296; x < 1300; ++x) sum += glm::dvec3(s.diffuse(x, y));
    const Material last = unpack(tiles.at(162, 16, 3), tiles.range());
    EXPECT_NEAR(last.diffuse.r, sum.r / 8, 0.01);
    EXPECT_NEAR(last.diffuse.g, sum.g / 8, 0.01);
    EXPECT_EQ(tiles.tile({3, 0, 0})[163], Texel{}) << "beyond the border";
}

TEST(TexelTiles, SpreadOfSlopesBecomesRoughness) {
    Surface s(2048, 128);
    Random random(7);
    double sum2 = 0;
    for (Vec3& n : s.normal.pixels()) {
        const Slope slope{static_cast<float>(random.real(-0.2, 0.2)),
                          static_cast<float>(random.real(-0.2, 0.2))};
        sum2 += slope.x * slope.x + slope.y * slope.y;
        n = normal_of(slope);
    }
    for (float& v : s.specular.pixels()) v = 0.05f;
    for (float& v : s.roughness.pixels()) v = 0.1f;
    const TexelTiles tiles(s, range_of(s));
    const double expected = std::sqrt(0.01 + sum2 / static_cast<double>(s.normal.size()));
    double squared = 0;  // of 64 pixels each
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 256; ++x) {
            const float alpha = unpack(tiles.at(x, y, 3), tiles.range()).roughness;
            squared += alpha * alpha / (256.0 * 16);
        }
    EXPECT_NEAR(std::sqrt(squared), expected, 0.02 * expected);
}

}  // namespace
}  // namespace tangi
