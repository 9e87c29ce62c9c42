// measurement_test.cpp: heights along a line and statistics of a region, against what is known.
#include "viewer/model/measurement.h"

#include <gmock/gmock.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

// A ramp of 0.1 mm a column and -0.3 mm a row, half a millimetre a pixel.
Surface ramp() {
    Surface s(40, 30);
    s.mm_per_pixel = 0.5;
    s.scale_known = true;
    for (int y = 0; y < s.height(); ++y)
        for (int x = 0; x < s.width(); ++x)
            s.height_mm(x, y) = 0.1f * static_cast<float>(x) - 0.3f * static_cast<float>(y);
    for (float& c : s.confidence.pixels()) c = 1;
    return s;
}

TEST(HeightProfile, OfAPlaneIsALine) {
    const HeightProfile p = height_profile(ramp(), {3.5, 2}, {23.5, 17});
    ASSERT_EQ(p.height_mm.size(), 26u) << "25 pixels long";
    EXPECT_DOUBLE_EQ(p.step_mm, 0.5);
    for (std::size_t i = 0; i < p.height_mm.size(); ++i) {
        const double along = static_cast<double>(i) / 25;
        EXPECT_NEAR(p.height_mm[i], 0.1 * (3.5 + 20 * along) - 0.3 * (2 + 15 * along), 1e-5);
    }
}

TEST(HeightProfile, EndsWhereThePaintingDoes) {
    const Surface s = ramp();
    const HeightProfile p = height_profile(s, {-100, 10}, {100, 10});
    EXPECT_DOUBLE_EQ(p.from_px.x, -0.5);
    EXPECT_DOUBLE_EQ(p.to_px.x, 39.5);
    EXPECT_NEAR(static_cast<double>(p.height_mm.size() - 1) * p.step_mm, 20, 1e-9)
        << "as wide as the painting";
    EXPECT_THAT(height_profile(s, {-100, -50}, {100, -50}).height_mm, testing::IsEmpty());
    EXPECT_THAT(height_profile(s, {200, 0}, {300, 20}).height_mm, testing::IsEmpty());
    EXPECT_EQ(height_profile(s, {5, 5}, {5, 5}).height_mm.size(), 0u) << "a click is no line";
}

TEST(HeightProfile, CsvHasItsUnits) {
    Surface s = ramp();
    EXPECT_THAT(csv_of(height_profile(s, {0, 0}, {2, 0})),
                testing::StrEq("distance_mm,height_mm\n0,0\n0.5,0.1\n1,0.2\n"));
    s.scale_known = false;
    EXPECT_THAT(csv_of(height_profile(s, {0, 0}, {2, 0})), testing::StartsWith("distance_px,height_px\n"));
    // A scale that is given to one that has none is that of its heights, too.
    EXPECT_THAT(csv_of(in_mm(height_profile(s, {0, 0}, {2, 0}), 2)),
                testing::StrEq("distance_mm,height_mm\n0,0\n1,0.2\n2,0.4\n"));
}

TEST(RegionStatistics, AreThoseOfItsPixels) {
    Surface s = ramp();
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 40; ++x) {
            s.specular(x, y) = x % 2 ? 0.02f : 0.06f;
            s.diffuse(x, y) = x % 2 ? Rgb(0.3f) : Rgb(0.5f);
        }
    const RegionStatistics r = statistics_of(s, {10, 5, 14, 7});
    EXPECT_EQ(r.pixels, 8u);
    EXPECT_NEAR(r.specular.mean, 0.04, 1e-6);
    EXPECT_NEAR(r.specular.deviation, 0.02, 1e-6);
    EXPECT_NEAR(r.height_mm.mean, 0.1 * 11.5 - 0.3 * 5.5, 1e-5);
    EXPECT_NEAR(r.lab_of_mean.l, lab_from_linear(glm::dvec3(0.4)).l, 1e-4);
    EXPECT_GT(r.colour_spread, 5);
    EXPECT_NEAR(r.rms_slope, 0, 1e-9);
    // Beyond the picture, and where nothing was measured, there is nothing.
    for (float& c : s.confidence.pixels()) c = 0;
    EXPECT_EQ(statistics_of(s, {10, 5, 14, 7}).pixels, 0u);
    EXPECT_EQ(statistics_of(ramp(), {-5, -5, 2, 3}).pixels, 6u);
    EXPECT_EQ(statistics_of(ramp(), {50, 50, 60, 60}).pixels, 0u);
}

}  // namespace
}  // namespace tangi
