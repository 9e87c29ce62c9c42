// spectrum_test.cpp: twelve bands as colour, and a reflectance for every colour.
#include "paint/optics/spectrum.h"

#include <gtest/gtest.h>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

constexpr Illuminant kAll[] = {Illuminant::a, Illuminant::d50, Illuminant::d65, Illuminant::f11,
                               Illuminant::warm_led};

Spectrum flat(float reflectance) {
    Spectrum spectrum;
    spectrum.fill(reflectance);
    return spectrum;
}

Spectrum random_spectrum(Random& random) {
    Spectrum spectrum;
    for (float& r : spectrum) r = random.real();
    return spectrum;
}

TEST(Illuminants, HaveTheWhitesOfTheirTables) {
    // CIE 15:2004, table T.3 (A, D50, D65) and T.7 (F11), XYZ of the 2 degree observer, Y = 1.
    const std::pair<Illuminant, glm::dvec3> published[] = {{Illuminant::a, {1.0985, 1, 0.3558}},
                                                           {Illuminant::d50, {0.9642, 1, 0.8251}},
                                                           {Illuminant::d65, {0.9504, 1, 1.0888}},
                                                           {Illuminant::f11, {1.0096, 1, 0.6435}}};
    for (const auto& [light, xyz] : published)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(white_xyz(light)[c], xyz[c], 2e-4) << name_of(light) << c;
    // The LED has the colour of a Planckian radiator of 3000 K: x = 0.4369, y = 0.4041.
    const glm::dvec3 led = white_xyz(Illuminant::warm_led);
    EXPECT_NEAR(led.x / (led.x + led.y + led.z), 0.4369, 2e-4);
    EXPECT_NEAR(led.y / (led.x + led.y + led.z), 0.4041, 2e-4);
}

TEST(Illuminants, HaveNames) {
    for (const Illuminant light : kAll) EXPECT_EQ(illuminant_named(name_of(light)), light);
    EXPECT_EQ(illuminant_named("d65"), Illuminant::d65);
    EXPECT_EQ(illuminant_named("D6"), std::nullopt);
    EXPECT_EQ(illuminant_named("D655"), std::nullopt);
    EXPECT_EQ(illuminant_named(""), std::nullopt);
}

TEST(Spectra, ThatAreGreyStayGreyUnderEveryLight) {
    for (const Illuminant light : kAll)
        for (const float grey : {0.0f, 0.01f, 0.18f, 0.5f, 1.0f}) {
            const Rgb rgb = to_linear_rgb(flat(grey), light);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], grey, 2e-6) << name_of(light);
            const Lab lab = lab_under(flat(grey), light);
            EXPECT_NEAR(lab.a, 0, 1e-5);
            EXPECT_NEAR(lab.b, 0, 1e-5);
        }
}

TEST(Spectra, ChangeColourWithTheLightUnlessGrey) {
    // A reddish surface under tungsten light looks lighter than under daylight, a bluish one darker.
    Spectrum red = flat(0.1f), blue = flat(0.1f);
    for (std::size_t band = 9; band < kBands; ++band) red[band] = 0.8f;
    for (std::size_t band = 0; band < 3; ++band) blue[band] = 0.8f;
    EXPECT_GT(lab_under(red, Illuminant::a).l, lab_under(red, Illuminant::d65).l + 2);
    EXPECT_LT(lab_under(blue, Illuminant::a).l, lab_under(blue, Illuminant::d65).l - 2);
}

TEST(Spectra, UnderD65HaveTheLabOfTheirRgb) {
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        // Few of them are colours that a display can show; negative values count too.
        const Spectrum spectrum = random_spectrum(random);
        const Lab direct = lab_under(spectrum), through_rgb = lab_from_linear(to_linear_rgb(spectrum));
        EXPECT_LT(delta_e_2000(direct, through_rgb), 2e-3);
    }
}

TEST(RgbWeights, AreWhatToLinearRgbDoes) {
    Random random(2);
    for (const Illuminant light : kAll) {
        const auto weights = rgb_weights(light);
        const Spectrum spectrum = random_spectrum(random);
        const Rgb rgb = to_linear_rgb(spectrum, light);
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (std::size_t band = 0; band < kBands; ++band)
                sum += double(weights[c][band]) * double(spectrum[band]);
            EXPECT_NEAR(rgb[static_cast<int>(c)], sum, 1e-6);
        }
    }
}

TEST(ReflectanceOfRgb, HasTheColourAndIsAReflectance) {
    Random random(3);
    for (int i = 0; i < 5000; ++i) {
        Rgb rgb(random.real(), random.real(), random.real());
        if (i < 8) rgb = Rgb(i & 1, (i >> 1) & 1, (i >> 2) & 1);  // the corners: the most saturated colours
        const Spectrum spectrum = reflectance_of_rgb(rgb);
        for (const float r : spectrum) {
            EXPECT_GE(r, 0);
            EXPECT_LE(r, 1);
        }
        const Rgb back = to_linear_rgb(spectrum);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(back[c], rgb[c], 1e-5) << i;
    }
}

TEST(ReflectanceOfRgb, IsFlatForGreyAndSmoothForPaleColours) {
    for (const float grey : {0.0f, 0.2f, 1.0f})
        for (const float r : reflectance_of_rgb(Rgb(grey))) EXPECT_NEAR(r, grey, 1e-6);
    // Linear: half the chroma is half the steps.
    const Spectrum strong = reflectance_of_rgb({0.8f, 0.4f, 0.4f}),
                   pale = reflectance_of_rgb({0.6f, 0.4f, 0.4f});
    for (std::size_t band = 1; band < kBands; ++band)
        EXPECT_NEAR(strong[band] - strong[band - 1], 2 * (pale[band] - pale[band - 1]), 1e-6);
}

TEST(ReflectanceOfRgb, OutsideOfTheGamutIsLimited) {
    for (const float r : reflectance_of_rgb({2, -1, 0.5f})) {
        EXPECT_GE(r, 0);
        EXPECT_LE(r, 1);
    }
    // A little outside of the triangle, where the reflectance still fits, the colour comes out.
    const Rgb cyan(-0.005f, 0.5f, 0.5f), back = to_linear_rgb(reflectance_of_rgb({0.3f, 0.5f, 0.5f}));
    EXPECT_NEAR(back.r, 0.3, 1e-5);
    EXPECT_NEAR(to_linear_rgb(reflectance_of_rgb(cyan)).g, 0.5, 0.01);
}

}  // namespace
}  // namespace tangi
