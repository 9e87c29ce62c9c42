// mask_test.cpp: areas, outlines and distances of masks.
#include "retouch/mask/mask.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "surface/base/error.h"
#include "surface/image_file/image_io.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

double coverage(const Mask& mask) {
    double sum = 0;
    for (const float part : mask.pixels()) sum += static_cast<double>(part);
    return sum;
}

Polygon circle(double x, double y, double radius, int corners = 200) {
    Polygon polygon;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        polygon.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
    }
    return polygon;
}

TEST(Mask, OfAPolygonHasThePolygonsArea) {
    // Not on the lines that pixels are measured on.
    const Mask triangle = mask_of_polygons({{{3.3, 2.1}, {27.6, 8.9}, {9.2, 29.7}}}, 32, 32);
    const double area = std::abs((27.6 - 3.3) * (29.7 - 2.1) - (9.2 - 3.3) * (8.9 - 2.1)) / 2;
    EXPECT_NEAR(coverage(triangle), area, 0.05);
    const Mask rectangle = mask_of_polygons({{{1.25, 2}, {4.5, 2}, {4.5, 5}, {1.25, 5}}}, 8, 8);
    EXPECT_FLOAT_EQ(rectangle(1, 3), 0.75f);
    EXPECT_FLOAT_EQ(rectangle(4, 3), 0.5f);
    EXPECT_FLOAT_EQ(rectangle(2, 3), 1);
    EXPECT_FLOAT_EQ(rectangle(2, 1), 0);
    // A polygon within another is a hole; what lies beyond the picture is cut off.
    EXPECT_NEAR(coverage(mask_of_polygons({circle(16, 16, 10), circle(16, 16, 5)}, 32, 32)),
                std::numbers::pi * 75, 0.5);
    EXPECT_NEAR(coverage(mask_of_polygons({circle(0, 0, 10)}, 32, 32)), std::numbers::pi * 25, 0.3);
}

TEST(Mask, AreaIsInMillimetresAndRegionsAreCounted) {
    const Mask mask = mask_of_polygons({circle(20, 20, 8), circle(60, 30, 6)}, 100, 50);
    const MaskArea area = area_of(mask, 0.5);
    EXPECT_NEAR(area.mm2, std::numbers::pi * 100 * 0.25, 0.2);
    EXPECT_NEAR(area.percent, std::numbers::pi * 100 / 50, 0.02);
    EXPECT_EQ(area.regions, 2);
    const MaskRegions regions = regions_of(mask);
    ASSERT_EQ(regions.regions.size(), 2u);
    EXPECT_EQ(regions.regions[0].box, (Region{12, 12, 28, 28}));
    EXPECT_EQ(regions.number(60, 30), 2);
    EXPECT_EQ(area_of(Mask(4, 4), 1).regions, 0);
}

TEST(Mask, ItsOutlineGivesItBack) {
    const Mask mask = mask_of_polygons({circle(30, 25, 17), circle(33, 22, 6), circle(70, 12, 4)}, 80, 50);
    const std::vector<Polygon> outlines = outlines_of(mask, 0);
    EXPECT_EQ(outlines.size(), 3u);
    const Mask again = mask_of_polygons(outlines, 80, 50);
    EXPECT_NEAR(coverage(again), coverage(mask), 0.005 * coverage(mask));
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 80; ++x) ASSERT_NEAR(again(x, y), mask(x, y), 0.15) << x << " " << y;
    // Simplified, it has few corners and nearly the same area.
    const std::vector<Polygon> simple = outlines_of(mask, 0.5);
    EXPECT_LT(simple[0].size(), 40u);
    EXPECT_NEAR(coverage(mask_of_polygons(simple, 80, 50)), coverage(mask), 0.03 * coverage(mask));
}

TEST(Mask, OutlinesCloseAtTheBorderAndWhereCornersTouch) {
    Mask mask(6, 6);
    mask(0, 0) = mask(1, 1) = mask(5, 5) = mask(4, 4) = mask(4, 5) = 1;
    const std::vector<Polygon> outlines = outlines_of(mask, 0, 0);
    EXPECT_EQ(outlines.size(), 2u);
    EXPECT_EQ(regions_of(mask).regions.size(), 2u);
    for (const Polygon& polygon : outlines) EXPECT_GE(polygon.size(), 4u);
    EXPECT_TRUE(outlines_of(Mask(5, 5)).empty());
    EXPECT_EQ(outlines_of(Mask(5, 5, 1.0f)).size(), 1u);
}

