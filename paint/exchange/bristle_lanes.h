// bristle_lanes.h: what one bristle gives and takes more than another changes slowly along a stroke: paint
// that is thin lies in streaks, which begin and end.
#pragma once

#include <cstdint>
#include <vector>

namespace tangi {

// Random factors [1] of the transfer, about 1, across the brush's way: lane i begins first_px + i / kPerPixel
// to the right of its middle (edge_pressure.h). What lies beyond the last lanes counts to them.
struct BristleLanes {
    static constexpr float kPerPixel = 2, kEven = 1;
    const float* factor = &kEven;
    int count = 1;  // at least 1
    float first_px = 0;
};

// The lanes `way_px` pixels after the beginning of a stroke, as far as `half_px` to either side: streaks as
// wide as bristles (but two pixels) and eight times as long, from 1 - amount to 1 + amount (0.01 at least).
// They point into `memory`.
BristleLanes lanes_at(float way_px, float half_px, float bristle_px, float amount, std::uint64_t seed,
                      std::vector<float>& memory);

// [1] How hard the tuft bears on one of its sides, over the mean: bristles there go apart and together again,
// and the hand is not quite steady, so lips swell and break off. From 0 to 2 at an amount of 0.25 and more.
float side_bears(float way_mm, float amount, std::uint64_t seed, int side);

// For a brush that stands: from 0 behind it to 1 ahead, half_px from its middle, or the other way round where
// `side` is -1. Lanes lie along its way then.
BristleLanes ramp_of(float side, float half_px, std::vector<float>& memory);

}  // namespace tangi
