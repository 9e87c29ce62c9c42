// matt_sample.h: a sample of pixels as matt reflection explains it, under lights of any strength.
#pragma once

#include <optional>
#include <vector>

#include "capture/radiometry/photometric_stereo.h"
#include "capture/stack/survey.h"

namespace tangi {

// What matt reflection makes of a sample of a survey's pixels, each by itself (photometric stereo, Woodham
// 1980), and of each photograph's light: its strength, and a plane of ln illumination over the picture, as
// near lights make it. Below 15 degrees nothing is compared: shadows and interreflection rule there.
struct MattSample {
    std::vector<int> index;  // of the survey's samples
    std::vector<PixelSamples> pixels;
    std::vector<LambertEstimate> estimates;
    std::vector<double> log_strengths;  // of each photograph's light, at the picture's centre
    // [1] By photograph, then by sample: how far it is from that, in the stored encoding; NaN where the
    // sample would be in shadow, is clipped, or nothing is known of it.
    std::vector<std::vector<float>> deviations;

    std::vector<std::vector<double>> factors;  // likewise: how much light the light gives there

    // [1] Median of all deviations; `without` one in so many photographs, from this one on, where given.
    struct Left {
        std::size_t first, step;
    };
    double residual(const std::optional<Left>& without = {}) const;
    // [1] By sample: mean of its deviations, each no more than `most`; NaN where it has none.
    std::vector<double> mean_deviations(double most) const;
};

// A survey, how its samples become linear light, and the picture that it is of.
struct LinearSurvey {
    const Survey& survey;
    const Transfer& transfer;
    int width = 0, height = 0;  // [pixels]
};

// `lights` are in the order of the survey's photographs. Takes about `wanted` samples. In the first round
// surfaces are found as if all lights were equally strong, in each further one with the illumination that the
// one before found. Deterministic for any number of threads.
MattSample matt_sample(const std::vector<Light>& lights, const LinearSurvey& linear, int wanted,
                       int rounds = 1);

// One more round.
void refine(MattSample& sample, const LinearSurvey& linear);

}  // namespace tangi
