// colour_test.cpp: transfer curves and CIE colour against published values.
#include "surface/image/colour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/support/test_support.h"

namespace tangi {
namespace {

Transfer gamma(double value) { return {Transfer::Kind::gamma, value}; }
Transfer curve(double gamma, double bend, double bow) { return {Transfer::Kind::curve, gamma, bend, bow}; }

struct Pair {
    Lab first, second;
    double delta_e;
};

// Sharma, Wu, Dalal 2005, table 1: pairs 1, 7 (one is grey), 9, 10 (hues 180 degrees apart), 17 (large), 33
// (dark).
const Pair kPublished[] = {
    {{50.0000, 2.6772, -79.7751}, {50.0000, 0.0000, -82.7485}, 2.0425},
    {{50.0000, 0.0000, 0.0000}, {50.0000, -1.0000, 2.0000}, 2.3669},
    {{50.0000, 2.4900, -0.0010}, {50.0000, -2.4900, 0.0009}, 7.1792},
    {{50.0000, 2.4900, -0.0010}, {50.0000, -2.4900, 0.0010}, 7.1792},
    {{50.0000, 2.5000, 0.0000}, {73.0000, 25.0000, -18.0000}, 27.1492},
    {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
};

TEST(DeltaE2000, AgreesWithThePublishedPairs) {
    for (const Pair& p : kPublished) EXPECT_NEAR(delta_e_2000(p.first, p.second), p.delta_e, 1e-4);
}

TEST(DeltaE2000, IsSymmetricAndZeroOnlyForTheSameColour) {
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const auto colour = [&] {
            return Lab{random.uniform(0, 100), random.uniform(-90, 90), random.uniform(-90, 90)};
        };
        const Lab a = colour(), b = colour();
        EXPECT_NEAR(delta_e_2000(a, b), delta_e_2000(b, a), 1e-9);
        EXPECT_EQ(delta_e_2000(a, a), 0);
        EXPECT_GT(delta_e_2000(a, b), 0);
    }
}

TEST(DeltaE2000, HasNoJumpBetweenGreyAndAlmostGrey) {
    const Lab grey{50, 0, 0}, almost{50, 1e-9, -1e-9}, other{55, 3, 4};
    EXPECT_NEAR(delta_e_2000(grey, other), delta_e_2000(almost, other), 1e-6);
}

TEST(DeltaE2000, HasPartsOfWhichTheFirstIsLightness) {
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const Lab a{random.uniform(0, 100), random.uniform(-90, 90), random.uniform(-90, 90)};
        Lab b{random.uniform(0, 100), random.uniform(-90, 90), random.uniform(-90, 90)};
        const glm::dvec3 parts = delta_e_2000_parts(a, b);
        EXPECT_NEAR(glm::length(parts), delta_e_2000(a, b), 1e-9);
        b.l = a.l;
        EXPECT_EQ(delta_e_2000_parts(a, b).x, 0);
    }
}

TEST(LabD50, OfGreyIsGreyOfTheSameLuminance) {
    for (const double l : {4.0, 20.0, 50.0, 96.5, 100.0}) {
        const Rgb grey = linear_from_lab_d50({l, 0, 0});
        EXPECT_NEAR(grey.r, grey.g, 2e-5) << l;
        EXPECT_NEAR(grey.b, grey.g, 2e-5) << l;
        EXPECT_NEAR(lab_from_linear(grey).l, l, 1e-3);
    }
}

// Lindbloom's D50 matrix of sRGB (Bradford): its red is X 0.4360747, Y 0.2225045, Z 0.0139322.
TEST(LabD50, OfThePrimaryRedIsThePrimaryRed) {
    const auto f = [](double t) { return std::cbrt(t); };
    const double x = 0.4360747 / 0.96422, y = 0.2225045, z = 0.0139322 / 0.82521;
    const Rgb red = linear_from_lab_d50({116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))});
    EXPECT_NEAR(red.r, 1, 5e-4);
    EXPECT_NEAR(red.g, 0, 5e-4);
    EXPECT_NEAR(red.b, 0, 5e-4);
}

