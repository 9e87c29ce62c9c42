// ward_kernel.h: the two vector routines behind WardBatchFitter.
#pragma once

#include "fit/pixel/ward_batch.h"

namespace tangi {

// Photometric stereo, sigmas with the model's error, and the best of five widths of the lobe for all lanes of
// a batch: fills all of `slots` that the iteration needs.
void start_ward_batch(const WardBatch& batch, const WardFitOptions& options, WardScratch& scratch,
                      WardSlots& slots);

// Levenberg-Marquardt steps on all lanes that are alive until fewer than `fewest` still are, or each has had
// its max_iterations; then variances of all lanes.
void run_ward_slots(WardSlots& slots, const WardFitOptions& options, int fewest);

}  // namespace tangi