TEST(Mask, DistancesAreSignedFromTheOutline) {
    const Mask mask = mask_of_polygons({circle(40, 40, 20)}, 80, 80);
    const Image<float> distance = distance_inside_px(mask);
    for (int y = 0; y < 80; y += 3)
        for (int x = 0; x < 80; x += 3)
            ASSERT_NEAR(distance(x, y), 20 - std::hypot(x + 0.5 - 40, y + 0.5 - 40), 0.8);
    EXPECT_FLOAT_EQ(distance_inside_px(Mask(5, 4))(2, 2), -9);
    EXPECT_FLOAT_EQ(distance_inside_px(Mask(5, 4, 1.0f))(2, 2), 9);
}

TEST(Mask, GrowsShrinksAndFeathers) {
    const Mask mask = mask_of_polygons({circle(40, 40, 20)}, 80, 80);
    const auto radius = [](const Mask& disc) { return std::sqrt(coverage(disc) / std::numbers::pi); };
    EXPECT_NEAR(radius(dilated(mask, 5)), 25, 0.5);
    EXPECT_NEAR(radius(dilated(mask, -5)), 15, 0.5);
    const Mask soft = feathered(mask, 4);
    EXPECT_FLOAT_EQ(soft(40, 40), 1);
    EXPECT_GT(soft(40, 58), 0);
    EXPECT_LT(soft(40, 58), 0.8f);
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 80; ++x) ASSERT_LE(soft(x, y), mask(x, y));
}

TEST(Mask, CombinesAsSetsDo) {
    const Mask a = mask_of_polygons({circle(14, 16, 8)}, 32, 32),
               b = mask_of_polygons({circle(20, 16, 8)}, 32, 32);
    EXPECT_NEAR(coverage(united(a, b)) + coverage(intersected(a, b)), coverage(a) + coverage(b), 1e-3);
    EXPECT_FLOAT_EQ(without(a, b)(20, 16), 0);
    EXPECT_FLOAT_EQ(without(a, b)(8, 16), 1);
    EXPECT_THROW(united(a, Mask(3, 3)), ContractError);
}

TEST(Mask, FilesHoldCoverage) {
    const TestDir dir;
    const Mask mask = mask_of_polygons({circle(14.2, 16.7, 8)}, 40, 32);
    write_mask(dir / "m.png", mask);
    const Mask again = read_mask(dir / "m.png", 40, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 40; ++x) ASSERT_NEAR(again(x, y), mask(x, y), 0.5001 / 255);
    EXPECT_THAT([&] { read_mask(dir / "m.png", 32, 40); },
                ThrowsMessage<Error>(HasSubstr("m.png: is 40 x 32 pixels, but the painting has 32 x 40")));
}

// Of four pixels: outside, inside, half, inside.
TEST(Mask, WhatIsTransparentInAPictureIsOutside) {
    const TestDir dir;
    const auto write = [&](const std::string& name, int channels, const std::vector<float>& values,
                           bool multiplied = false) {
        OIIO::ImageSpec spec(4, 1, channels, OIIO::TypeDesc::UINT8);
        spec.alpha_channel = channels - 1;
        if (lower_extension(name) == ".exr") spec.format = OIIO::TypeDesc::FLOAT;
        if (!multiplied) spec.attribute("oiio:UnassociatedAlpha", 1);
        const auto output = OIIO::ImageOutput::create(name);
        ASSERT_TRUE(output->open((dir / name).string(), spec));
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
        ASSERT_TRUE(output->close());
    };
    const auto expect = [&](const std::string& name, const std::array<float, 4>& coverage) {
        const Mask mask = read_mask(dir / name, 4, 1);
        for (int x = 0; x < 4; ++x)
            EXPECT_NEAR(mask(x, 0), coverage[static_cast<std::size_t>(x)], 0.003) << name << x;
    };
    // Painted with a soft brush of any colour on a layer of its own.
    for (const float tone : {1.0f, 0.5f, 0.0f}) {
        write("layer.png", 2, {tone, 0, tone, 1, tone, 0.5f, tone, 1});
        expect("layer.png", {0, 1, 0.5f, 1});
        write("layer.tif", 2, {tone, 0, tone, 1, tone, 0.5f, tone, 1});
        expect("layer.tif", {0, 1, 0.5f, 1});
    }
    write("red.png", 4, {0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0.5f, 1, 0, 0, 1});
    expect("red.png", {0, 1, 0.5f, 1});
    // White and black that can be seen: white is inside as far as it can be seen.
    write("both.png", 2, {1, 0, 1, 1, 1, 0.5f, 0, 1});
    expect("both.png", {0, 1, 0.5f, 0});
    // Opaque: alpha says nothing.
    write("opaque.png", 2, {0, 1, 1, 1, 0.5f, 1, 1, 1});
    expect("opaque.png", {0, 1, 0.5f, 1});
    // As EXR files and some TIFF files have it.
    write("both.exr", 4, {0, 0, 0, 0, 1, 1, 1, 1, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0, 0, 1}, true);
    expect("both.exr", {0, 1, 0.5f, 0});
    write("none.png", 2, {1, 0, 1, 0, 1, 0, 1, 0});
    expect("none.png", {0, 0, 0, 0});
}

