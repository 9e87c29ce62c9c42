// occluded_pixels.h: pixels that few lights reach.
//
// Between ridges of paint most lights of a rig are hidden, and the few that are not say little: black paint
// with a narrow highlight explains them as well as paint in the shade does. By itself such a pixel passes for
// a black mirror, and is sure of it; relit, it is a white or a black dot. What decides is what lies around
// (Lensch et al. 2003, "Image-based reconstruction of spatial appearance and geometric detail", likewise
// takes what a pixel leaves open from the material that it is part of). So both are tried: the pixel as it
// is, and the pixel as part of what is around it with the dark photographs hidden.
#pragma once

#include <vector>

#include "capture/stack/pixel_samples.h"
#include "fit/pixel/fit_errors.h"
#include "fit/pixel/ward_fit.h"
#include "surface/maps/surface.h"

namespace tangi {

// 1 where a fit may be such a misreading: it is much darker than what is around it, and either its slope is
// not quite certain or its highlight is strong and narrow; or nothing is known of its slope at all.
Image<unsigned char> find_occluded_pixels(const Surface& surface);

// From now on these bear no witness to the height: next to no confidence. Returns what they had, row by row,
// for trust_again().
std::vector<float> distrust(const Image<unsigned char>& occluded, Surface& surface);
void trust_again(const Image<unsigned char>& occluded, const std::vector<float>& confidences,
                 Surface& surface);

// Gives them the reflectance of what is around, with errors so large that nobody is told by them. How their
// lobes are anisotropic stays.
void fill_from_neighbours(const Image<unsigned char>& occluded, Surface& surface, FitErrors& errors);

// The prior of such a pixel where it is taken for what it seems: its lobe need not be its neighbours'.
WardPrior of_its_own(WardPrior prior);

// Photographs that are much darker than the start predicts are hidden from the light, unless a lower light in
// the same direction is seen: what they say is taken to be off by as much as they miss. Returns what has to
// be added to the cost for those that the relief does not explain (`visible`): what being hidden and a wider
// normal distribution cost. Samples that are left out do not count.
double hide_dark(const WardStart& start, PixelSamples& samples);

}  // namespace tangi
