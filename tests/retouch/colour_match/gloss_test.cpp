// gloss_test.cpp: retouches shine as what is round them, and hide the fill that they lie on.
#include <gtest/gtest.h>

#include <tuple>

#include "paint/canvas/appearance.h"
#include "retouch/fill/fill.h"
#include "retouch/inpaint/retouch_modes.h"
#include "tests/support/paint/paint_support.h"

namespace tangi {
namespace {

constexpr int kLossesWide = 200, kLossesHigh = 160;

// Two losses, in paint that is matt and in paint that is glossy: each retouch shines as what is round it.
TEST(Retouch, HasTheGlossOfItsSurroundings) {
    const auto surface = flat_surface(kLossesWide, kLossesHigh);
    Mask loss(kLossesWide, kLossesHigh);
    for (int y = 0; y < kLossesHigh; ++y)
        for (int x = 0; x < kLossesWide; ++x) {
            const bool left = x < kLossesWide / 2;
            surface->specular(x, y) = left ? 0.08f : 0.03f;
            surface->roughness(x, y) = left ? 0.4f : 0.08f;
            loss(x, y) = y > 60 && y < 100 && ((x > 30 && x < 60) || (x > 140 && x < 170)) ? 1.0f : 0.0f;
            if (loss(x, y) > 0) surface->roughness(x, y) = 0.5f;
        }
    RetouchOptions options;
    for (const bool own : {false, true}) {
        Canvas canvas(surface);
        options.own_gloss = own;
        const RetouchReport report =
            lay_retouch(canvas, artist_acrylics(), loss, {}, {RetouchMode::mimetic, "retouch 1", options});
        const Surface seen = appearance(canvas);
        for (const auto& [x, specular, roughness] :
             {std::tuple(45, 0.08f, 0.4f), std::tuple(155, 0.03f, 0.08f)}) {
            if (own) {
                EXPECT_NEAR(seen.roughness(x, 80), 0.15f, 0.01f) << "the paints' own";
            } else {
                EXPECT_NEAR(seen.specular(x, 80), specular, 0.002f);
                EXPECT_NEAR(seen.roughness(x, 80), roughness, 0.01f);
            }
        }
        ASSERT_EQ(report.glosses.size(), own ? 0u : 2u);
        if (own) continue;
        EXPECT_NEAR(report.glosses[0].area_mm2 + report.glosses[1].area_mm2, report.painted_mm2, 1e-6);
        EXPECT_NEAR(report.glosses[0].of_paint.roughness, 0.15, 0.01);
    }
}

// A fill covers what its mask covers by half; a retouch as thin as coverage says would let it shine through.
TEST(Retouch, LeavesNoRimOfTheFill) {
    Mask soft(kLossesWide, kLossesHigh);
    for (int y = 60; y < 100; ++y)
        for (int x = 60; x < 120; ++x) soft(x, y) = x == 60 ? 0.55f : 1;
    Canvas canvas = flat_canvas(kLossesWide, kLossesHigh);
    Image<float> fill_mm(kLossesWide, kLossesHigh);
    for (std::size_t i = 0; i < soft.size(); ++i)
        fill_mm.pixels()[i] = soft.pixels()[i] >= 0.5f ? 0.2f : 0.0f;
    add_layer(canvas, "fill", pigment_of_rgb("chalk", Rgb(0.8f)), fill_mm, true);
    lay_retouch(canvas, artist_acrylics(), soft, {}, {RetouchMode::mimetic, "retouch 1"});
    const PaintLayer& paint = canvas.dried().back().paint;
    for (int y = 0; y < kLossesHigh; ++y)
        for (int x = 0; x < kLossesWide; ++x)
            ASSERT_NEAR(paint.thickness_mm(x, y), soft(x, y) > 0 ? 0.05f : 0.0f, 1e-5f) << x << ", " << y;
}

}  // namespace
}  // namespace tangi
