// exposure_merge.h: one linear value from photographs of the same light at several exposures.
#pragma once

#include <span>
#include <vector>

namespace tangi {

// Of a linear value x of one exposure, full scale = 1: variance = shot * x + read^2 (EMVA 1288, 2021, eq. 10
// ff.). The defaults are those of a full-frame camera at base ISO: a full well of 30000 electrons, 6 of read
// noise. Only their ratio matters here.
struct SensorNoise {
    double shot = 1.0 / 30000;
    double read = 6.0 / 30000;
};

// The mean of values / exposures weighted by their inverse variance, which is that of the photons expected
// and the read noise (Hasinoff, Durand, Freeman 2010, "Noise-optimal capture for high dynamic range
// photography", eq. 4; the variance is taken at one common estimate, that of the longest exposure: taken at
// each noisy value by itself it would favour the low ones). `linear`: NaN where clipped. `relative`:
// exposures, all > 0. NaN where all are clipped.
float merge_exposures(std::span<const float> linear, std::span<const float> relative,
                      const SensorNoise& noise = {});

// Two photographs of the same light as lists of the same pixels, linear, NaN where clipped.
struct ExposurePair {
    std::size_t longer = 0, shorter = 0;  // which of the settings
    std::vector<float> longer_values, shorter_values;
};

struct RefinedExposures {
    std::vector<double> relative;  // as given, times what the data say; their geometric mean is kept
    std::vector<double> scatter;   // [1] of the ratio to the next setting between lights; 0 for one light
    std::vector<bool> refined;     // false where no pixel is well exposed in both: as given
};

// Exposure settings (ascending, > 0) from photographs taken with neighbouring ones: the ratio of sums over
// pixels that are well exposed in both, the median over lights. Shutters and EXIF round: 1/60 s is 1/64 s.
RefinedExposures refine_exposures(std::span<const double> settings, std::span<const ExposurePair> pairs);

}  // namespace tangi
