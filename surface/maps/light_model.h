// light_model.h: the strength of a light, and the shape of its beam, as smooth functions of its direction, to
// predict lights that no photograph had from those that were photographed.
#pragma once

#include <array>
#include <span>

#include "surface/maps/light.h"

namespace tangi {

// ln gain, or a term of the beam, = trend(x, y) + what is left over in photographs lit from nearby, averaged.
struct LightModel {
    std::array<double, 6> trend{};  // of 1, x, y, x^2, x y, y^2 of the direction
    double reach = 0.2;             // [1] distance of directions over which leftovers are alike (Gaussian)
    double shrink = 1;              // [1] > 0: how many photographs' worth of leftover 0 is averaged in

    friend bool operator==(const LightModel&, const LightModel&) = default;
};

// The trend robustly, by least squares reweighted with Cauchy's function, slightly pulled to a constant;
// reach, shrink and whether there is a trend at all such that each light is predicted best from all others
// (leave-one-out); the mean of all where that is not better for sure. No lights: gain 1 everywhere.
LightModel fit_light_model(std::span<const Light> photographed);

// [1] Gain of a light in this direction; `photographed` as given to fit_light_model().
double predicted_gain(const LightModel& model, std::span<const Light> photographed, const Vec3& direction);

// [1] Red and blue of such a light against its green, likewise, by models of their own.
Rgb predicted_colour(std::span<const Light> photographed, const Vec3& direction);

// Each term of the beams likewise, in units of what it makes of ln irradiance `radius_mm` from the origin.
struct BeamModel {
    double radius_mm = 1;
    std::array<LightModel, 5> terms{};

    friend bool operator==(const BeamModel&, const BeamModel&) = default;
};

// `radius_mm` > 0: half of the picture's longer side.
BeamModel fit_beam_model(std::span<const Light> photographed, double radius_mm);

Beam predicted_beam(const BeamModel& model, std::span<const Light> photographed, const Vec3& direction);

}  // namespace tangi
