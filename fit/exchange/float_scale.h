// float_scale.h: photographs of floats whose unit is not that of a camera's full scale.
#pragma once

#include <optional>

#include "capture/stack/stack.h"
#include "capture/stack/survey.h"

namespace tangi {

// [1] Linear values of photographs: 98 % are below `kDarkFloats` where few of the codes of integers are used,
// and floats have another unit; above `kBrightFloats` paint would reflect twice the light that falls on it.
constexpr double kDarkFloats = 0.08, kBrightFloats = 2;

// The white level of photographs of floats (EXR, TIFF) that are in another unit than 1 = full scale:
// radiance, counts. Nothing says how much of the light their brightest paint reflects, so it is taken for a
// light one. Empty where 98 % of the values are below something from kDarkFloats to kBrightFloats, and for
// files of integers.
std::optional<double> white_level_of_unit(const Stack& stack, const Survey& survey);

}  // namespace tangi
