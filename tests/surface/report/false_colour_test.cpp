#include "surface/report/false_colour.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

Lab lab_of(const Rgb& srgb) {
    return lab_from_linear(glm::dvec3(Transfer{Transfer::Kind::srgb}.decode(srgb)));
}

TEST(ColourMap, SequentialRisesEvenlyInLightness) {
    for (int i = 0; i < 20; ++i) {
        const double l0 = lab_of(colour_at(ColourMap::sequential, i / 20.0)).l;
        const double l1 = lab_of(colour_at(ColourMap::sequential, (i + 1) / 20.0)).l;
        EXPECT_NEAR(l1 - l0, 4, 0.3) << i;
    }
}

TEST(ColourMap, StepsLookAlikeEverywhere) {
    for (const ColourMap map : {ColourMap::sequential, ColourMap::diverging}) {
        std::vector<double> steps;
        for (int i = 0; i < 32; ++i)
            steps.push_back(
                delta_e_2000(lab_of(colour_at(map, i / 32.0)), lab_of(colour_at(map, (i + 1) / 32.0))));
        const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
        EXPECT_GT(*least, 1);
        EXPECT_LT(*most / *least, 4);
    }
}

TEST(ColourMap, DivergingIsNeutralInTheMiddleAndAlikeOnBothSides) {
    const Lab middle = lab_of(colour_at(ColourMap::diverging, 0.5));
    EXPECT_LT(std::hypot(middle.a, middle.b), 2);
    EXPECT_GT(middle.l, 90);
    for (const double t : {0.1, 0.3, 0.5})
        EXPECT_NEAR(lab_of(colour_at(ColourMap::diverging, 0.5 - t)).l,
                    lab_of(colour_at(ColourMap::diverging, 0.5 + t)).l, 1);
    EXPECT_GT(colour_at(ColourMap::diverging, 1).r, colour_at(ColourMap::diverging, 1).b);
    EXPECT_GT(colour_at(ColourMap::diverging, 0).b, colour_at(ColourMap::diverging, 0).r);
}

TEST(ColourMap, ClampsAndMarksWhatIsNotANumber) {
    EXPECT_EQ(colour_at(ColourMap::sequential, -3), colour_at(ColourMap::sequential, 0));
    EXPECT_EQ(colour_at(ColourMap::sequential, 1e9), colour_at(ColourMap::sequential, 1));
    EXPECT_EQ(colour_at(ColourMap::sequential, std::nan("")), kNoValue);
}

TEST(MapPicture, PutsTheRangeAtTheEndsOfTheScaleAndLeavesOutTheMask) {
    Image<float> values(4, 1);
    for (int x = 0; x < 4; ++x) values(x, 0) = static_cast<float>(x);
    PixelMask mask(4, 1, 1);
    mask(3, 0) = 0;
    const Image<Rgb> picture = map_picture(values, 0, 2, ColourMap::sequential, mask);
    EXPECT_EQ(picture(0, 0), colour_at(ColourMap::sequential, 0));
    EXPECT_EQ(picture(1, 0), colour_at(ColourMap::sequential, 0.5));
    EXPECT_EQ(picture(2, 0), colour_at(ColourMap::sequential, 1));
    EXPECT_EQ(picture(3, 0), kNoValue);
    EXPECT_THROW(map_picture(values, 1, 1), ContractError);
}

TEST(NormalPicture, ShowsAFlatSurfaceInTheUsualBlue) {
    const Image<Rgb> picture = normal_picture(Image<Vec3>(2, 2, Vec3(0, 0, 1)));
    EXPECT_EQ(picture(1, 1), Rgb(0.5f, 0.5f, 1.0f));
}

TEST(RobustRange, IgnoresAFewWildValuesAndIsNeverEmpty) {
    Image<float> values(100, 10);
    for (std::size_t i = 0; i < values.size(); ++i) values.pixels()[i] = static_cast<float>(i) / 999;
    values(5, 5) = 1e6f;
    values(6, 5) = -1e6f;
    const ValueRange range = robust_range(values);
    EXPECT_NEAR(range.lo, 0.01, 0.003);
    EXPECT_NEAR(range.hi, 0.99, 0.003);
    const ValueRange flat = robust_range(Image<float>(5, 5, 3.0f));
    EXPECT_LT(flat.lo, 3);
    EXPECT_GT(flat.hi, 3);
}

