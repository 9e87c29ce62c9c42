// lobe_stretch.h: what photographs say of how a pixel's lobe is drawn out (surface/anisotropy.h).
//
// Brushed or burnished metal, and varnish along a canvas' threads, reflect further across the grooves than
// along them. Few lights show the lobe of one pixel, so its stretch is found with everything else of the
// pixel free, and pooled over neighbours of the same look, each with its whole covariance.
#pragma once

#include <algorithm>
#include <glm/mat2x2.hpp>

#include "capture/pixel_samples.h"
#include "fit/ward_fit.h"
#include "surface/anisotropy.h"

namespace tangi {

// A stretch, and the inverse of its covariance, 0 where no light shows the lobe.
struct StretchEvidence {
    glm::dvec2 stretch{0};
    glm::dmat2 information{0};
};

// Of samples whose estimate had a white lobe that is not drawn out. Least squares
// of ward_residual.h over all parameters and the stretch, from the best of a few directions and from none.
StretchEvidence stretch_evidence(const PixelSamples& samples, const WardEstimate& estimate,
                                 const WardFitOptions& options);

// [1] What evidence comes to: drawn to 0, and 0 unless it clearly is not; s at most kMostStretch.
Stretch stretch_of(const StretchEvidence& evidence);

// Where a picture's pixels are asked: every `step` pixels in both directions, so that it is kAsked of them at
// most, however large the picture is, and hardly less than a quarter of that: their rows are such of
// look_step().
constexpr double kAsked = 30000;
int stretch_step(int width, int height);

// Rows from one to the next of those that say how pixels look: what pixels are asked is on some of them. Row
// nearest to y.
int look_step(int stretch_step);
inline int look_row(int y, int look_step, int height) {
    return std::min((y + look_step / 2) / look_step, (height - 1) / look_step) * look_step;
}

// Stretches of all pixels from evidence of those whose x and y are multiples of the step (at x / step, y /
// step): each with the neighbours that look like it. Of the surface diffuse, specular and confidence are
// read, of rows that are multiples of look_step(); pixels between have the look of the nearest. The same bits
// on any number of threads.
Image<Stretch> lobe_stretches(const Surface& surface, const Image<StretchEvidence>& evidence, int step);

}  // namespace tangi