TEST(Mask, PolygonsThatAreNoneAreRefused) {
    EXPECT_THAT(
        [] {
            mask_of_polygons({{{1, 1}, {2, 2}}}, 8, 8);
        },
        ThrowsMessage<Error>(HasSubstr("2 corners")));
    EXPECT_THAT(
        [] {
            mask_of_polygons({{{1, 1}, {2, 2}, {NAN, 3}}}, 8, 8);
        },
        ThrowsMessage<Error>(HasSubstr("not finite")));
    EXPECT_THAT(
        [] {
            mask_of_polygons({{{10, 1}, {12, 2}, {11, 3}}}, 8, 8);
        },
        ThrowsMessage<Error>(HasSubstr("nothing of the polygon lies in the picture")));
}

TEST(Mask, APolygonThatEnclosesNothingSaysSo) {
    const std::vector<Polygon> none = {{{2, 2}, {4, 4}, {6, 6}},          // a line
                                       {{2, 3}, {7, 3}, {4, 3}},          // along a row
                                       {{3, 1}, {3, 7}, {3, 2}},          // along a column
                                       {{2, 2}, {2, 2}, {2, 2}},          // a point
                                       {{1, 1}, {5, 2}, {6, 7}, {5, 2}},  // there and back
                                       {{1.1, 1.1}, {2.3, 2.3}, {7.7, 7.7}}};
    for (const Polygon& polygon : none)
        EXPECT_THAT([&] { mask_of_polygons({polygon}, 8, 8); },
                    ThrowsMessage<Error>(HasSubstr("encloses nothing")));
    // As thin as it is, it is an area.
    EXPECT_NEAR(coverage(mask_of_polygons({{{0, 0}, {8, 8}, {8, 7.9}}}, 8, 8)), 0.4, 0.05);
}

TEST(Mask, APolygonThatCrossesItselfHoldsAllThatItGoesRound) {
    // Twice round the same circle; a star of five, whose middle it goes round twice.
    Polygon twice = circle(16, 16, 8);
    const Polygon again = twice;
    twice.insert(twice.end(), again.begin(), again.end());
    EXPECT_NEAR(coverage(mask_of_polygons({twice}, 32, 32)), coverage(mask_of_polygons({again}, 32, 32)),
                1e-3);
    Polygon star;
    for (int i = 0; i < 5; ++i) {
        const double angle = 2 * std::numbers::pi * (2 * i) / 5;
        star.push_back({16 + 12 * std::sin(angle), 16 - 12 * std::cos(angle)});
    }
    EXPECT_EQ(mask_of_polygons({star}, 32, 32)(16, 16), 1);
    // Loops of an eight, which go round the other way each.
    const Mask eight = mask_of_polygons({{{4, 4}, {28, 28}, {28, 4}, {4, 28}}}, 32, 32);
    EXPECT_EQ(eight(6, 16), 1);
    EXPECT_EQ(eight(25, 16), 1);
    // A hole is one whichever way round it was drawn.
    Polygon hole = circle(16, 16, 5);
    std::ranges::reverse(hole);
    EXPECT_EQ(mask_of_polygons({circle(16, 16, 10), hole}, 32, 32)(16, 16), 0);
}

TEST(Mask, WhatHangsTogetherIsFoundFromAnyOfItsPixels) {
    Mask mask(12, 8);
    for (int x = 1; x < 5; ++x) mask(x, 2) = 0.3f;  // of little coverage
    mask(5, 3) = 1;                                 // across a corner
    mask(9, 3) = 1;                                 // not there
    const Mask area = connected_at(mask, 5, 3);
    int pixels = 0;
    for (const float v : area.pixels()) pixels += v == 1;
    EXPECT_EQ(pixels, 5);
    EXPECT_EQ(area(1, 2), 1);
    EXPECT_EQ(area(9, 3), 0);
    EXPECT_TRUE(images_near(connected_at(mask, 2, 2), area, 0));
    EXPECT_TRUE(connected_at(mask, 0, 0).empty());
    EXPECT_TRUE(connected_at(mask, -1, 3).empty());
    EXPECT_TRUE(connected_at(mask, 3, 8).empty());
}

}  // namespace
}  // namespace tangi