TEST(Ticks, AreRoundAndInside) {
    EXPECT_EQ(ticks({0, 1}, 6), (std::vector<double>{0, 0.2, 0.4, 0.6000000000000001, 0.8, 1}));
    EXPECT_EQ(ticks({-15, 15}, 7), (std::vector<double>{-15, -10, -5, 0, 5, 10, 15}));
    for (const ValueRange range :
         {ValueRange{0.013, 0.094}, {-3e-7, 2e-7}, {-1234, 98765}, {99.99, 100.01}}) {
        const std::vector<double> marks = ticks(range, 6);
        EXPECT_GE(marks.size(), 2u);
        EXPECT_LE(marks.size(), 6u);
        EXPECT_GE(marks.front(), range.lo - 1e-9 * std::abs(range.hi));
        EXPECT_LE(marks.back(), range.hi + 1e-9 * std::abs(range.hi));
    }
}

TEST(TickLabel, HasTheDigitsThatTheRangeNeeds) {
    EXPECT_EQ(tick_label(0.6000000000000001, {0, 1}), "0.6");
    EXPECT_EQ(tick_label(-5, {-15, 15}), "-5");
    EXPECT_EQ(tick_label(-1e-17, {-1, 1}), "0");
    EXPECT_EQ(tick_label(100, {0, 100}), "100");
    EXPECT_EQ(tick_label(0.02, {0, 0.1}), "0.02");
}

TEST(Legend, HoldsTheScaleFromLeftToRightWithLabelsBelow) {
    const Image<Rgb> bar = legend(ColourMap::sequential, {0, 0.08}, "mm", 400, 40);
    ASSERT_EQ(bar.width(), 400);
    ASSERT_EQ(bar.height(), 40);
    EXPECT_LT(lab_of(bar(40, 2)).l, lab_of(bar(300, 2)).l);
    bool ink = false;
    for (int y = 25; y < 40; ++y)
        for (int x = 0; x < 400; ++x) ink = ink || bar(x, y).r < 0.5f;
    EXPECT_TRUE(ink);
    for (int y = 0; y < 40; ++y) EXPECT_EQ(bar(399, y), Rgb(1)) << "a label is cut";
    EXPECT_NO_THROW(legend(ColourMap::diverging, {-1e-6, 1e-6}, "a long unit", 40, 16));
}

TEST(DrawText, MarksPixelsAndCutsWhatLiesOutside) {
    Image<Rgb> picture(60, 20, Rgb(1));
    draw_text(picture, "Ab", 5, 4, 10, Rgb(0));
    const auto darkest = std::min_element(picture.pixels().begin(), picture.pixels().end(),
                                          [](const Rgb& a, const Rgb& b) { return a.r < b.r; });
    EXPECT_LT(darkest->r, 0.3f);
    EXPECT_NO_THROW(draw_text(picture, "outside", -30, 15, 10, Rgb(0)));
    EXPECT_EQ(text_width("é", 10), text_width("?", 10));  // two bytes, one character
    EXPECT_GT(text_width("wide text", 20), text_width("wide text", 10));
}

TEST(Shrunk, AveragesAndKeepsProportions) {
    Image<Rgb> picture(200, 100, Rgb(0));
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 200; x += 2) picture(x, y) = Rgb(1);
    const Image<Rgb> small = shrunk(picture, 50);
    EXPECT_EQ(small.width(), 50);
    EXPECT_EQ(small.height(), 25);
    EXPECT_NEAR(small(20, 10).g, 0.5, 1e-5);
    EXPECT_EQ(shrunk(picture, 200).width(), 200);
    EXPECT_EQ(shrunk(Image<Rgb>(1000, 2), 100).height(), 1);
}

TEST(MapPictures, ShowEveryMapAndGreyWhereNothingWasMeasured) {
    Surface surface(40, 20);
    for (int y = 0; y < 20; ++y)
        for (int x = 10; x < 40; ++x) {
            surface.confidence(x, y) = 1;
            surface.height_mm(x, y) = static_cast<float>(x) / 40;
            surface.diffuse(x, y) = Rgb(0.5f, 0.2f, 0.1f);
        }
    const std::vector<MapPicture> maps = map_pictures(surface, 1000);
    ASSERT_EQ(maps.size(), 6u);
    for (const MapPicture& map : maps) {
        EXPECT_EQ(map.picture(2, 2), kNoValue) << map.key;
        EXPECT_NE(map.picture(30, 2), kNoValue) << map.key;
    }
    EXPECT_EQ(maps[0].unit, "pixels");
    EXPECT_GT(maps[2].picture(30, 2).r, maps[2].picture(30, 2).b);
    EXPECT_NO_THROW(map_pictures(Surface(3, 3), 100));  // nothing measured at all
}

}  // namespace
}  // namespace tangi
