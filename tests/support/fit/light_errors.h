// light_errors.h: how far strengths of lights are from the truth.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "fit/calibration/light_calibration.h"
#include "surface/base/median.h"

namespace tangi {

// [1] Relative, light by light, once the strength that all have in common is taken off.
inline std::vector<double> errors_of_gains(const LightCalibration& found, const Photography& truth) {
    std::vector<double> errors;
    for (const Light& light : found.lighting.lights)
        for (const Photography::Photo& photo : truth.photos)
            if (photo.light.name == light.name) errors.push_back(light.gain.g / photo.light.gain.g);
    EXPECT_EQ(errors.size(), found.lighting.lights.size());
    const double scale = median(errors);
    for (double& error : errors) error = std::abs(error / scale - 1);
    return errors;
}

}  // namespace tangi
