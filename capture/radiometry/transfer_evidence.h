// transfer_evidence.h: what photographs say for and against each transfer curve that they may have been
// stored with, and how much of it.
//
// Of photographs under lights of any strength, the shading of a pixel tells a curve to second order only: to
// first order a gamma makes slopes of another size, and albedos and strengths are as free. In one ring of
// lights, what the second order shows is gloss and interreflection as much as the curve. Lights at several
// heights tell more: read with a wrong curve, equally strong ones seem the stronger the higher they stand,
// and scatter about that. So both are weighed, each by what it is known to be wrong by, with what is likely
// of files beforehand (Bayes).
#pragma once

#include <vector>

#include "capture/radiometry/matt_sample.h"
#include "capture/stack/stack.h"

namespace tangi {

struct TransferTrial {
    Transfer transfer;
    // [1] Robust residual of matt reflection in the stored encoding, under lights of any strength; and if
    // surfaces are found as if lights were equally strong.
    double residual = 0, equal_residual = 0;
    std::vector<double> partial{};  // of it, with some photographs left out in turn
    double strength_scatter = 0;    // [1] robust, of ln strength of the lights, as stored (over the gamma)
    double strength_trend = 0;      // [1] d ln strength / d ln l.z
    std::vector<Vec3> normals{};    // of the samples; 0 where unknown
    double log_evidence = 0;        // ln of how likely the photographs are, but for a constant of all trials
    double probability = 0;         // with what is likely beforehand; 1 is the sum of all
    double slopes_change_deg = 0;   // median angle between its normals and those of the curve taken
};

TransferTrial try_transfer(const Stack& stack, const Survey& survey, const Transfer& transfer);

// Weighs trials of one survey against each other: evidence and probability. What is likely beforehand: of
// files of 16 bits linear light, of 8 bits sRGB; other gammas in few.
void weigh(std::vector<TransferTrial>& trials, const Stack& stack);

// [deg] Median angle between the normals that two curves make of the same samples.
double slopes_change_deg(const TransferTrial& a, const TransferTrial& b);

}  // namespace tangi
