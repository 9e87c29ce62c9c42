// sharpening.h: whether photographs were sharpened (unsharp mask, as cameras and raw converters do unasked),
// by the spectrum of their noise.
//
// Noise of a sensor is as strong at all frequencies; demosaicing, denoising and resampling only take from the
// high ones, and a lens has no part in it. What lifts waves of 3 pixels above waves of 8 is sharpening, and
// it lifts the relief by as much. Noise is what the photographs of a small block do not have in common: under
// any light they are mixtures of few pictures, so the weaker half of their principal components (of those
// that are neither dark nor clipped) is noise where the block is quiet, and the quietest blocks are looked
// at. Weakest components are those that lack some of the noise's long waves, more so the fewer pixels and the
// more photographs there are, so it is compared with what white noise looks like there: the strong components
// of each block with noise that is made (a parametric bootstrap: Efron 1979, "Bootstrap methods: another look
// at the jackknife").
//
// JPEG throws noise away, and its own errors rise with the frequency: where its grid of 8 pixels shows in
// what is left, or its steps are not finer than the noise, nothing is said.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "capture/registration/registration.h"

namespace tangi {

struct Sharpening {
    // [1] Power of the noise at 0.27 to 0.45 cycles a pixel over that at 0.08 to 0.2, as a part of what that
    // is of white noise: 1 of noise that is, less of a soft picture. Not known where there are no blocks, or
    // the noise is not the sensor's.
    double ratio = 0, error = 0;
    int blocks = 0;
    bool compressed = false;  // the noise is that of a JPEG

    bool suspected() const;  // by three standard errors
    bool found() const;      // by four
};

// `collected` has photographs as stored, which are not resampled. `rounding` [1]: as rounding_of_jpeg().
// Deterministic for any number of threads.
Sharpening find_sharpening(const PictureCollector& collected, double rounding = 0);

// What is to be done about it, for people; empty where it is not even suspected.
std::string says_sharpened(const Sharpening& sharpening);

nlohmann::json to_json(const Sharpening& sharpening);

}  // namespace tangi