TEST(DataDeltaE2000, AgreesWithAll34Pairs) {
    TP_DATA(tables, "tables");
    std::ifstream file(tables / "ciede2000_pairs.csv");
    std::string line;
    std::getline(file, line);
    int pairs = 0;
    while (std::getline(file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        Pair p;
        fields >> p.first.l >> p.first.a >> p.first.b >> p.second.l >> p.second.a >> p.second.b >> p.delta_e;
        ASSERT_TRUE(fields) << line;
        EXPECT_NEAR(delta_e_2000(p.first, p.second), p.delta_e, 1e-4) << line;
        EXPECT_NEAR(delta_e_2000(p.second, p.first), p.delta_e, 1e-4) << line;
        ++pairs;
    }
    EXPECT_EQ(pairs, 34);
}

TEST(Lab, OfWhiteIs100) {
    // The matrix rows add up to the white of the table within its seven digits.
    const Lab white = lab_from_linear({1, 1, 1});
    EXPECT_NEAR(white.l, 100, 1e-4);
    EXPECT_NEAR(white.a, 0, 1e-4);
    EXPECT_NEAR(white.b, 0, 1e-4);
}

TEST(Lab, OfBlackIsZeroAndOfMiddleGreyIs50) {
    const Lab black = lab_from_linear({0, 0, 0});
    EXPECT_NEAR(black.l, 0, 1e-12);
    EXPECT_NEAR(black.a, 0, 1e-12);
    EXPECT_NEAR(black.b, 0, 1e-12);
    EXPECT_NEAR(lab_from_linear(Rgb(0.18418651f)).l, 50, 1e-4);  // ((50 + 16) / 116)^3
}

TEST(Lab, OfThePrimariesAgreesWithCieTables) {
    // sRGB red, green, blue: L* 53.24, 87.73, 32.30 (Lindbloom's calculator, D65).
    const struct {
        Rgb colour;
        Lab lab;
    } table[] = {{{1, 0, 0}, {53.2408, 80.0925, 67.2032}},
                 {{0, 1, 0}, {87.7347, -86.1827, 83.1793}},
                 {{0, 0, 1}, {32.2970, 79.1875, -107.8602}}};
    for (const auto& [colour, lab] : table) {
        const Lab found = lab_from_linear(colour);
        EXPECT_NEAR(found.l, lab.l, 0.01);
        EXPECT_NEAR(found.a, lab.a, 0.02);
        EXPECT_NEAR(found.b, lab.b, 0.02);
    }
}

TEST(Transfer, DecodesWhatItEncoded) {
    for (const Transfer& transfer : {kLinear, kSrgb, gamma(0.45), gamma(1), gamma(1.8), gamma(2.2), gamma(5),
                                     curve(2.2, 0, 0), curve(1.6, 1.2, -0.5), curve(2.6, -1, 0.4)})
        for (int i = 0; i <= 1500; ++i) {
            const float linear = static_cast<float>(i) / 1000;
            // Rounding of the encoded float, 6e-8, times the slope of the decoder, at most its gamma.
            EXPECT_NEAR(transfer.decode(transfer.encode(linear)), linear, 1e-6) << transfer.name();
        }
}

TEST(Transfer, KeepsBlackAndWhiteAndRises) {
    for (const Transfer& transfer : {kLinear, kSrgb, gamma(1.8), gamma(2.2), curve(1.6, 1.2, -0.5)}) {
        EXPECT_EQ(transfer.encode(0.0f), 0) << transfer.name();
        EXPECT_NEAR(transfer.encode(1.0f), 1, 1e-6) << transfer.name();
        for (int i = 0; i < 1000; ++i)
            EXPECT_LT(transfer.encode(i / 1000.0f), transfer.encode((i + 1) / 1000.0f)) << transfer.name();
    }
}

TEST(Transfer, EncodesNegativeLightAndNanAsBlack) {
    for (const Transfer& transfer : {kLinear, kSrgb, gamma(2.2), curve(1.6, 1.2, -0.5)}) {
        EXPECT_EQ(transfer.encode(-0.5f), 0) << transfer.name();
        EXPECT_EQ(transfer.decode(-0.5f), 0) << transfer.name();
        EXPECT_EQ(transfer.encode(std::nanf("")), 0) << transfer.name();
        EXPECT_EQ(transfer.decode(std::nanf("")), 0) << transfer.name();
    }
}

TEST(Transfer, ACurveWithoutBendIsAGamma) {
    for (const float x : {0.001f, 0.2f, 0.7f, 1.0f, 1.8f}) {
        EXPECT_NEAR(curve(2.2, 0, 0).encode(x), gamma(2.2).encode(x), 1e-6);
        EXPECT_NEAR(curve(2.2, 0, 0).decode(x), gamma(2.2).decode(x), 1e-6);
    }
}

TEST(Transfer, KnowsWhereACurveTurnsBack) {
    EXPECT_TRUE(curve(2.2, -0.5, 0.2).is_increasing());
    EXPECT_FALSE(curve(1, -3, 1).is_increasing());
    EXPECT_FALSE(curve(1, 8, 0).is_increasing());  // ln e < 0: a steep rise of the exponent makes a dip
}

TEST(Transfer, OfSrgbHasItsLandmarks) {
    EXPECT_NEAR(kSrgb.encode(0.18f), 0.46135613, 1e-6);
    EXPECT_NEAR(kSrgb.encode(0.21404114f), 0.5, 1e-6);
    EXPECT_NEAR(kSrgb.decode(0.5f), 0.21404114, 1e-7);
    EXPECT_NEAR(kSrgb.encode(0.001f), 0.01292, 1e-8);
    // Both branches meet at the joint to the standard's own rounding.
    EXPECT_NEAR(kSrgb.encode(0.0031308f), kSrgb.encode(0.00313081f), 1e-6);
}

TEST(Transfer, EncodesColoursChannelByChannel) {
    const Rgb encoded = kSrgb.encode(Rgb(0.1f, 0.5f, 0.9f));
    EXPECT_EQ(encoded.r, kSrgb.encode(0.1f));
    EXPECT_EQ(encoded.g, kSrgb.encode(0.5f));
    EXPECT_EQ(encoded.b, kSrgb.encode(0.9f));
}

TEST(TransferNamed, ReadsItsGrammar) {
    EXPECT_EQ(transfer_named("linear"), kLinear);
    EXPECT_EQ(transfer_named("srgb"), kSrgb);
    for (const char* name : {"2.2", "gamma 2.2", "gamma2.2", " 2.2"})
        EXPECT_EQ(transfer_named(name), gamma(2.2)) << name;
    EXPECT_EQ(transfer_named("0.2"), gamma(0.2));
    EXPECT_EQ(transfer_named("5"), gamma(5));
    for (const char* wrong : {"",
                              "gamma",
                              "gamma ",
                              "sRGB",
                              "linear ",
                              "0.19",
                              "5.01",
                              "-2.2",
                              "nan",
                              "inf",
                              "2.2x",
                              "2,2",
                              "2.2 ",
                              "rec709",
                              "gamma gamma 2",
                              "curve 2.2",
                              "curve 2.2 1 nan",
                              "curve 1 -3 1",
                              "curve 2.2 0 0 0",
                              "2.2 0 0"})
        EXPECT_FALSE(transfer_named(wrong)) << "'" << wrong << "'";
}

TEST(TransferNamed, RoundTripsEveryName) {
    EXPECT_EQ(gamma(2.2).name(), "gamma 2.2");
    for (const Transfer& transfer :
         {kLinear, kSrgb, gamma(2.2), gamma(1.8), gamma(1.0 / 0.45), gamma(2.19995), curve(2.2, -0.5, 0.1)})
        EXPECT_EQ(transfer_named(transfer.name()), transfer) << transfer.name();
}

TEST(Luminance, OfWhiteIsOne) {
    EXPECT_NEAR(luminance(Rgb(1)), 1, 1e-6);
    EXPECT_GT(luminance({0, 1, 0}), luminance({1, 0, 0}));
    EXPECT_GT(luminance({1, 0, 0}), luminance({0, 0, 1}));
}

}  // namespace
}  // namespace tangi
