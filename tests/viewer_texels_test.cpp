// viewer_texels_test.cpp: packed maps come back as they were, and levels of detail conserve what they must.
#include "viewer/texels.h"

#include "viewer_support.h"

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
    Surface s = painted_surface(200, 130);
    for (Vec3& n : s.normal.pixels()) n = {0, 0, 1};
    const TexelTiles tiles(s, range_of(s), 7);
    ASSERT_EQ(tiles.columns(), 2);
    ASSERT_EQ(tiles.rows(), 2);
    // The lower right tile holds 72 x 2 pixels: its last level is their mean, not darkened by what is not
    // there.
    glm::dvec3 sum(0);
    for (int y = 128; y < 130; ++y)
        for (int x = 128; x < 200; ++x) sum += glm::dvec3(s.diffuse(x, y));
    const Material last = unpack(tiles.at(1, 1, 7), tiles.range());
    EXPECT_NEAR(last.diffuse.r, sum.r / 144, 0.03);
    EXPECT_NEAR(last.diffuse.g, sum.g / 144, 0.03);
}

TEST(TexelTiles, SpreadOfSlopesBecomesRoughness) {
    Surface s(128, 128);
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
    const TexelTiles tiles(s, range_of(s), 7);
    const double expected = std::sqrt(0.01 + sum2 / static_cast<double>(s.normal.size()));
    EXPECT_NEAR(unpack(tiles.at(0, 0, 7), tiles.range()).roughness, expected, 0.02 * expected);
}

TEST(TexelTiles, AreNoMoreThanADeviceTakes) {
    EXPECT_EQ(tile_bits_for(100, 100, 2048), 7);
    EXPECT_LE(tile_bits_for(4500, 3000, 2048), 10);
    EXPECT_EQ(tile_bits_for(40000, 30000, 512), 11);
    EXPECT_THAT(error_of([] { tile_bits_for(100000, 100000, 512); }),
                testing::HasSubstr("100000 x 100000 pixels is larger than this graphics driver can hold"));
}

}  // namespace
}  // namespace tangi
