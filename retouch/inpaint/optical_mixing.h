// optical_mixing.h: pure colours side by side that mix in the eye: which, and how much area of each.
#pragma once

#include <span>
#include <vector>

#include "paint/optics/spectrum.h"

namespace tangi {

struct Juxtaposition {
    std::vector<int> looks;      // which of those that were offered, at most four
    std::vector<double> shares;  // of the area, sum 1
    double delta_e = 0;          // CIEDE2000 of their mean from the target: the worst under the illuminants
};

// The few of `looks` whose mean by area, which is what the eye sees from far enough (Talbot-Plateau), comes
// near to the target under all illuminants, and which differ little from it themselves, in lightness most of
// all: that is what keeps lines apart longest. `bare_share` of the area stays as `bare`. Throws ContractError
// without looks or illuminants, or for a share outside of [0, 1).
Juxtaposition juxtapose(std::span<const Spectrum> looks, const Spectrum& target,
                        std::span<const Illuminant> illuminants, const Spectrum& bare, double bare_share);

}  // namespace tangi
