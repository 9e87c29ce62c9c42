// fill_test.cpp: fills reach the level around, keep the relief, and come off again.
#include "retouch/fill/fill.h"

#include <gmock/gmock.h>

#include <numbers>

#include "paint/canvas/appearance.h"
#include "retouch/treatment/treatment.h"
#include "surface/base/error.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth = 120, kHeight = 100;

Mask disc(double x, double y, double radius) {
    Polygon polygon;
    for (int i = 0; i < 90; ++i) {
        const double a = 2 * std::numbers::pi * i / 90;
        polygon.push_back({x + radius * std::cos(a), y + radius * std::sin(a)});
    }
    return mask_of_polygons({polygon}, kWidth, kHeight);
}

// A canvas of this height [mm], with the paint gone, 0.4 mm deep, where the mask is.
template <class Height>
Canvas with_loss(const Mask& loss, const Height& height) {
    auto surface = flat_surface(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            surface->height_mm(x, y) = height(x, y) - 0.4f * (loss(x, y) > 0.5f ? 1.0f : 0.0f);
    surface->normal = normals_of(surface->height_mm, surface->mm_per_pixel);
    return Canvas(surface);
}

double rms_inside(const Canvas& canvas, const Mask& mask, const std::function<float(int, int)>& wanted) {
    const Image<float> relief = relief_of(canvas);
    double sum = 0, count = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            if (mask(x, y) > 0.99f) {
                const auto d = static_cast<double>(relief(x, y) - wanted(x, y));
                sum += d * d;
                count += 1;
            }
    return std::sqrt(sum / count);
}

constexpr Rgb kChalk{0.85f, 0.83f, 0.78f};

TEST(Fill, GoesOnWithATiltedPlaneExactly) {
    const Mask loss = disc(60, 50, 20);
    const auto plane = [](int x, int y) {
        return 0.01f * static_cast<float>(x) - 0.004f * static_cast<float>(y);
    };
    for (const FillTexture texture : {FillTexture::smooth, FillTexture::surroundings}) {
        Canvas canvas = with_loss(loss, plane);
        const FillReport report = lay_fill(canvas, "fill 1", loss, {}, {texture, kChalk});
        EXPECT_LT(rms_inside(canvas, loss, plane), 0.003);
        EXPECT_NEAR(report.volume_mm3, 0.4 * report.area_mm2, 0.05 * 0.4 * report.area_mm2);
        EXPECT_NEAR(report.deepest_mm, 0.4, 0.03);
        EXPECT_EQ(report.regions, 1);
        EXPECT_LT(report.border_rms_mm, 0.05);  // 4 pixels of the slope
    }
}

TEST(Fill, LiesAsMuchLowerAsAsked) {
    const Mask loss = disc(60, 50, 15);
    const auto flat = [](int, int) { return 0.0f; };
    Canvas canvas = with_loss(loss, flat);
    FillOptions lower;
    lower.offset_mm = -0.1;
    lay_fill(canvas, "fill 1", loss, {}, {FillTexture::smooth, kChalk, lower});
    EXPECT_LT(rms_inside(canvas, loss, [](int, int) { return -0.1f; }), 1e-4);
}

TEST(Fill, KeepsTheWeaveAndItsPhase) {
    const Mask loss = disc(60, 50, 14);
    const auto weave = [](int x, int y) {  // threads 6 pixels apart
        const double u = 2 * std::numbers::pi * x / 6, v = 2 * std::numbers::pi * y / 6;
        return static_cast<float>(0.05 * std::cos(u) * std::cos(v) + 0.002 * x);
    };
    Canvas smooth = with_loss(loss, weave), woven = smooth;
    lay_fill(smooth, "fill 1", loss, {}, {FillTexture::smooth, kChalk});
    FillOptions options;
    options.weave_mm = 6 * kTestPixel;
    lay_fill(woven, "fill 1", loss, {}, {FillTexture::weave, kChalk, options});
    EXPECT_GT(rms_inside(smooth, loss, weave), 0.02);
    EXPECT_LT(rms_inside(woven, loss, weave), 0.008);
}

// Of a wide reach not every place is tried, but the phase is found all the same; and of many losses, each is.
TEST(Fill, FindsThePhaseOfAWeaveFarAndWideForManyLosses) {
    constexpr int kSide = 420;
    const auto weave = [](int x, int y) {  // threads 16 pixels apart
        const double u = 2 * std::numbers::pi * x / 16, v = 2 * std::numbers::pi * y / 16;
        return static_cast<float>(0.05 * std::cos(u) * std::cos(v));
    };
    Mask loss(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            loss(x, y) = std::hypot(x % 140 - 70, y % 140 - 70) < 14 ? 1.0f : 0.0f;
    auto surface = flat_surface(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            surface->height_mm(x, y) = weave(x, y) - (loss(x, y) > 0 ? 0.4f : 0.0f);
    Canvas canvas(surface);
    FillOptions options;
    options.weave_mm = 16 * kTestPixel;
    options.search_mm = 200 * kTestPixel;
    const FillReport report = lay_fill(canvas, "fill 1", loss, {}, {FillTexture::weave, kChalk, options});
    EXPECT_EQ(report.regions, 9);
    const Image<float> relief = relief_of(canvas);
    double square = 0, count = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            if (loss(x, y) > 0) {
                const auto d = static_cast<double>(relief(x, y) - weave(x, y));
                square += d * d, count += 1;
            }
    EXPECT_LT(std::sqrt(square / count), 0.008);
}

TEST(Fill, HasItsOwnColourAndShapeAndComesOffAgain) {
    const Mask loss = disc(60, 50, 15);
    auto surface = flat_surface(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            surface->height_mm(x, y) = loss(x, y) > 0.5f ? -0.4f : 0.0f;
            surface->normal(x, y) = normal_of({0.2f, -0.1f});  // detail that the height does not have
        }
    Canvas canvas(surface);
    const std::string before = sha256_of(appearance(canvas));
    lay_fill(canvas, "fill 1", loss, {}, {FillTexture::smooth, kChalk});
    const Surface filled = appearance(canvas);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(filled.diffuse(60, 50)[c], kChalk[c], 0.02);
    EXPECT_NEAR(filled.roughness(60, 50), 0.4, 0.01);
    EXPECT_GT(filled.normal(60, 50).z, 0.9999f);  // the ground's relief is under it
    EXPECT_EQ(filled.diffuse(5, 5), surface->diffuse(5, 5));
    EXPECT_EQ(filled.normal(5, 5), surface->normal(5, 5));
    EXPECT_EQ(on_original(canvas.dried()[0].paint, loss, kTestPixel).pixels,
              on_original(canvas.dried()[0].paint, disc(60, 50, 15), kTestPixel).pixels);
    lift_off(canvas, "fill 1");
    EXPECT_EQ(sha256_of(appearance(canvas)), before);
}

// A pixel outside of a fill has the step down into the loss in its height, and not in the normal that was
// measured: with the fill's edge it is level again.
TEST(Fill, LeavesNoRimOfWrongNormalsRoundIt) {
    const Mask loss = disc(60, 50, 15);
    auto surface = flat_surface(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) surface->height_mm(x, y) = loss(x, y) > 0.5f ? -0.4f : 0.0f;
    Canvas canvas(surface);
    lay_fill(canvas, "fill 1", loss, {}, {FillTexture::smooth, kChalk});
    const Surface filled = appearance(canvas);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) ASSERT_GT(filled.normal(x, y).z, 0.999f) << x << ", " << y;
}

TEST(Fill, SaysWhereItFoundNoReliefToGoOnWith) {
    Mask loss(kWidth, kHeight);
    for (int y = 20; y < kHeight - 20; ++y)
        for (int x = 20; x < kWidth - 20; ++x) loss(x, y) = 1;  // nothing near is as large
    const auto flat = [](int, int) { return 0.0f; };
    for (const FillTexture texture : {FillTexture::surroundings, FillTexture::weave}) {
        Canvas canvas = with_loss(loss, flat);
        EXPECT_EQ(lay_fill(canvas, "fill 1", loss, {}, {texture, kChalk}).smooth_regions, 1);
    }
    Canvas canvas = with_loss(disc(60, 50, 10), flat);
    EXPECT_EQ(
        lay_fill(canvas, "fill 1", disc(60, 50, 10), {}, {FillTexture::surroundings, kChalk}).smooth_regions,
        0);
}

TEST(Fill, RefusesWhatCannotBeFilled) {
    Canvas canvas(flat_surface(kWidth, kHeight));
    EXPECT_THAT(
        [&] {
            lay_fill(canvas, "f", Mask(kWidth, kHeight), {}, {FillTexture::smooth, kChalk});
        },
        ThrowsMessage<Error>(HasSubstr("nothing to fill")));
    EXPECT_THAT(
        [&] {
            lay_fill(canvas, "f", Mask(kWidth, kHeight, 1.0f), {}, {FillTexture::smooth, kChalk});
        },
        ThrowsMessage<Error>(AllOf(HasSubstr("nothing intact around it"), HasSubstr("leave some"))));
    EXPECT_TRUE(canvas.dried().empty());
}

TEST(Membrane, IsHarmonicInside) {
    // x^2 - y^2 is: its membrane from its border values is itself.
    Image<float> values(65, 50), expected(65, 50);
    Mask inside(65, 50);
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 65; ++x) {
            const auto u = static_cast<float>(x - 30) / 30, v = static_cast<float>(y - 25) / 30;
            expected(x, y) = u * u - v * v;
            inside(x, y) = x > 2 && x < 60 && y > 2 && y < 47 ? 1.0f : 0.0f;
            values(x, y) = inside(x, y) > 0 ? -7 : expected(x, y);
        }
    solve_membrane(values, inside);
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 65; ++x) ASSERT_NEAR(values(x, y), expected(x, y), 2e-3) << x << " " << y;
}

