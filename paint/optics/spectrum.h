// spectrum.h: reflectance in 12 bands; what it looks like under a light, and a reflectance for a colour.
//
// The bands lie where artists' paints change most, not at equal distances. Weights that turn them into XYZ
// were fitted to mixtures of paints known at 38 wavelengths (docs/theory/kubelka-munk.md: method and errors).
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "surface/image/colour.h"

namespace tangi {

inline constexpr int kBands = 12;
using Spectrum = std::array<float, kBands>;  // one number a band; a reflectance is 0..1
inline constexpr std::array<float, kBands> kBand_nm = {410, 440, 470, 500, 510, 530,
                                                       550, 560, 580, 600, 630, 680};

// Lights that paint is looked at under: CIE A (tungsten), D50, D65 (daylight), F11 (three-band fluorescent;
// CIE 15), and a white LED of 3000 K: a blue peak at 452 nm and a phosphor's broad one at 588 nm
// (docs/theory/kubelka-munk.md).
enum class Illuminant { a, d50, d65, f11, warm_led };
inline constexpr int kIlluminants = 5;

// "A", "D50", "D65", "F11", "LED"; read in any case, nothing for another word.
std::string_view name_of(Illuminant illuminant);
std::optional<Illuminant> illuminant_named(std::string_view name);

// CIE 1931 XYZ of a surface under a light; Y of a perfect white is 1.
glm::dvec3 xyz_of(const Spectrum& reflectance, Illuminant illuminant);
glm::dvec3 white_xyz(Illuminant illuminant);

// Linear Rec. 709 of a surface under a light, as it looks to eyes that are used to the light: adapted to D65
// by Bradford's matrix (Lam 1985, as in ICC.1:2010, annex E). Grey is grey under every light. Not clipped.
Rgb to_linear_rgb(const Spectrum& reflectance, Illuminant illuminant = Illuminant::d65);

// The same as weights: rgb[c] = sum of weights[c][band] * reflectance[band].
std::array<Spectrum, 3> rgb_weights(Illuminant illuminant);

// CIE 1976 L*a*b* relative to the light's own white, 2 degrees.
Lab lab_under(const Spectrum& reflectance, Illuminant illuminant = Illuminant::d65);

// A reflectance whose colour under D65 is `linear`, exactly (to 1e-5) where all of it lies in [0, 1]. The sum
// of three reflectances, for red, green and blue, each in [0, 1] and all together 1: the smoothest ones
// (Mallett & Yuksel 2019, here for 12 bands). So it is linear, grey is flat, and 36 multiplications do.
// Colours outside of [0, 1] give what is nearest, band by band.
Spectrum reflectance_of_rgb(const Rgb& linear);

// The three reflectances. Outside of [0, 1], their sum is not a reflectance, but still has the colour.
const std::array<Spectrum, 3>& rgb_basis();

}  // namespace tangi
