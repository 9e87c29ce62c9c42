// light_model_selection.h: one way to explain a stack's photographs by its lights, solved with all of them,
// and how it predicts those that are left out: what light calibration chooses by.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "fit/calibration/light_calibration.h"
#include "fit/calibration/light_sample.h"

namespace tangi {

// Each model is tried with some photographs left out at a time.
struct LeftOutPhotos {
    int trials;
    int step;  // in each trial every photograph of so many

    bool has(int photo, int trial) const { return photo % step == step / trials * trial; }
};

// A model, solved with all photographs, and how it predicts those left out.
struct TriedModel {
    std::optional<LightBundleAdjustment>
        solution;  // none where there is nothing to solve, or nothing was found
    LightCalibration::Trial trial;
};

// All photographs of a stack, for which lights are given. `from`: a solution with even beams to start from,
// where there is one. `step_done` is called 1 + out.trials times a model, from any thread.
std::vector<TriedModel> tried(const LightSample& sample, const Lighting& given,
                              const std::vector<LightingModel>& models, const LeftOutPhotos& out,
                              const std::function<void()>& step_done,
                              const std::optional<LightBundleAdjustment>& from = {});

// The lighting that a solved joint problem means, with standard errors.
LightCalibration calibrated(const LightSample& sample, const LightBundleAdjustment& solution,
                            const Lighting& given, const LightingModel& model);

// A solution, solved again with the pixels of a finer sample: what was chosen by few pixels is the better
// known by more. The solution itself where that fails.
LightBundleAdjustment solved_finer(const LightSample& fine, const LightBundleAdjustment& solution,
                                   const Lighting& given, const LightingModel& model);

}  // namespace tangi