TEST(Varnish, ChangesGlossNotColourNorShape) {
    auto surface = flat_surface(kWidth, kHeight);
    for (float& alpha : surface->roughness.pixels()) alpha = 0.4f;
    Canvas canvas(surface);
    VarnishOptions options;
    options.thickness_mm = 0.05;
    lay_varnish(canvas, "varnish 1", Mask(kWidth, kHeight, 1.0f), options);
    const Surface varnished = appearance(canvas);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(varnished.diffuse(50, 50)[c], surface->diffuse(50, 50)[c], 2e-3);
    EXPECT_NEAR(varnished.roughness(50, 50), 0.08, 0.01);
    EXPECT_NEAR(varnished.specular(50, 50), 0.04, 0.001);
    EXPECT_EQ(varnished.normal(50, 50), surface->normal(50, 50));
    options.yellowing = 10;
    lay_varnish(canvas, "varnish 2", Mask(kWidth, kHeight, 1.0f), options);
    const Surface old = appearance(canvas);
    EXPECT_LT(old.diffuse(50, 50).b / old.diffuse(50, 50).r,
              0.95f * varnished.diffuse(50, 50).b / varnished.diffuse(50, 50).r);
}

TEST(Varnish, ShinesTheSameOverAFillAsBesideIt) {
    Canvas canvas(flat_surface(kWidth, kHeight));
    Image<float> fill(kWidth, kHeight);
    for (int y = 30; y < 60; ++y)
        for (int x = 30; x < 60; ++x) fill(x, y) = 0.5f;
    Pigment matt = pigment_of_rgb("fill", Rgb(0.8f));
    matt.specular = 0.005f, matt.roughness = 0.4f;
    add_layer(canvas, "fill 1", matt, fill, true);
    EXPECT_NEAR(appearance(canvas).roughness(45, 45), 0.4, 1e-5);
    VarnishOptions options;
    options.thickness_mm = 0.05;
    lay_varnish(canvas, "varnish 1", Mask(kWidth, kHeight, 1.0f), options);
    const Surface varnished = appearance(canvas);
    EXPECT_NEAR(varnished.roughness(45, 45), 0.08, 0.005);
    EXPECT_NEAR(varnished.specular(45, 45), varnished.specular(10, 10), 5e-4);
}

}  // namespace
}  // namespace tangi
