// drawdown_card_test.cpp: cards show what films of the paints look like.
#include "paint/optics/drawdown_card.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "paint/optics/kubelka_munk.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

constexpr int kCard = 200, kGap = 5;

Palette of(std::initializer_list<const char*> names) {
    Palette palette;
    palette.name = "some";
    for (const char* name : names) palette.paints.push_back(artist_acrylics().at(name));
    return palette;
}

Image<Rgb> cards_of(const Palette& palette, Illuminant light = Illuminant::d65, int columns = 4) {
    DrawdownOptions options;
    options.card_px = kCard;
    options.columns = columns;
    return drawdown_cards(palette, light, options);
}

// The pixel at a place of the first card, in parts of its width.
Rgb at(const Image<Rgb>& sheet, double x, double y) {
    return sheet(kGap + static_cast<int>(x * kCard), kGap + static_cast<int>(y * kCard));
}

TEST(DrawdownCards, ShowMasstoneAndTints) {
    const Palette palette = of({"Cadmium Red Light", "Titanium White"});
    for (const Illuminant light : {Illuminant::d65, Illuminant::a}) {
        const Image<Rgb> sheet = cards_of(palette, light);
        const float parts[][2] = {{1, 0}, {0.1f, 0.9f}, {0.02f, 0.98f}};
        const double places[] = {0.2, 0.5, 0.8};
        for (int i = 0; i < 3; ++i) {
            // Half a millimetre hides with this paint: less than 1 % of the card comes through.
            const Rgb expected = to_linear_rgb(opaque_look(mix(palette.paints, parts[i])), light);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(at(sheet, places[i], 0.25)[c], expected[c], 0.01) << i;
        }
    }
}

TEST(DrawdownCards, ShowHowFilmsHideAsTheyThicken) {
    const Image<Rgb> sheet = cards_of(of({"Titanium White"}));
    const double black_row = 0.60, white_row = 0.525;
    double contrast = 2;
    EXPECT_LT(luminance(at(sheet, 0.06, black_row)), 0.05) << "bare card";
    for (const double x : {0.1, 0.2, 0.4, 0.6, 0.9}) {
        const double now = double(luminance(at(sheet, x, white_row)) - luminance(at(sheet, x, black_row)));
        EXPECT_GT(now, 0);
        EXPECT_LT(now, contrast);
        contrast = now;
    }
    EXPECT_LT(contrast, 0.02);
}

TEST(DrawdownCards, FillRows) {
    const Palette palette = of({"Titanium White", "Bone Black", "Cobalt Blue"});
    const Image<Rgb> one_row = cards_of(palette), two_rows = cards_of(palette, Illuminant::d65, 2);
    EXPECT_EQ(one_row.width(), 3 * (kCard + kGap) + kGap);
    EXPECT_EQ(one_row.height(), 160 + 2 * kGap);
    EXPECT_EQ(two_rows.width(), 2 * (kCard + kGap) + kGap);
    EXPECT_EQ(two_rows.height(), 2 * (160 + kGap) + kGap);
    EXPECT_TRUE(images_identical(one_row, cards_of(palette)));
}

TEST(DrawdownCards, UseTheWhiteThatThereIs) {
    EXPECT_EQ(white_of(artist_acrylics()).name, "Titanium White");
    EXPECT_EQ(white_of(of({"Bone Black", "Bismuth Vanadate Yellow"})).name, "Titanium White")
        << "yellow is no white";
    Palette palette = of({"Bone Black"});
    palette.paints.push_back(pigment_of_rgb("Lead White", {0.9f, 0.88f, 0.84f}));
    EXPECT_EQ(white_of(palette).name, "Lead White");
}

TEST(DrawdownCards, CanBeStoppedAndAreNotTooLarge) {
    const Palette palette = of({"Bone Black", "Cobalt Blue"});
    const Progress stop = [](std::string_view, double) { return false; };
    EXPECT_THROW(drawdown_cards(palette, Illuminant::d65, {}, stop), Cancelled);
    DrawdownOptions options;
    options.card_px = 2000;
    EXPECT_THAT(error_of([&] {
                    drawdown_cards(
                        [] {
                            Palette many = artist_acrylics();
                            for (int i = 0; i < 3; ++i)
                                many.paints.insert(many.paints.end(), many.paints.begin(),
                                                   many.paints.begin() + 19);
                            return many;
                        }(),
                        Illuminant::d65, options);
                }),
                HasSubstr("make them smaller with --card-px"));
    options.card_px = 1;
    EXPECT_THAT(error_of([&] { drawdown_cards(palette, Illuminant::d65, options); }),
                HasSubstr("drawdown.card_px = 1"));
}

}  // namespace
}  // namespace tangi
