// reflectance_support.h: what tests of reflectance share: directions, and Ward's lobes.
#pragma once

#include <array>
#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>

#include "surface/reflectance/ward.h"

namespace tangi {

inline constexpr double kPi = std::numbers::pi;
inline constexpr auto kModels = [] {
    std::array<WardModel, kWardModels.size()> models{};
    for (std::size_t i = 0; i < models.size(); ++i) models[i] = kWardModels[i].model;
    return models;
}();

// In the frame of the surface: `theta` [rad] from its normal, z, and `phi` [rad] about it from x.
inline glm::dvec3 direction(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

}  // namespace tangi
