#include "paint/exchange/bristle_lanes.h"

#include <algorithm>
#include <cmath>

#include "surface/base/noise.h"

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

float side_bears(float way_mm, float amount, std::uint64_t seed, int side) {
    using namespace procedural;
    const auto wave = [&](int which, float length_mm) {
        const auto own = hash(hash(seed, 77), side, which);
        const float at = way_mm / length_mm + uniform(own), whole = std::floor(at);
        const auto i = static_cast<std::uint64_t>(whole);
        return mix(uniform(hash(own, i)), uniform(hash(own, i + 1)), smooth_step(0, 1, at - whole)) - 0.5f;
    };
    const float n = 2.2f * wave(0, 8.0f) + 1.6f * wave(1, 3.5f);
    return std::clamp(1 + std::min(4 * amount, 1.0f) * n, 0.0f, 2.0f);
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
