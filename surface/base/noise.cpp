#include "surface/base/noise.h"

#include <algorithm>

namespace tangi::procedural {

namespace {

// Dot product of the offset (x, y) from a grid point with that point's gradient.
float gradient_term(Seed seed, int cell_x, int cell_y, float x, float y) {
    // Sixteen directions, as unit vectors; a table costs less than sine and cosine.
    static constexpr float kCos[16] = {
        1,  0.92387953f,  0.70710678f,  0.38268343f,  0, -0.38268343f, -0.70710678f, -0.92387953f,
        -1, -0.92387953f, -0.70710678f, -0.38268343f, 0, 0.38268343f,  0.70710678f,  0.92387953f};
    const auto turn = static_cast<unsigned>(hash(seed, cell_x, cell_y) >> 60);
    return x * kCos[turn] + y * kCos[(turn + 12) % 16];
}

float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

}  // namespace

float noise(float x, float y, Seed seed) {
    const float floor_x = std::floor(x), floor_y = std::floor(y);
    const int ix = static_cast<int>(floor_x), iy = static_cast<int>(floor_y);
    const float fx = x - floor_x, fy = y - floor_y;
    const float top =
        mix(gradient_term(seed, ix, iy, fx, fy), gradient_term(seed, ix + 1, iy, fx - 1, fy), fade(fx));
    const float bottom = mix(gradient_term(seed, ix, iy + 1, fx, fy - 1),
                             gradient_term(seed, ix + 1, iy + 1, fx - 1, fy - 1), fade(fx));
    // The values of unit gradients stay within sqrt(1/2).
    return std::numbers::sqrt2_v<float> * mix(top, bottom, fade(fy));
}

float fractal_noise(float x, float y, int octaves, Seed seed) {
    float sum = 0, strength = 1;
    for (int octave = 0; octave < octaves; ++octave, strength /= 2, x *= 2, y *= 2)
        sum += strength * noise(x, y, hash(seed, static_cast<std::uint64_t>(octave)));
    return sum;
}

float voronoi_edge_distance(float x, float y, Seed seed) {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    struct Offset {
        float x, y;
    };
    const auto to_point = [&](int cx, int cy) {
        const Seed h = hash(seed, cx, cy);
        return Offset{static_cast<float>(cx) + uniform(h) - x,
                      static_cast<float>(cy) + uniform(hash(h, 1)) - y};
    };
    Offset nearest{};
    int nearest_x = 0, nearest_y = 0;
    float best = 1e9f;
    for (int cy = iy - 1; cy <= iy + 1; ++cy)
        for (int cx = ix - 1; cx <= ix + 1; ++cx) {
            const Offset o = to_point(cx, cy);
            const float distance2 = o.x * o.x + o.y * o.y;
            if (distance2 < best) {
                best = distance2;
                nearest = o;
                nearest_x = cx;
                nearest_y = cy;
            }
        }
    float edge = 1e9f;
    for (int cy = nearest_y - 2; cy <= nearest_y + 2; ++cy)
        for (int cx = nearest_x - 2; cx <= nearest_x + 2; ++cx) {
            if (cx == nearest_x && cy == nearest_y) continue;
            const Offset o = to_point(cx, cy);
            const float dx = o.x - nearest.x, dy = o.y - nearest.y;
            const float length = std::sqrt(dx * dx + dy * dy);
            if (length < 1e-6f) continue;  // two points in one place have no edge between them
            edge = std::min(edge, ((o.x + nearest.x) * dx + (o.y + nearest.y) * dy) / (2 * length));
        }
    return edge;
}

}  // namespace tangi::procedural
