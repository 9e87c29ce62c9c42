// tiled_noise.h: noise that repeats after a number of cells: supports that can be laid edge to edge.
#pragma once

#include <cmath>

#include "surface/base/noise.h"

namespace tangi::procedural {

// i modulo count. Neighbours are off by less than a lap: dividing for them took a quarter of a support's
// time.
inline int wrapped(int i, int count) {
    const int once = i < 0 ? i + count : i < count ? i : i - count;
    return once >= 0 && once < count ? once : ((i % count) + count) % count;
}

// Perlin 2002.
inline float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

// Noise that repeats: values in [-1, 1] at the corners of `columns` x `rows` cells, smooth between (quintic).
// x in [0, columns), y in [0, rows).
inline float tiled_noise(float x, float y, int columns, int rows, Seed seed) {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    const float fx = fade(x - static_cast<float>(ix)), fy = fade(y - static_cast<float>(iy));
    const auto value = [&](int cx, int cy) {
        return uniform(hash(seed, wrapped(cx, columns), wrapped(cy, rows)), -1, 1);
    };
    return mix(mix(value(ix, iy), value(ix + 1, iy), fx), mix(value(ix, iy + 1), value(ix + 1, iy + 1), fx),
               fy);
}

// The same on the left edge of a column of cells.
inline float tiled_noise_along(int column, float y, int columns, int rows, Seed seed) {
    const int iy = static_cast<int>(std::floor(y)), x = wrapped(column, columns);
    const auto value = [&](int cy) { return uniform(hash(seed, x, wrapped(cy, rows)), -1, 1); };
    return mix(value(iy), value(iy + 1), fade(y - static_cast<float>(iy)));
}

// The same of slopes rather than values (Perlin 1985, "An image synthesizer"): about 0, within [-1, 1],
// without the squares that a lattice of values shows.
inline float tiled_slopes(float x, float y, int columns, int rows, Seed seed) {
    const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const auto value = [&](int dx, int dy) {
        const Seed h = hash(seed, wrapped(ix + dx, columns), wrapped(iy + dy, rows));
        return uniform(h, -1.4f, 1.4f) * (fx - static_cast<float>(dx)) +
               uniform(hash(h, 1), -1.4f, 1.4f) * (fy - static_cast<float>(dy));
    };
    const float u = fade(fx), v = fade(fy);
    return mix(mix(value(0, 0), value(1, 0), u), mix(value(0, 1), value(1, 1), u), v);
}

}  // namespace tangi::procedural
