// anisotropy_estimate.h: what photographs say of how a pixel's lobe is anisotropic
// (surface/reflectance/anisotropy.h).
//
// Brushed or burnished metal, and varnish along a canvas' threads, reflect further across the grooves than
// along them. Few lights show the lobe of one pixel, so its stretch is found with everything else of the
// pixel free, and pooled over neighbours of the same look, each with its whole covariance.
#pragma once

#include <algorithm>
#include <glm/mat2x2.hpp>

#include "capture/stack/pixel_samples.h"
#include "fit/pixel/ward_fit.h"
#include "surface/maps/surface.h"
#include "surface/reflectance/anisotropy.h"

namespace tangi {

// A stretch, and the inverse of its covariance, 0 where no light shows the lobe.
struct StretchEvidence {
    glm::dvec2 stretch{0};
    glm::dmat2 information{0};
};

// Of samples whose estimate had a white lobe that is not anisotropic. Least squares
// of ward_residual.h over all parameters and the stretch, from the best of a few directions and from none.
StretchEvidence stretch_evidence(const PixelSamples& samples, const WardEstimate& estimate,
                                 const WardFitOptions& options);

// [1] What evidence comes to: drawn to 0, and 0 unless it clearly is not; s at most kMostStretch.
Stretch stretch_of(const StretchEvidence& evidence);

// Places on a line of pixels that are equally far apart, and the same ones from either end: a picture that is
// turned or mirrored is asked the same pixels.
struct EvenPlaces {
    int first = 0, apart = 1, count = 1;

    int at(int i) const { return first + i * apart; }
    // Of the place that is next to x.
    int nearest(int x) const { return std::clamp((x - first + apart / 2) / apart, 0, count - 1); }
    bool has(int x) const { return x >= first && x <= at(count - 1) && (x - first) % apart == 0; }
};

// Which pixels of a picture are asked how their lobes are anisotropic: about this many at most, however large
// it is.
constexpr double kAsked = 30000;
struct SampledPixels {
    EvenPlaces x, y;            // in columns and rows of these
    EvenPlaces look_x, look_y;  // these, and pixels between them, say how pixels look
};
SampledPixels sampled_pixels(int width, int height);

// Stretches of all pixels from evidence of those that are asked: each with the neighbours that look like it
// and are anisotropic as those next to it, so that what is brushed one way and what is brushed another keep
// the line between them. Of the surface diffuse, specular and confidence are read, of pixels that say how
// pixels look; those between look as the nearest. The same bits on any number of threads.
Image<Stretch> lobe_stretches(const Surface& surface, const Image<StretchEvidence>& evidence);

}  // namespace tangi
