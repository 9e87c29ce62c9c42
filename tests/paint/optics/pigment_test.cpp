// pigment_test.cpp: K and S from what paints look like; how thick they hide.
#include "paint/optics/pigment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "paint/optics/kubelka_munk.h"
#include "paint/optics/palette.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

using testing::HasSubstr;

const Pigment& white() { return artist_acrylics().at("Titanium White"); }

Medium tinted(const Pigment& paint, float concentration) {
    const Pigment both[] = {paint, white()};
    const float parts[] = {concentration, 1 - concentration};
    return mix(both, parts);
}

TEST(PigmentOfTint, FindsKAndSThatMadeTheSamples) {
    for (const Pigment& paint : artist_acrylics().paints) {
        if (paint.name == white().name) continue;
        const Spectrum masstone = opaque_look({paint.k, paint.s}), tint = opaque_look(tinted(paint, 0.2f));
        const Pigment found = pigment_of_tint(paint.name, masstone, tint, 0.2f, white());
        EXPECT_EQ(found.origin, PigmentOrigin::masstone_and_tint);
        EXPECT_FALSE(found.approximate());
        int good = 0;
        for (std::size_t band = 0; band < kBands; ++band)
            good += std::abs(found.s[band] / paint.s[band] - 1) < 0.02f &&
                    std::abs(found.k[band] / paint.k[band] - 1) < 0.02f;
        // Where a paint is as bright as white, nothing tells its S: but then mixtures don't depend on it
        // either.
        EXPECT_GE(good, 7) << paint.name;
        for (const float concentration : {0.02f, 0.5f, 0.9f})
            EXPECT_LT(delta_e_2000(lab_under(opaque_look(tinted(found, concentration))),
                                   lab_under(opaque_look(tinted(paint, concentration)))),
                      0.5)
                << paint.name << " " << concentration;
    }
}

TEST(PigmentOfTint, SaysWhatCannotBe) {
    const Pigment& blue = artist_acrylics().at("Cobalt Blue");
    const Spectrum masstone = opaque_look({blue.k, blue.s}), tint = opaque_look(tinted(blue, 0.2f));
    EXPECT_THAT(error_of([&] { pigment_of_tint("Cobalt", tint, masstone, 0.2f, white()); }),
                testing::AllOf(HasSubstr("paint 'Cobalt'"), HasSubstr("may be exchanged")));
    EXPECT_THAT(error_of([&] { pigment_of_tint("Cobalt", masstone, tint, 1, white()); }),
                HasSubstr("concentration 1 of the tint"));
    EXPECT_THAT(error_of([&] { pigment_of_tint("Cobalt", masstone, masstone, 0.2f, white()); }),
                testing::AllOf(HasSubstr("paint 'Cobalt'"), HasSubstr("its tint is its masstone")));
    // Another white with white in it is as white: that is no fault of the measurement.
    const Spectrum bright = opaque_look({white().k, white().s});
    EXPECT_NO_THROW(pigment_of_tint("Zinc", bright, bright, 0.2f, white()));
    Spectrum percent = tint;
    for (float& r : percent) r *= 100;
    EXPECT_THAT(error_of([&] { pigment_of_tint("Cobalt", masstone, percent, 0.2f, white()); }),
                HasSubstr("the tint reflects"));
}

TEST(PigmentOfRgb, LooksLikeItsColourWhereItHides) {
    Random random(1);
    for (int i = 0; i < 300; ++i) {
        Rgb rgb(random.real(), random.real(), random.real());
        if (i < 8) rgb = Rgb(i & 1, (i >> 1) & 1, (i >> 2) & 1);
        const Pigment paint = pigment_of_rgb("mixed", rgb);
        EXPECT_TRUE(paint.approximate());
        const Rgb look = to_linear_rgb(opaque_look({paint.k, paint.s}));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(look[c], rgb[c], 2e-3) << i;
    }
}

TEST(PigmentOfRgb, HidesAtTheThicknessAskedFor) {
    for (const float hiding_mm : {0.02f, 0.1f, 0.4f})
        for (const Rgb& rgb : {Rgb(0.8f, 0.75f, 0.6f), Rgb(0.5f, 0.05f, 0.04f), Rgb(0.01f, 0.01f, 0.012f)}) {
            const Pigment paint = pigment_of_rgb("p", rgb, hiding_mm);
            EXPECT_NEAR(hiding_thickness_mm(paint), hiding_mm, 1e-3 * double(hiding_mm));
            EXPECT_NEAR(contrast_ratio(paint, hiding_mm), 0.98, 1e-4);
            EXPECT_LT(contrast_ratio(paint, hiding_mm / 3), 0.97);
        }
}

TEST(PigmentOfRgb, RefusesWhatIsNoPaint) {
    EXPECT_THAT(error_of([] {
                    pigment_of_rgb("neon", {0.5f, 1.2f, 0.5f});
                }),
                HasSubstr("paint 'neon': green is 1.2"));
    EXPECT_THAT(error_of([] { pigment_of_rgb("neon", Rgb(std::nanf(""))); }), HasSubstr("red is nan"));
    EXPECT_THAT(error_of([] { pigment_of_rgb("thin", Rgb(0.5f), 0); }), HasSubstr("hiding thickness 0 mm"));
}

TEST(PigmentOfMasstone, HasItsReflectance) {
    const Pigment& red = artist_acrylics().at("Pyrrole Red");
    const Spectrum masstone = opaque_look({red.k, red.s});
    const Pigment guess = pigment_of_masstone("red", masstone);
    EXPECT_EQ(guess.origin, PigmentOrigin::masstone);
    const Spectrum look = opaque_look({guess.k, guess.s});
    for (std::size_t band = 0; band < kBands; ++band) EXPECT_NEAR(look[band], masstone[band], 1e-3);
}

TEST(Hiding, OfTheBuiltInPaintsIsThatOfRealOnes) {
    // The scale of the tables was chosen so that titanium white hides (98 %, ISO 6504) at about 0.1 mm of dry
    // paint.
    EXPECT_NEAR(hiding_thickness_mm(white()), 0.1, 0.03);
    // Black, which absorbs, hides in a film several times thinner; transparent colours as glazes need more.
    EXPECT_LT(hiding_thickness_mm(artist_acrylics().at("Bone Black")), 0.05);
    EXPECT_GT(hiding_thickness_mm(artist_acrylics().at("Quinacridone Red")),
              hiding_thickness_mm(artist_acrylics().at("Cadmium Red Light")));
    double before = 0;
    for (const float thickness_mm : {0.005f, 0.01f, 0.05f, 0.1f, 0.5f}) {
        const double now = contrast_ratio(white(), thickness_mm);
        EXPECT_GT(now, before);
        before = now;
    }
    EXPECT_NEAR(contrast_ratio(white(), 0), 0.01 / 0.80, 1e-5);
}

TEST(Hiding, OfWhatNeverDoesIsTheLimit) {
    Pigment water;
    EXPECT_EQ(hiding_thickness_mm(water), 10);
}

}  // namespace
}  // namespace tangi
