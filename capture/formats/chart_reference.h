// chart_reference.h: what the 24 patches of the classic colour chart should look like.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "surface/image/colour.h"

namespace tangi {

// Patches in the order of their numbers: four rows of six from the top left of the upright chart; the last
// row are the greys from white to black.
constexpr int kChartColumns = 6, kChartRows = 4, kChartPatches = kChartColumns * kChartRows;
constexpr int kFirstNeutral = 18;

struct ChartReference {
    struct Patch {
        std::string name;
        Rgb linear{0};  // Rec. 709, reflectance: 1 is a perfect white
    };
    std::array<Patch, kChartPatches> patches;
    std::string source;  // for reports
};

// The maker's values for charts made before November 2014 (L*a*b*, D50, 2 degrees; GretagMacbeth 2005).
ChartReference classic_chart();

// Values that were measured on a chart, or published for another edition:
//   .csv   a line `name,L,a,b` (D50) or `name,R,G,B` (linear Rec. 709), then 24 lines in the order of the
//   numbers .json  a list of 24 objects with `name` and either `linear_srgb` or `lab_d50` (three numbers
//   each), in
//          the order of the numbers or each with its number `n`
// Throws Error naming the file and the line or patch.
ChartReference read_chart_reference(const std::filesystem::path& path);

}  // namespace tangi
