// fit_lights.h: what a fit makes of a stack's lights before they are calibrated, and what becomes of them in
// the painting: noise, colours, strengths.
#pragma once

#include "capture/radiometry/white_balances.h"
#include "fit/calibration/light_calibration.h"
#include "fit/light_checks/light_outliers.h"
#include "fit/pipeline/fit_painting.h"

namespace tangi {

// Of pixels. `options` with the white level that is known by then.
NoiseModel noise_model(const Stack& stack, const Transfer& transfer, const FitOptions& options);

// Lights are told by what they hardly light, too. With the noise that is taken for the pixels' sake, shadows
// of a weak light pass for its light: of 24 lights of strengths 0.3 to 2, low ones were off by up to 12 %,
// with this by 2 %. The noise of a sensor cannot be measured where paintings are textured to the pixel.
NoiseModel noise_for_lights(const Stack& stack, const Transfer& transfer, const FitOptions& options);

// The lights of stack.photos as they are listed.
Lighting listed_lighting(const Stack& stack, double white_level);

// Finds the colour of each photograph's light beside the others', and makes it that of its light: so the fit
// takes it off in linear light, each channel with its own noise and clipping, and photographs are predicted
// as they are. Adds warnings to the stack.
WhiteBalances balance_photographs(Stack& stack, const Survey& surveyed, const Transfer& transfer);

// By directions as listed, which is what may be wrong; strengths as found.
LightOutliers light_outliers_of(const Stack& stack, const LightCalibration& calibration,
                                const Survey& surveyed, const Transfer& transfer);

// Photographs of the stack with their lights, as found. Held-out photographs get the light that the others
// make likely.
void describe_lights(const Stack& stack, const LightCalibration& calibration, Photography& photography);

}  // namespace tangi
