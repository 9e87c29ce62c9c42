// noise.h: randomness as a hash of (position or index, seed): the same on any number of threads and in any
// order.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace tangi::procedural {

using Seed = std::uint64_t;

// A well-mixed 64-bit hash (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators", figure
// 16).
inline Seed hash(Seed seed, std::uint64_t index) {
    Seed z = seed + 0x9e3779b97f4a7c15u * (index + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// Of a cell of an integer grid, which may be negative.
inline Seed hash(Seed seed, int x, int y) {
    return hash(seed, (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) |
                          static_cast<std::uint32_t>(y));
}

// Uniform in [0, 1) and in [low, high).
inline float uniform(Seed h) { return static_cast<float>(h >> 40) * 0x1p-24f; }
inline float uniform(Seed h, float low, float high) { return low + (high - low) * uniform(h); }

// Two independent numbers, normally distributed with mean 0 and variance 1 (Box, Muller 1958).
struct NormalPair {
    float first, second;
};
inline NormalPair normal_pair(Seed h) {
    const float radius = std::sqrt(-2 * std::log(1 - uniform(h)));
    const float angle = 2 * std::numbers::pi_v<float> * uniform(hash(h, 1));
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

// Gradient noise about 0, within [-1, 1], features of size 1 (Perlin 2002, "Improving noise").
float noise(float x, float y, Seed seed);

// Sum of octaves of it, each half as large and half as strong as the one before; within [-2, 2].
float fractal_noise(float x, float y, int octaves, Seed seed);

// Distance to the nearest edge of a Voronoi diagram with one random point in each unit cell (Worley 1996, "A
// cellular texture basis function"; the distance is to the bisector, not the usual F2 - F1).
float voronoi_edge_distance(float x, float y, Seed seed);

// 0 below `low`, 1 above `high`, smooth between.
inline float smooth_step(float low, float high, float x) {
    const float t = std::fmin(std::fmax((x - low) / (high - low), 0.0f), 1.0f);
    return t * t * (3 - 2 * t);
}

inline float mix(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace tangi::procedural
