// overview_test.cpp: the small picture in a large painting's file: means of what is seen, and nothing
// where it does not belong to the maps.
#include "surface/painting_file/overview.h"

#include <gmock/gmock.h>

#include "surface/painting_file/painting_file.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kLargeWidth = 4001, kLargeHeight = 1000;  // four million pixels, in squares of 4

Surface large() {
    Surface s(kLargeWidth, kLargeHeight);
    s.mm_per_pixel = 0.5;
    s.reflectance_model = {.diffuse_roughness = 0.25, .second_lobe_weight = 0.5};
    for (int y = 0; y < kLargeHeight; ++y)
        for (int x = 0; x < kLargeWidth; ++x) {
            s.diffuse(x, y) = Rgb(x < 2000 ? 0.25f : 0.75f, y < 400 ? 0.5f : 0.0f, 0.125f);
            s.normal(x, y) = normal_of({x % 2 ? 0.3f : -0.3f, 0});
            s.specular(x, y) = 0.05f;
            s.roughness(x, y) = 0.1f;
            s.height_mm(x, y) = static_cast<float>(y / 4);
            s.confidence(x, y) = 1;
        }
    return s;
}

TEST(Overview, IsTheMeanOfWhatIsSeen) {
    const TestDir dir;
    const Surface s = large();
    write_painting(dir / "a.exr", s);
    const std::optional<Overview> overview = read_overview(dir / "a.exr");
    ASSERT_TRUE(overview);
    EXPECT_EQ(overview->width, kLargeWidth);
    EXPECT_EQ(overview->height, kLargeHeight);
    const Surface& small = overview->surface;
    EXPECT_EQ(small.width(), 1001);
    EXPECT_EQ(small.height(), 250);
    EXPECT_NEAR(small.mm_per_pixel, 2, 0.002);
    EXPECT_EQ(small.reflectance_model, s.reflectance_model);
    const float shorter = glm::length(Vec3(0, 0, normal_of({0.3f, 0}).z));
    EXPECT_NEAR(small.diffuse(10, 10).r, 0.25f * shorter, 1e-3);
    EXPECT_NEAR(small.diffuse(900, 10).r, 0.75f * shorter, 1e-3);
    EXPECT_NEAR(small.diffuse(10, 200).g, 0, 1e-6);
    EXPECT_NEAR(small.height_mm(10, 200), 200, 0.1);
    EXPECT_NEAR(small.normal(10, 10).z, 1, 1e-3);
    EXPECT_NEAR(small.roughness(10, 10), std::hypot(0.1f, 0.3f), 1e-3)
        << "ripples that are too fine to see are gloss";
    EXPECT_TRUE(painting_parts(dir / "a.exr").empty()) << "it is no map";
}

// A painting with paint on it is not made as a whole to be seen in small.
TEST(Overview, MadeInBandsIsTheSame) {
    const Surface s = large();
    std::vector<PartToWrite> whole, in_bands;
    int row = 0;  // from which on nothing was asked for yet
    add_overview(whole, s, s);
    add_overview(
        in_bands,
        [&](const Region& part) {
            EXPECT_EQ(part.y0, row) << "each row once";
            EXPECT_EQ(part.x0, 0);
            EXPECT_EQ(part.x1, s.width());
            EXPECT_LE(part.height(), 256);
            row = part.y1;
            Surface band(part.width(), part.height());
            const auto cut = [&](const auto& from, auto& to) {
                std::copy_n(from.row(part.y0).data(), to.size(), to.data());
            };
            cut(s.height_mm, band.height_mm);
            cut(s.normal, band.normal);
            cut(s.diffuse, band.diffuse);
            cut(s.specular, band.specular);
            cut(s.roughness, band.roughness);
            cut(s.confidence, band.confidence);
            return band;
        },
        s);
    EXPECT_EQ(row, s.height());
    ASSERT_EQ(in_bands.size(), 1u);
    const PartInfo& info = whole[0].info;
    ASSERT_EQ(in_bands[0].info.width, info.width);
    ASSERT_EQ(in_bands[0].info.height, info.height);
    const auto planes_of = [&](const PartToWrite& part) {
        std::vector<std::vector<float>> planes(
            info.channels.size(), std::vector<float>(static_cast<std::size_t>(info.width * info.height)));
        std::vector<float*> rows;
        for (std::vector<float>& plane : planes) rows.push_back(plane.data());
        part.fill(0, info.height, rows);
        return planes;
    };
    EXPECT_EQ(planes_of(in_bands[0]), planes_of(whole[0]));
}

TEST(Overview, OfAnotherPaintingCountsForNothing) {
    const TestDir dir;
    Surface s = large();
    std::vector<PartToWrite> parts;
    add_overview(parts, s, s);
    ASSERT_EQ(parts.size(), 1u);
    s.height_mm(3, 3) = 7;
    AtomicFile file(dir / "a.exr");
    write_painting(file, s, parts);
    EXPECT_FALSE(read_overview(dir / "a.exr"));
    EXPECT_EQ(read_painting(dir / "a.exr").height_mm(3, 3), 7);
}

TEST(Overview, SmallPaintingsHaveNone) {
    const TestDir dir;
    write_painting(dir / "a.exr", Surface(8, 6));
    EXPECT_FALSE(read_overview(dir / "a.exr"));
    std::vector<PartToWrite> parts(1);
    parts[0].info.name = "overview";
    add_overview(parts, Surface(8, 6), Surface(8, 6));
    EXPECT_TRUE(parts.empty()) << "one that was there goes";
}

TEST(Overview, NeedsAPainting) {
    const TestDir dir;
    EXPECT_EQ(error_of([&] { read_overview(dir / "none.exr"); }),
              (dir / "none.exr").string() + ": no such file");
    write_bytes(dir / "text.exr", "hello");
    EXPECT_THAT(error_of([&] { read_overview(dir / "text.exr"); }),
                testing::HasSubstr("is not a painting file"));
}

}  // namespace
}  // namespace tangi
