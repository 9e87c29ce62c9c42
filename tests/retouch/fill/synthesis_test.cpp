// synthesis_test.cpp: texture that goes on into a hole is that of what is around.
#include <gtest/gtest.h>

#include <cmath>

#include "retouch/fill/fill.h"
#include "retouch/fill/surroundings.h"
#include "retouch/fill/texture_synthesis.h"
#include "surface/base/error.h"
#include "surface/base/noise.h"
#include "tests/support/paint/paint_support.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr int kSide = 72;

Mask square(int side, int from, int to) {
    Mask mask(side, side);
    for (int y = from; y < to; ++y)
        for (int x = from; x < to; ++x) mask(x, y) = 1;
    return mask;
}

const Mask kHole = square(kSide, 28, 44);
Mask usable() { return without(Mask(kSide, kSide, 1.0f), kHole); }

// Stripes that lean, with a period of 9 pixels.
Image<float> stripes() {
    Image<float> image(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            image(x, y) = std::sin(2 * 3.14159265f * static_cast<float>(x + y) / 9);
    return image;
}

double rms_inside(const Image<float>& a, const Image<float>& b) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (kHole.pixels()[i] > 0) {
            const auto d = static_cast<double>(a.pixels()[i] - b.pixels()[i]);
            sum += d * d, count += 1;
        }
    return std::sqrt(sum / count);
}

TEST(TextureSynthesis, CarriesStripesOnInPhase) {
    const Image<float> truth = stripes();
    Image<float> spoilt = truth;
    for (std::size_t i = 0; i < spoilt.size(); ++i)
        if (kHole.pixels()[i] > 0) spoilt.pixels()[i] = 5;
    std::vector<SynthesisChannel> channels = {{spoilt}};
    ASSERT_TRUE(synthesise_into(channels, kHole, usable()));
    EXPECT_LT(rms_inside(channels[0].values, truth), 0.15);
    Image<float> membrane = spoilt;
    membrane_into(membrane, kHole);
    EXPECT_GT(rms_inside(membrane, truth), 0.5);
    // Nothing else is touched.
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (kHole.pixels()[i] == 0) {
            ASSERT_EQ(channels[0].values.pixels()[i], truth.pixels()[i]);
        }
}

TEST(TextureSynthesis, IsTheSameForTheSameSeed) {
    std::vector<SynthesisChannel> first = {{stripes()}}, second = first;
    ASSERT_TRUE(synthesise_into(first, kHole, usable(), {.seed = 7}));
    ASSERT_TRUE(synthesise_into(second, kHole, usable(), {.seed = 7}));
    EXPECT_TRUE(images_identical(first[0].values, second[0].values));
}

TEST(TextureSynthesis, KeepsTheVariationOfNoise) {
    Image<float> noise(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            noise(x, y) =
                procedural::fractal_noise(static_cast<float>(x) / 4, static_cast<float>(y) / 4, 2, 3);
    const float spread = spread_of(noise, usable());
    std::vector<SynthesisChannel> channels = {{noise}};
    ASSERT_TRUE(synthesise_into(channels, kHole, usable()));
    EXPECT_GT(spread_of(channels[0].values, kHole), 0.6f * spread);
    Image<float> membrane = noise;
    membrane_into(membrane, kHole);
    EXPECT_LT(spread_of(membrane, kHole), 0.5f * spread);
}

TEST(TextureSynthesis, GoesAlongWithAGuide) {
    // Two materials, told apart by the guide alone, which is known in the hole.
    Image<float> guide(kSide, kSide), values(kSide, kSide);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            guide(x, y) = std::hypot(static_cast<float>(x - 36), static_cast<float>(y - 36)) < 6 || x < 14
                              ? 1.0f
                              : 0.0f;
            values(x, y) = guide(x, y);
        }
    Image<float> spoilt = values;
    for (std::size_t i = 0; i < spoilt.size(); ++i)
        if (kHole.pixels()[i] > 0) spoilt.pixels()[i] = -3;
    std::vector<SynthesisChannel> guided = {{spoilt}, {guide, true}}, alone = {{spoilt}};
    ASSERT_TRUE(synthesise_into(guided, kHole, usable()));
    ASSERT_TRUE(synthesise_into(alone, kHole, usable()));
    EXPECT_GT(guided[0].values(36, 36), 0.8f);
    EXPECT_LT(alone[0].values(36, 36), 0.2f);
    EXPECT_TRUE(images_identical(guided[1].values, guide));
}

TEST(TextureSynthesis, SaysWhereThereIsNothingToTakeFrom) {
    std::vector<SynthesisChannel> channels = {{stripes()}};
    EXPECT_FALSE(synthesise_into(channels, kHole, Mask(kSide, kSide)));
    EXPECT_TRUE(images_identical(channels[0].values, stripes()));
    Image<Rgb> colours(12, 12, Rgb(0.5f));
    EXPECT_NE(error_of([&] {
                  inpaint_into(colours, square(12, 3, 9), Inpainting::patches);
              }).find("no whole patch"),
              std::string::npos);
    EXPECT_THROW(synthesise_into(channels, kHole, usable(), {.patch_px = 4}), ContractError);
}

TEST(Fill, OfPatchesHasTheReliefOfTheSurroundings) {
    auto surface = flat_surface(kSide, kSide);
    const Image<float> relief = stripes();
    for (std::size_t i = 0; i < relief.size(); ++i)
        surface->height_mm.pixels()[i] = kHole.pixels()[i] > 0 ? -0.5f : 0.05f * relief.pixels()[i];
    const auto filled = [&](FillTexture texture) {
        Canvas canvas(surface);
        lay_fill(canvas, "fill 1", kHole, {}, {texture, Rgb(0.8f), {.rim_mm = 0.3}});
        return relief_of(canvas);
    };
    Image<float> truth = relief;
    for (float& v : truth.pixels()) v *= 0.05f;
    EXPECT_LT(rms_inside(filled(FillTexture::patches), truth),
              0.6 * rms_inside(filled(FillTexture::smooth), truth));
}

}  // namespace
}  // namespace tangi
