#include "capture/photo/exposure_merge.h"

#include <cmath>
#include <limits>

#include "surface/base/error.h"
#include "surface/base/median.h"

namespace tangi {

namespace {

// [1] Of full scale: below, offsets that no dark frame took off would tell.
constexpr float kDarkestExposed = 0.02f;
constexpr std::size_t kFewestExposed = 50;  // fewer well exposed ones tell nothing

}  // namespace

float merge_exposures(std::span<const float> linear, std::span<const float> relative,
                      const SensorNoise& noise) {
    TP_REQUIRE(linear.size() == relative.size(), "one exposure a value");
    double longest = 0, first = 0;
    for (std::size_t k = 0; k < linear.size(); ++k)
        if (!std::isnan(linear[k]) && static_cast<double>(relative[k]) > longest) {
            longest = static_cast<double>(relative[k]);
            first = static_cast<double>(linear[k]) / longest;
        }
    if (!(longest > 0)) return std::numeric_limits<float>::quiet_NaN();
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < linear.size(); ++k) {
        if (std::isnan(linear[k])) continue;
        const double t = static_cast<double>(relative[k]);
        const double variance = noise.shot * std::max(first * t, 0.0) + noise.read * noise.read;
        const double weight = t * t / variance;
        sum += weight * (static_cast<double>(linear[k]) / t);
        weights += weight;
    }
    return static_cast<float>(sum / weights);
}

RefinedExposures refine_exposures(std::span<const double> settings, std::span<const ExposurePair> pairs) {
    const std::size_t count = settings.size();
    RefinedExposures result{{settings.begin(), settings.end()},
                            std::vector<double>(count, 0.0),
                            std::vector<bool>(count, count < 2)};
    double shift = 0;  // ln of what the settings were changed by, summed for their mean
    for (std::size_t k = 1; k < count; ++k) {
        std::vector<double> ratios;
        for (const ExposurePair& pair : pairs) {
            if (pair.longer != k || pair.shorter + 1 != k) continue;
            double longer = 0, shorter = 0;
            std::size_t used = 0;
            for (std::size_t i = 0; i < pair.longer_values.size(); ++i) {
                // Chosen by the longer exposure, whose noise is the smaller part of the ratio's.
                const float l = pair.longer_values[i], s = pair.shorter_values[i];
                if (std::isnan(l) || std::isnan(s) ||
                    l < kDarkestExposed * static_cast<float>(settings[k] / settings[k - 1]))
                    continue;
                longer += static_cast<double>(l);
                shorter += static_cast<double>(s);
                ++used;
            }
            if (used >= kFewestExposed && shorter > 0) ratios.push_back(longer / shorter);
        }
        if (ratios.empty()) {
            result.relative[k] = result.relative[k - 1] * settings[k] / settings[k - 1];
        } else {
            const double ratio = median(ratios);
            result.relative[k] = result.relative[k - 1] * ratio;
            result.refined[k] = true;
            std::vector<double> off;
            for (const double r : ratios) off.push_back(std::abs(r / ratio - 1));
            result.scatter[k] = 1.4826 * median(std::move(off));
        }
        shift += std::log(result.relative[k] / settings[k]);
    }
    for (double& relative : result.relative)
        relative /= std::exp(shift / static_cast<double>(std::max<std::size_t>(count, 1)));
    return result;
}

}  // namespace tangi
