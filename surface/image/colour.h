// colour.h: transfer curves, CIE colour, colour differences. Linear means scene-referred Rec. 709, white =
// D65.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "surface/image/image.h"

namespace tangi {

// How linear light became the numbers in a picture file: encoded = f(linear), both nominally 0..1.
struct Transfer {
    enum class Kind { linear, srgb, gamma, curve };
    Kind kind = Kind::linear;
    double gamma = 2.2;  // [1] for Kind::gamma: encoded = linear^(1/gamma); for Kind::curve, see below
    // Kind::curve, the smooth curve of cameras with a tone of their own: linear = e^(gamma + bend e + bow
    // e^2), e = encoded, 0 at 0 and 1 at 1 (Ng, Chang, Tsui 2007: generalised gamma). Beyond 1 it goes on as
    // the power that it has there. Must increase: is_increasing().
    double bend = 0, bow = 0;

    float encode(float linear) const;  // negative values encode as 0
    float decode(float encoded) const;
    Rgb encode(const Rgb& linear) const;
    Rgb decode(const Rgb& encoded) const;
    std::string name() const;    // "linear", "srgb", "gamma 2.2", "curve 2.2 -0.5 0.1" (gamma, bend, bow)
    bool is_increasing() const;  // and so has an inverse
    // Of Kind::curve, d ln(linear) / d ln(encoded) at `encoded`, 0..1: its gamma there.
    double log_slope(double encoded) const;

    friend bool operator==(const Transfer&, const Transfer&) = default;
};

// Reads "linear", "srgb", "2.2", "gamma 2.2", "curve 2.2 -0.5 0.1"; nothing for anything else, for gamma
// outside [0.2, 5], or for a curve that does not increase.
std::optional<Transfer> transfer_named(std::string_view name);

// CIE 1976 L*a*b*, D65, 2 degrees.
struct Lab {
    double l = 0, a = 0, b = 0;
};

Lab lab_from_linear(const glm::dvec3& linear);

// CIEDE2000 with kL = kC = kH = 1 (Sharma, Wu, Dalal 2005, eq. 2 to 22).
double delta_e_2000(const Lab& first, const Lab& second);

// Its three parts, turned so that the difference is their length: they change smoothly where the colours are
// the same, which the length does not, and so are what least squares takes. The first is lightness alone:
// without it, the difference is the one in colour only, which tolerances of neutral patches limit.
glm::dvec3 delta_e_2000_parts(const Lab& first, const Lab& second);

// Linear Rec. 709 of a surface whose L*a*b* is for D50, 2 degrees, as colour charts are published: adapted to
// D65 by Bradford's matrix (Lam 1985, as in ICC.1:2010, annex E). Not clipped.
Rgb linear_from_lab_d50(const Lab& lab);

// Relative luminance Y of linear Rec. 709 (IEC 61966-2-1).
inline float luminance(const Rgb& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }

}  // namespace tangi
