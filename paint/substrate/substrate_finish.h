// substrate_finish.h: how the whole of a support looks otherwise than it would: its colour, gloss and
// roughness.
#pragma once

#include <optional>

#include "surface/maps/surface.h"

namespace tangi {

// How the whole of a substrate looks otherwise than it would (thesis, figures 4.25 to 4.27).
struct SubstrateFinish {
    Rgb tint{1};                        // [1] that rho_d is multiplied by, 0..1
    std::optional<double> specular{};   // [1] mean of rho_s, 0..1
    std::optional<double> roughness{};  // [1] mean of alpha, above 0, up to 1

    friend bool operator==(const SubstrateFinish&, const SubstrateFinish&) = default;
};

// What varies from pixel to pixel stays in the same proportion, within the range of the map, where the mean
// allows for that; pixels that were not measured stay as they are, and do not count. Throws Error where a
// number is out of range.
void apply(const SubstrateFinish& finish, Surface& surface);

}  // namespace tangi
