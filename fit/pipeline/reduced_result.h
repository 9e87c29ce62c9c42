// reduced_result.h: the result of a fit of reduced photographs, and what a fit of whole ones starts with.
#pragma once

#include "capture/stack/reduced_photos.h"
#include "fit/pipeline/fit_painting.h"

namespace tangi {

// Empty maps for the reduced photographs, with all else that `result` has.
FitResult reduced_result(const FitResult& result, const ReducedPhotos& photos);

// Makes ρd, and the colours and axes of lobes of a surface, which may be a part of a painting
// (Surface::part_of), those of `first`, enlarged. Confidence stays 0.
void start_with(const Surface& first, int reduction, Surface& surface);

// Pixels of a result that was started so, but were not fitted then, become like those of an empty surface.
void forget_unfitted(Surface& surface);

}  // namespace tangi
