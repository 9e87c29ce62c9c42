// light_model.h: the strength and colour of a light, the shape of its beam, and how far it is from where it
// is listed, as smooth functions of its direction, to predict lights that no photograph had from those that
// were photographed.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "surface/maps/gaussian_process.h"
#include "surface/maps/light.h"

namespace tangi {

struct LightModel {
    GaussianProcess log_gain;
    // [1] ln of red and of blue against green; none where all lights are grey.
    std::optional<std::array<GaussianProcess, 2>> log_colours{};

    friend bool operator==(const LightModel&, const LightModel&) = default;
};

// No lights: gain 1 everywhere.
LightModel fit_light_model(std::span<const Light> photographed);

// [1] Gain of a light in this direction; `photographed` as given to fit_light_model().
double predicted_gain(const LightModel& model, std::span<const Light> photographed, const Vec3& direction);

// [1] Red and blue of such a light against its green.
Rgb predicted_colour(const LightModel& model, std::span<const Light> photographed, const Vec3& direction);

// Each term of the beams likewise, in units of what it makes of ln irradiance `radius_mm` from the origin.
struct BeamModel {
    double radius_mm = 1;
    std::array<GaussianProcess, 5> terms{};

    friend bool operator==(const BeamModel&, const BeamModel&) = default;
};

// `radius_mm` > 0: half of the picture's longer side.
BeamModel fit_beam_model(std::span<const Light> photographed, double radius_mm);

Beam predicted_beam(const BeamModel& model, std::span<const Light> photographed, const Vec3& direction);

// How far lights are from where a lights file lists them (light_direction.h), as a function of the direction
// that is listed.
struct DirectionModel {
    std::array<GaussianProcess, 2> turn{};

    friend bool operator==(const DirectionModel&, const DirectionModel&) = default;
};

// `listed`: [unit vectors] of the photographed lights.
DirectionModel fit_direction_model(std::span<const Vec3> listed, std::span<const Light> photographed);

// Where a light is that is listed in this direction; `listed` as given to fit_direction_model().
Vec3 predicted_direction(const DirectionModel& model, std::span<const Vec3> listed, const Vec3& direction);

}  // namespace tangi
