// fit_passes.h: every pixel of a stack, fitted in passes over the photographs.
#pragma once

#include <functional>

#include "capture/stack/reduced_photos.h"
#include "fit/pipeline/fit_painting.h"
#include "fit/pipeline/refinement.h"
#include "fit/shadows/light_visibility.h"

namespace tangi {

// Looks at the surface as the first pass left it, and once more when it has a first height, without cliffs;
// adds to its report. It is `reduction` times smaller than what is fitted.
using FirstLook = std::function<void(FitResult& first, int reduction, bool height_known)>;

// What lobes of single pixels may be beside white and isotropic.
struct LobeFreedom {
    bool coloured = false, anisotropic = false;
};

// Fills in the maps of `result` but for the final height, and what its report says of pixels. The first pass
// takes lobes for white and knows no shadows; where lobes may have colours, it shows these, and where they
// may be anisotropic, some rows that are fitted before it show how; to refine, all pixels are fitted once
// more, with what neighbours say about lobe and slope and with the shadows of a first height. Of a large
// stack the `reduced` photographs, where they are not empty, stand in for all in what comes before this last
// pass, unless relief hides lights; of a preview in that, too. result.surface has size, scale and law,
// result.errors the size. Throws as fit_painting(). Returns which lights were seen
// where; none where it is not refined.
LightVisibility fit_passes(const CalibratedStack& input, ReducedPhotos reduced, const FitOptions& options,
                           const LobeFreedom& lobes, const FirstLook& look, FitResult& result,
                           const Progress& progress);

// The first pass of fit_passes() over the reduced photographs of a large stack, with a second one by which
// its lobes and shadows are known.
struct ReducedLook {
    FirstFit first;
    bool believed = false;  // hills and valleys are what they are, as far as the photographs tell
    double hidden = 0;      // [1] part of all pixels' lights that relief hides
    // Whether it tells what a first pass over the photographs themselves would: not where relief hides
    // lights, for each pixel others.
    bool suffices() const;
};
// `described`: has scale and law of the whole surface, whose maps are not looked at.
ReducedLook look_at_reduced(const CalibratedStack& whole, const ReducedPhotos& reduced,
                            const FitOptions& options, const LobeFreedom& lobes, const FirstLook& look,
                            const FitResult& described, const Progress& progress);

// Whether the residuals of the last pass are small enough to believe what it says of errors.
bool explains_photographs(const FitReport& report);

// By how much photographs differ from the model, in words: "6 % more than is expected (in the median)", "2.3
// times what is expected (in the median)". `median_sigma` [sigma] is over 1.
std::string beyond_expected(double median_sigma);

}  // namespace tangi
