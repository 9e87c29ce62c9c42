// colour_line.h: the colour of the light in one photograph, from what its pixels say and how a veil of gloss
// bends that.
#pragma once

#include <cstddef>
#include <span>

#include "surface/image/image.h"

namespace tangi {

// One sample's say on a photograph in one channel (red or blue) against green.
struct ColourSay {
    double veil = 0;       // [1] d off / d of white light, in units of the usual pixel's green
    double off = 0;        // [1] ln ratio in the photograph beside the pixel's own
    double worth = 1;      // [1] weight: 1 / variance, up to a factor
    std::size_t part = 0;  // < kColourParts
};

// Quarters of the picture, and of each those that a veil changes least to most.
constexpr std::size_t kColourParts = 4, kColourStrata = 4, kColourGroups = kColourParts * kColourStrata;

struct ColourLine {
    double at_white = 0;      // [1] ln ratio of the light: what a pixel says that a veil doesn't change
    double sigma = 0;         // [1] its standard error; 0: nothing is known
    double uneven = 0;        // [1] standard deviation of it between the parts of the picture
    double uneven_sigma = 0;  // [1] how large that may be without any
};

// off = at_white + slope * veil, robustly (Tukey's weights). `veil_sigma` [1] > 0: how strong a veil may be.
// The error is by how much parts of the picture, and pixels that a veil changes more or less, disagree
// (jackknife, Quenouille 1956), and what a veil may do that the pixels, all of one colour, cannot tell from
// light of another colour. Says without a number are not allowed.
ColourLine colour_line(std::span<const ColourSay> says, double veil_sigma);

constexpr double kHalfCode = 0.5 / 255;  // [1] ln of light near full scale: rounding to 8 bits, curves
constexpr double kMostVeil = 0.5;        // [1] of the pixel's light: with more it is a highlight

// [1] > 0: The strongest veil that gloss makes of light from this direction for a camera straight above,
// however rough the surface is, as a part of the light from a middling pixel; at most kMostVeil.
double largest_veil(const Vec3& direction);

}  // namespace tangi
