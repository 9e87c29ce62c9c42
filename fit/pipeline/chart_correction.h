// chart_correction.h: what a colour chart that was photographed with the painting does to a fit: colours
// become colorimetric, and reflectance absolute.
//
// The fit works in the photographs' channels, each divided by what the camera sees of their light, so
// that matt white and highlights are the same in all channels. rho_d then becomes M rho_d with the chart's
// matrix, and Photography::to_camera is the way back.
#pragma once

#include <optional>

#include "capture/stack/stack.h"
#include "fit/pixel/lighting.h"
#include "surface/maps/surface.h"

namespace tangi {

struct ColourReport {
    bool corrected = false;       // rho_d is colorimetric; false: in the photographs' own primaries
    double delta_e_2000 = -1;     // [1] to expect, by the chart in the photographs; negative: not known
    bool by_profile = false;      // corrected by the primaries of the photographs' ICC profile
    long clamped = 0;             // pixels with a channel that would be negative: colours outside Rec. 709
    int patches = 0;              // of the chart that are in the picture
    double patches_delta_e = 0;   // [1] mean CIEDE2000 of these, as fitted, against the chart's values
    bool white_by_chart = false;  // the white level is what the chart tells
};

// [1] The linear value of a matt white that faces a light of gain 1, by the chart's patches in all
// photographs and where their lights are: the median over both, so that shadows and highlights do not matter.
// The chart is taken to lie flat in the painting's plane; it need not be in the picture that is fitted, but
// in the photographs. `lighting` has the lights of stack.photos, whose gains are settled. Nothing without a
// chart, or where fewer than 9 patches can be read.
std::optional<double> white_level_by_chart(const Stack& stack, const Transfer& transfer,
                                           const Lighting& lighting, double mm_per_pixel);

// The lights as the camera sees them; as they are where there is no chart.
Lighting as_camera_sees(Lighting lighting, const Stack& stack);

// What a light is in linear Rec. 709 that gives the camera's channels these gains; the same where there is no
// chart.
Rgb light_of_gain(const Rgb& gain, const Stack& stack);

// Makes the surface's rho_d linear Rec. 709, clamped at 0, and stores the way back. Patches of the chart that
// are in the picture are compared with what they should be.
ColourReport correct_colours(const Stack& stack, Surface& surface);

}  // namespace tangi
