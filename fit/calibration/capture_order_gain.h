// capture_order_gain.h: the strength of a hand-held light in a photograph that was held out, from the
// photographs taken just before and after it.
//
// A light that is carried around drifts in distance: photographs in a row, which file names put in order,
// share it, more than photographs lit from as far apart do.
#pragma once

#include <span>

#include "surface/maps/light_model.h"

namespace tangi {

// How much of what the lights' trend leaves over a photograph shares with others.
struct ShotOrder {
    double reach = 0;     // [photographs] over which leftovers are alike (Gaussian); 0: order says nothing
    double distance = 1;  // [1] of directions, likewise
    double shrink = 1;    // [1] as LightModel::shrink
};

// `photographed` in the order of their names, with the light model fitted to them. Used only where leaving
// out each photograph in turn shows that it predicts gains better than the model alone.
ShotOrder fit_shot_order(const LightModel& model, std::span<const Light> photographed);

// [1] Gain of a light in this direction, in a photograph between photographed[before - 1] and
// photographed[before].
double predicted_gain(const ShotOrder& order, const LightModel& model, std::span<const Light> photographed,
                      const Vec3& direction, int before);

}  // namespace tangi
