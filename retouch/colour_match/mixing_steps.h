// mixing_steps.h: mixtures that one can measure out without a balance.
//
// A mixture of two paints is 1:1, 1:2, 1:3, 1:5, 1:8, 1:12 or 1:20, either way round, in measures of the same
// spoon. One of three or four goes on from there: each further paint meets the mixture so far in one of the
// same ratios. So a trace of a strong paint is let down first, and every step is as easy as the first.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "retouch/colour_match/film_match.h"

namespace tangi {

inline constexpr std::array<int, 7> kMeasures = {1, 2, 3, 5, 8, 12, 20};

// `so_far` measures of what has been mixed (0: nothing, the first paint), and `added` of a paint; one of them
// is 1.
struct MixingStep {
    int paint = 0;  // index in the box
    int so_far = 0, added = 1;
};

struct MeasuredMixture {
    Mixture mixture;
    std::vector<MixingStep> steps;
};

// The measurable mixtures of the paints of `ideal` that look nearest to it: by its volumes' logarithms and
// the curvature of the colour difference there. `keep` of them at most, nearest first.
std::vector<MeasuredMixture> measurable_near(const Mixture& ideal, const FilmMatch& match, std::size_t keep);

// Volumes that steps lead to.
Mixture mixture_of(const std::vector<MixingStep>& steps);

// "8 Titanium White + 1 Cobalt Blue; 20 of it + 1 Bone Black"
std::string text_of(const std::vector<MixingStep>& steps, const std::vector<Pigment>& paints);

}  // namespace tangi
