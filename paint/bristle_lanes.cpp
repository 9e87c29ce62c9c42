#include "paint/bristle_lanes.h"

#include <algorithm>
#include <cmath>

#include "surface/noise.h"

namespace tangi {

namespace {

constexpr float kStreak = 8;  // [1] length of streaks over their width

}  // namespace

BristleLanes lanes_at(float way_px, float half_px, float bristle_px, float amount, std::uint64_t seed,
                      std::vector<float>& memory) {
    using procedural::hash;
    using procedural::mix;
    using procedural::smooth_step;
    using procedural::uniform;
    if (!(amount > 0)) return {};
    const float width_px = std::max(bristle_px, 2.0f);
    const int nodes = static_cast<int>(half_px / width_px) + 1;
    // Streaks of a bristle follow on each other; those beside it begin elsewhere.
    const auto node = [&](int k) {
        const auto own = hash(seed, static_cast<std::uint64_t>(k + (1 << 20)));
        const float at = way_px / (kStreak * width_px) + uniform(own), whole = std::floor(at);
        const auto i = static_cast<std::uint64_t>(whole);
        const float n = mix(uniform(hash(own, i)), uniform(hash(own, i + 1)), smooth_step(0, 1, at - whole));
        return std::max(1 + amount * (2 * n - 1), 0.01f);
    };
    const float per_node = width_px * BristleLanes::kPerPixel;
    const int count = static_cast<int>(2 * static_cast<float>(nodes) * per_node) + 1;
    memory.resize(static_cast<std::size_t>(count));
    float before = node(-nodes), after = node(1 - nodes);
    for (int i = 0, k = -nodes; i < count; ++i) {
        const float at = static_cast<float>(i) / per_node - static_cast<float>(nodes);
        while (at >= static_cast<float>(k + 1)) {
            before = after;
            after = node(++k + 1);
        }
        memory[static_cast<std::size_t>(i)] = mix(before, after, at - static_cast<float>(k));
    }
    return {memory.data(), count, -static_cast<float>(nodes) * width_px};
}

BristleLanes ramp_of(float side, float half_px, std::vector<float>& memory) {
    const int count = static_cast<int>(2 * half_px * BristleLanes::kPerPixel) + 1;
    memory.resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const float at = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
        memory[static_cast<std::size_t>(i)] = side < 0 ? 1 - at : at;
    }
    return {memory.data(), count, -half_px};
}

}  // namespace tangi
