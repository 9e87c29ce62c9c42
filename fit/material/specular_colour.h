// specular_colour.h: what photographs say of the colour of a pixel's lobe, and how a coloured lobe is fitted.
//
// A dielectric reflects all wavelengths alike at its surface, a metal has its colour from there (Cook &
// Torrance 1982, "A reflectance model for computer graphics", sec. 4). With slope and alpha held as a white
// lobe was fitted, the model of ward_residual.h is linear in rho_d and rho_s of each channel, so that rho_s,c
// and its variance follow in closed form (robust: iteratively reweighted). Neighbours of one look share the
// material, and so the colour; what is within noise of white is white.
//
// A lobe of a known colour needs no solver of its own: in
//   E_c (rho_d,c (D + k) + rho_s colour_c Lambda) = E_c colour_c (rho_d,c / colour_c (D + k) + rho_s Lambda)
// the photographs are those of a white lobe and another rho_d under lights of another colour.
#pragma once

#include "capture/stack/pixel_samples.h"
#include "fit/pixel/ward_fit.h"
#include "surface/maps/surface.h"

namespace tangi {

// rho_s of each channel, divided by their mean, and how much that weighs: 1 / variance, 0 where no light
// shows the lobe, or it is so wide that it may be diffuse light.
struct LobeEvidence {
    Rgb colour{1};
    float weight = 0;
    float matt_hue = 0;  // |rho_d - its mean| / mean rho_s: how saturated the matt part is, against the lobe
};

// Of samples in three channels, whose estimate had a white lobe or the one that it says.
LobeEvidence lobe_evidence(const PixelSamples& samples, const WardEstimate& estimate,
                           const WardFitOptions& options);

// [1] What evidence comes to, as Surface::specular_colour: the largest channel 1; white unless it clearly is
// not, and beyond what the matt part explains.
Rgb specular_colour_of(const LobeEvidence& evidence);

// The same of all pixels, each with the neighbours that look like it (as kLobeReach of
// lobe_neighbour_prior.h). Of the surface diffuse and specular are read. The same bits on any number of
// threads.
Image<Rgb> specular_colours(const Surface& surface, const Image<LobeEvidence>& evidence);

// [1] Part of the strongest channel that filters, chroma of compressed pictures and the clipping of colours
// out of gamut let into the others: of no account in paint, but a saturated highlight is told by channels
// that are nearly 0.
constexpr double kCrosstalk = 0.02;

// Changes the lights' colours, so that a lobe of this colour is a white one, and allows for crosstalk where
// it lacks something; no channel of it may be 0.
void divide_by_specular_colour(const Rgb& specular_colour, PixelSamples& samples);

// [1] What divide_by_specular_colour() adds to the standard deviation of each channel for a strongest value
// of 1.
inline Rgb crosstalk_of(const Rgb& specular_colour) {
    return static_cast<float>(kCrosstalk) * (Rgb(1) - specular_colour);
}

// The estimate of samples that were changed so, as of what they were.
WardEstimate coloured(WardEstimate divided_by_specular_colour, const Rgb& specular_colour);

}  // namespace tangi
