// colour_saturation.h: photographs whose colours were made stronger, weaker or grey beside those of the
// others.
//
// Of matt paint ln(red / green) and ln(blue / green) are a number of the pixel plus one of the photograph
// (white_balances.h). Programs that change saturation multiply the pixel's number, and those that make a
// picture grey take it away; gloss adds white light, which changes it the more, the darker a pixel is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "capture/radiometry/white_balances.h"

namespace tangi {

struct ColourSaturation {
    double scale = 1;  // [1] of the pixels' ln ratios, beside the other photographs; 0: grey
    double sigma = 0;  // standard error; 0: nothing is known
    bool differs = false;
};

// Of each photograph; empty where they cannot be told: too few photographs, samples or colours.
std::vector<ColourSaturation> colour_saturations(const ColourSamples& samples);

// What the user is to know; empty where nothing differs. `names`: of the photographs.
std::string warning_of(std::span<const ColourSaturation> photos, std::span<const std::string> names,
                       const std::string& where);

}  // namespace tangi
