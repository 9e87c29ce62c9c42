// damage_truth.h: paintings whose damage is known, and how well areas that were found agree with it.
#pragma once

#include "datasets/procedural_painting.h"
#include "retouch/mask/mask.h"

namespace tangi {

inline PaintingTruth square_painting(int side_px, double mm_per_pixel) {
    PaintingOptions options;
    options.seed = 5;
    options.width = options.height = side_px;
    options.mm_per_pixel = mm_per_pixel;
    return procedural_painting(options);
}

inline Mask mask_of(const Image<unsigned char>& truth) {
    Mask mask(truth.width(), truth.height());
    for (std::size_t i = 0; i < truth.size(); ++i) mask.pixels()[i] = truth.pixels()[i] ? 1.0f : 0.0f;
    return mask;
}

inline double sum(const Mask& mask) { return area_of(mask, 1).mm2; }

inline double intersection_over_union(const Mask& a, const Mask& b) {
    return sum(intersected(a, b)) / sum(united(a, b));
}

// Harmonic mean of how much of each lies within `tolerance_px` of the other.
inline double f1(const Mask& found, const Mask& truth, double tolerance_px) {
    const double precision = sum(intersected(found, dilated(truth, tolerance_px))) / sum(found);
    const double recall = sum(intersected(truth, dilated(found, tolerance_px))) / sum(truth);
    return 2 * precision * recall / (precision + recall);
}

}  // namespace tangi
