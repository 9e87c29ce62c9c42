#include "fit/exchange/float_scale.h"

#include <cmath>

#include "fit/calibration/light_sample.h"

namespace tangi {

std::optional<double> white_level_of_unit(const Stack& stack, const Survey& survey) {
    // [1] Of white: 98 % of the values of generated paintings under 16 to 24 lights are below 0.5 to 0.65.
    constexpr double kBrightPaint = 0.6;
    const bool of_floats = stack.bits == 32 && (!stack.development || stack.development->bits == 32);
    const double bright = static_cast<double>(bright_stored(survey));
    if (!of_floats || !(bright > 0) || (bright >= kDarkFloats && bright <= kBrightFloats)) return {};
    const double white = bright / kBrightPaint;
    const double digits = std::pow(10, std::floor(std::log10(white)) - 1);  // two of them
    return std::round(white / digits) * digits;
}

}  // namespace tangi
