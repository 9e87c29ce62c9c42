// kubelka_munk_test.cpp: films of paint against the closed form, against the two-flux equations, and
// what painters know.
#include "paint/optics/kubelka_munk.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>

#include "paint/optics/palette.h"
#include "tests/support/test_support.h"

namespace tangi {
namespace {

// Kubelka 1948, as it is printed.
double coth_form(double k, double s, double x, double background) {
    const double a = (k + s) / s, b = std::sqrt(a * a - 1), coth = 1 / std::tanh(b * s * x);
    return (1 - background * (a - b * coth)) / (a - background + b * coth);
}

// The two fluxes, as reflectance of a growing film: dR/dx = S - 2 (K + S) R + S R^2 (Kubelka & Munk 1931), by
// Runge and Kutta's fourth-order method.
double integrated(double k, double s, double thickness, double background) {
    const auto slope = [&](double r) { return s - 2 * (k + s) * r + s * r * r; };
    const int steps = static_cast<int>(200 + 200 * (k + s) * thickness);
    const double h = thickness / steps;
    double r = background;
    for (int i = 0; i < steps; ++i) {
        const double k1 = slope(r), k2 = slope(r + h / 2 * k1), k3 = slope(r + h / 2 * k2),
                     k4 = slope(r + h * k3);
        r += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return r;
}

double hue_deg(const Lab& lab) {
    const double hue = std::atan2(lab.b, lab.a) * 180 / std::numbers::pi;
    return hue < 0 ? hue + 360 : hue;
}

std::vector<float> volumes_of(const Palette& palette,
                              std::initializer_list<std::pair<const char*, float>> parts) {
    std::vector<float> volumes(palette.paints.size(), 0.0f);
    for (const auto& [name, volume] : parts)
        volumes.at(static_cast<std::size_t>(palette.find(name))) = volume;
    return volumes;
}

Lab look_of(std::initializer_list<std::pair<const char*, float>> parts) {
    const Palette& palette = artist_acrylics();
    return lab_under(opaque_look(mix(palette.paints, volumes_of(palette, parts))));
}

TEST(Films, AgreeWithTheClosedForm) {
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const double k = std::pow(10, random.uniform(-3, 2)), s = std::pow(10, random.uniform(-2, 2));
        const double x = std::pow(10, random.uniform(-2, 0.5)), background = random.uniform();
        const double expected = coth_form(k, s, x, background);
        EXPECT_NEAR(film_reflectance(k * x, s * x, background), expected, 1e-9) << k << " " << s << " " << x;
        EXPECT_NEAR(film_reflectance(float(k * x), float(s * x), float(background)), expected, 2e-6)
            << k << " " << s << " " << x << " " << background;
    }
}

TEST(Films, AgreeWithTheTwoFluxesIntegrated) {
    Random random(2);
    for (int i = 0; i < 200; ++i) {
        const double k = std::pow(10, random.uniform(-3, 1)), s = std::pow(10, random.uniform(-3, 1));
        const double x = random.uniform(0, 3), background = random.uniform();
        EXPECT_NEAR(film_reflectance(k * x, s * x, background), integrated(k, s, x, background), 1e-8);
    }
    // Without scattering (Lambert's law, twice) and without absorption.
    EXPECT_NEAR(film_reflectance(0.7, 0.0, 0.6), 0.6 * std::exp(-1.4), 1e-12);
    EXPECT_NEAR(film_reflectance(0.0, 3.0, 0.0), 3.0 / 4.0, 1e-12);
    EXPECT_NEAR(film_reflectance(0.0, 3.0, 0.4), integrated(0, 3, 1, 0.4), 1e-8);
}

TEST(Films, AreFiniteAndKeepEnergyAtEveryLimit) {
    const float extremes[] = {0, 1e-30f, 1e-12f, 1e-6f, 1e-3f, 1, 50, 1e4f, 1e8f};
    for (const float kx : extremes)
        for (const float sx : extremes)
            for (const float background : {0.0f, 1e-6f, 0.3f, 1.0f}) {
                const float r = film_reflectance(kx, sx, background);
                ASSERT_GE(r, 0) << kx << " " << sx;
                ASSERT_LE(r, 1) << kx << " " << sx;
            }
    EXPECT_EQ(film_reflectance(0.0f, 0.0f, 0.37f), 0.37f);
    EXPECT_EQ(opaque_reflectance(0.0f, 0.0f), 1) << "without K nothing is lost, as with any S";
    EXPECT_EQ(opaque_reflectance(0.0f, 5.0f), 1);
    EXPECT_EQ(opaque_reflectance(5.0f, 0.0f), 0);
}

// The limits of Kubelka's solution: S -> 0, where light goes down and up once, R = Rg exp(-2 K X); K -> 0,
// where none is lost, R = (Rg + (1 - Rg) S X) / (1 + (1 - Rg) S X); both, where the film is clear.
TEST(Films, WithoutScatteringOrAbsorptionAreTheLimitsOfTheClosedForm) {
    for (const double rest : {0.0, 1e-30, 1e-12, 1e-9})
        for (const double x : {0.0, 1e-6, 0.01, 0.3, 1.0, 4.0, 20.0})
            for (const double rg : {0.02, 0.5, 0.9, 1.0}) {
                EXPECT_NEAR(film_reflectance(x, rest, rg), rg * std::exp(-2 * x), 1e-7) << x << " " << rest;
                EXPECT_NEAR(film_reflectance(rest, x, rg), (rg + (1 - rg) * x) / (1 + (1 - rg) * x), 3e-4)
                    << x << " " << rest;
                EXPECT_NEAR(film_reflectance(rest, rest, rg), rg, 1e-8);
                EXPECT_NEAR(
                    film_reflectance(static_cast<float>(x), static_cast<float>(rest), static_cast<float>(rg)),
                    rg * std::exp(-2 * x), 1e-5);
            }
}

// A medium with next to nothing in it shows what is below, however thick it lies: pixel by pixel as in one.
TEST(Films, OfAClearMediumAreClear) {
    for (const float rest : {0.0f, 1e-12f, 1e-6f, 1e-5f}) {
        // Down and up 2 mm, as often as the boundary throws light back.
        const double lost =
            2 * 2 * static_cast<double>(rest) / (1 - static_cast<double>(kInternalReflection));
        Pigment medium;
        medium.k.fill(rest);
        medium.s.fill(rest);
        EXPECT_TRUE(is_clear(medium));
        const std::vector<Rgb> dry = {Rgb(0), Rgb(0.2f, 0.5f, 0.8f), Rgb(1)};
        const std::vector<float> mm(3, 2.0f);
        std::vector<Rgb> seen(3);
        const std::vector<std::span<const float>> volumes = {mm};
        FilmBatch({&medium, 1}).look(volumes, dry, seen);
        for (std::size_t i = 0; i < dry.size(); ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(seen[i][c], dry[i][c], 1.01 * lost + 5e-6) << rest << " " << i;
        Spectrum below;
        below.fill(0.4f);
        for (const float r : film_look({medium.k, medium.s}, 2, below))
            EXPECT_NEAR(r, 0.4f, 1.01 * lost + 5e-6);
    }
    for (const Pigment& paint : artist_acrylics().paints) EXPECT_FALSE(is_clear(paint)) << paint.name;
}

TEST(Films, ApproachTheOpaqueLookWithoutTurningBack) {
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const double k = std::pow(10, random.uniform(-3, 2)), s = std::pow(10, random.uniform(-2, 2));
        const double background = random.uniform(), end = opaque_reflectance(k, s);
        double distance = std::abs(background - end);
        for (double x = 1e-4; x < 1e3; x *= 1.5) {
            const double now = film_reflectance(k * x, s * x, background) - end;
            ASSERT_LE(std::abs(now), distance + 1e-12);
            ASSERT_GE(now * (background - end), -1e-12) << "on the other side";
            distance = std::abs(now);
        }
        // (1 - R)^2 / 2R has R again; at k >> s little of it is left.
        EXPECT_NEAR(k_over_s(end), k / s, 1e-9 * (1 + k / s) / end);
    }
}

TEST(Films, InTwoLayersAreOneOfBothThicknesses) {
    const double k = 0.8, s = 2.5;
    for (const double background : {0.0, 0.5, 1.0}) {
        const double below = film_reflectance(k * 0.3, s * 0.3, background);
        EXPECT_NEAR(film_reflectance(k * 0.5, s * 0.5, below), film_reflectance(k * 0.8, s * 0.8, background),
                    1e-12);
    }
}

TEST(Boundary, HasAnInverseAndKeepsWhiteWhite) {
    for (float r = 0; r <= 1; r += 0.01f) {
        EXPECT_NEAR(inside_of(outside_of(r)), r, 1e-6);
        EXPECT_NEAR(outside_of(inside_of(r)), r, 1e-6);
        EXPECT_LE(outside_of(r), r + 1e-7f);  // light is held back, and absorbed
    }
    EXPECT_EQ(outside_of(0.0f), 0);
    EXPECT_FLOAT_EQ(outside_of(1.0f), 1);
    EXPECT_EQ(outside_of(0.3f, 0.0f), 0.3f);
    // Saunderson 1942 with k1 = 0, by hand: 0.4 * 0.5 / (1 - 0.6 * 0.5).
    EXPECT_NEAR(outside_of(0.5f), 0.2 / 0.7, 1e-7);
}

TEST(Mixing, APaintWithItselfChangesNothing) {
    for (const Pigment& paint : artist_acrylics().paints) {
        const Pigment twice[] = {paint, paint};
        const float parts[] = {0.3f, 1.9f};
        const Medium mixture = mix(twice, parts);
        for (std::size_t band = 0; band < kBands; ++band) {
            EXPECT_FLOAT_EQ(mixture.k[band], paint.k[band]) << paint.name;
            EXPECT_FLOAT_EQ(mixture.s[band], paint.s[band]) << paint.name;
        }
    }
}

TEST(Mixing, DoesNotDependOnOrderOrAmount) {
    const auto& paints = artist_acrylics().paints;
    const Pigment one[] = {paints[0], paints[3], paints[11]}, other[] = {paints[11], paints[0], paints[3]};
    const float parts[] = {1, 2, 0.5f}, moved[] = {0.5f * 7, 1 * 7, 2 * 7};
    const Medium a = mix(one, parts), b = mix(other, moved);
    for (std::size_t band = 0; band < kBands; ++band) {
        EXPECT_NEAR(a.k[band], b.k[band], 1e-6f * a.k[band]);
        EXPECT_NEAR(a.s[band], b.s[band], 1e-6f * a.s[band]);
    }
    const float nothing[] = {0, 0, 0};
    for (const float k : mix(one, nothing).k) EXPECT_EQ(k, 0);
}

TEST(Mixing, RefusesWhatIsNoMixture) {
    const auto& paints = artist_acrylics().paints;
    const float two[] = {1, 1}, negative[] = {1, -1};
    EXPECT_THROW(mix({paints.data(), 3}, two), ContractError);
    EXPECT_THROW(mix({paints.data(), 2}, negative), ContractError);
}

TEST(Mixing, BlueAndYellowMakeGreen) {
    for (const char* yellow : {"Hansa Yellow Opaque", "Bismuth Vanadate Yellow"})
        for (const char* blue : {"Phthalo Blue (Green Shade)", "Cerulean Blue Chromium", "Cobalt Blue"}) {
            // Blues differ in strength by a factor of thirty: enough of each that neither wins.
            const float part = std::string_view(blue).starts_with("Phthalo") ? 0.04f : 0.5f;
            const Lab green = look_of({{yellow, 1 - part}, {blue, part}});
            EXPECT_GT(hue_deg(green), 110) << yellow << ", " << blue;
            EXPECT_LT(hue_deg(green), 180) << yellow << ", " << blue;
            EXPECT_GT(std::hypot(green.a, green.b), 15) << yellow << ", " << blue;
        }
}

TEST(Mixing, WhiteInPhthaloBlueTurnsItFromVioletToCyan) {
    const Lab masstone = look_of({{"Phthalo Blue (Green Shade)", 1.0f}});
    const Lab tint = look_of({{"Phthalo Blue (Green Shade)", 0.1f}, {"Titanium White", 0.9f}});
    EXPECT_LT(masstone.l, 25);
    EXPECT_GT(tint.l, masstone.l + 20);
    EXPECT_GT(hue_deg(masstone), 280);
    EXPECT_LT(hue_deg(tint), 265);
}

TEST(Looks, OfWhiteOverBlackHideWithThickness) {
    const Pigment& white = artist_acrylics().at("Titanium White");
    Spectrum black;
    black.fill(0.01f);
    double before = lab_under(black).l;
    for (const float thickness_mm : {0.003f, 0.01f, 0.03f, 0.1f, 0.3f}) {
        const Spectrum look = film_look({white.k, white.s}, thickness_mm, black);
        for (std::size_t band = 0; band < kBands; ++band) {
            const double inside = coth_form(double(white.k[band]), double(white.s[band]),
                                            double(thickness_mm), inside_of(0.01));
            EXPECT_NEAR(look[band], outside_of(inside, 0.6), 2e-5);
        }
        const double lightness = lab_under(look).l;
        EXPECT_GT(lightness, before);
        before = lightness;
    }
    EXPECT_GT(before, 95);
    // A thin scumble of white over black is bluish, as Leonardo describes: white scatters blue most.
    EXPECT_LT(lab_under(film_look({white.k, white.s}, 0.005f, black)).b, -2);
}

TEST(Looks, WithoutPaintAreTheDryLayer) {
    Random random(4);
    Spectrum dry;
    for (float& r : dry) r = random.real();
    const Pigment& paint = artist_acrylics().paints[5];
    const Spectrum look = film_look({paint.k, paint.s}, 0, dry);
    for (std::size_t band = 0; band < kBands; ++band) EXPECT_NEAR(look[band], dry[band], 1e-6);
}

TEST(ThesisModel, MixesAbsorbancesOfThreeChannels) {
    const Rgb yellow(1.0f, 0.9f, 0.1f), blue(0.1f, 0.2f, 0.8f);
    const Rgb same[] = {yellow, yellow}, both[] = {yellow, blue}, turned[] = {blue, yellow};
    const float equal[] = {1, 1}, unequal[] = {3, 1}, unequal_turned[] = {1, 3};
    const Rgb alone = thesis_mixture_srgb(same, unequal), one = thesis_mixture_srgb(both, unequal),
              other = thesis_mixture_srgb(turned, unequal_turned);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(alone[c], yellow[c], 1e-6);
        EXPECT_NEAR(one[c], other[c], 1e-6);
    }
    // Eq. 3.18, 3.21 and 3.24 by hand for blue: (0.9^2/0.2 + 0.2^2/1.6) / 2 = 2.0375.
    EXPECT_NEAR(thesis_mixture_srgb(both, equal).b, 1 + 2.0375 - std::sqrt(2.0375 * 2.0375 + 2 * 2.0375),
                1e-6);
    const Rgb black(0.0f);
    const float nothing[] = {0};
    EXPECT_NEAR(thesis_mixture_srgb({&black, 1}, {equal, 1}).r, 1 / 255.0, 1e-5);
    EXPECT_EQ(thesis_mixture_srgb({&yellow, 1}, nothing), yellow);
    EXPECT_THROW(thesis_mixture_srgb(both, nothing), ContractError);
}

// How far the thesis's model is from the spectral one: mixtures of two paints and white.
TEST(ThesisModel, IsFarFromTheSpectralOne) {
    const auto& paints = artist_acrylics().paints;
    const Transfer srgb{Transfer::Kind::srgb};
    Random random(5);
    double mean = 0;
    constexpr int kMixtures = 1000;
    for (int i = 0; i < kMixtures; ++i) {
        const Pigment chosen[] = {paints[0], paints[static_cast<std::size_t>(1 + random.below(18))],
                                  paints[static_cast<std::size_t>(1 + random.below(18))]};
        std::vector<float> parts;
        std::vector<Rgb> colours;
        for (const Pigment& paint : chosen) {
            parts.push_back(static_cast<float>(-std::log(1 - random.uniform())));
            colours.push_back(
                srgb.encode(glm::clamp(to_linear_rgb(opaque_look({paint.k, paint.s})), Rgb(0), Rgb(1))));
        }
        const Rgb thesis = thesis_mixture_srgb(colours, parts);
        const Rgb linear = srgb.decode(thesis);
        // What a screen can show of the spectral one, so that only mixing is compared.
        const Rgb spectral = glm::clamp(to_linear_rgb(opaque_look(mix(chosen, parts))), Rgb(0), Rgb(1));
        mean += delta_e_2000(lab_from_linear(linear), lab_from_linear(spectral)) / kMixtures;
    }
    fmt::print("thesis model against the spectral one: mean dE2000 {:.1f}\n", mean);
    EXPECT_GT(mean, 5);
    EXPECT_LT(mean, 40);
}

}  // namespace
}  // namespace tangi
