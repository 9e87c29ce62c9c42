// Loops for vector instructions; CMakeLists.txt gives this file the flags for them.
#include "paint/canvas/appearance_rows.h"

#include <algorithm>
#include <array>

#include "paint/optics/exp_lanes.h"

namespace tangi {

namespace {

constexpr std::size_t kBlock = 64;  // pixels

TP_INLINE float covered_by(float mm, float per_mm) {
    const float e = expm1_of(smaller(larger(mm, 0.0f) * per_mm, 60.0f));
    return e / (1 + e);
}

// Compilers believe __restrict of parameters only.
TP_INLINE void add_paint(std::size_t n, const float* __restrict volume_mm, float specular, float roughness,
                         float* __restrict mm, float* __restrict specular_mm,
                         float* __restrict roughness_mm) {
    for (std::size_t i = 0; i < n; ++i) {
        mm[i] += volume_mm[i];
        specular_mm[i] += volume_mm[i] * specular;
        roughness_mm[i] += volume_mm[i] * roughness;
    }
}

TP_INLINE void lay_sheen(std::size_t n, const float* __restrict mm, const float* __restrict specular_mm,
                         const float* __restrict roughness_mm, float per_mm, float* __restrict specular,
                         float* __restrict roughness, float* __restrict coloured) {
    for (std::size_t i = 0; i < n; ++i) {
        // Without paint nothing is covered, whatever is divided by.
        const float covered = covered_by(mm[i], per_mm), each = 1 / larger(mm[i], 1e-30f);
        specular[i] += covered * (specular_mm[i] * each - specular[i]);
        roughness[i] += covered * (roughness_mm[i] * each - roughness[i]);
        coloured[i] *= 1 - covered;
    }
}

TP_INLINE void cover(std::size_t n, const float* __restrict mm, float per_mm, float* __restrict covered) {
    for (std::size_t i = 0; i < n; ++i) covered[i] = covered_by(mm[i], per_mm);
}

}  // namespace

TP_VECTOR_CLONES
void add_paint_rows(std::size_t n, const float* volume_mm, float specular, float roughness,
                    const FilmRows& film) {
    add_paint(n, volume_mm, specular, roughness, film.mm, film.specular, film.roughness);
}

TP_VECTOR_CLONES
void lay_sheen_rows(std::size_t n, const FilmRows& film, float covering_mm, const SheenRows& below) {
    lay_sheen(n, film.mm, film.specular, film.roughness, 1 / covering_mm, below.specular, below.roughness,
              below.coloured);
}

TP_VECTOR_CLONES
void covered_rows(std::size_t n, const float* mm, float covering_mm, float* covered) {
    cover(n, mm, 1 / covering_mm, covered);
}

TP_VECTOR_CLONES
void tilt_rows(std::size_t n, const ThicknessAround& t, const Vec3* dry, Vec3* normal) {
    std::array<float, kBlock> x, y, z;
    for (std::size_t first = 0; first < n; first += kBlock) {
        const std::size_t count = std::min(kBlock, n - first);
        const Vec3* from = dry + first;
        Vec3* to = normal + first;
        for (std::size_t i = 0; i < count; ++i) x[i] = from[i].x, y[i] = from[i].y, z[i] = from[i].z;
        for (std::size_t i = 0; i < count; ++i) {
            const float across = (t.right[first + i] - t.left[first + i]) * t.per_mm_across,
                        up = (t.above[first + i] - t.below[first + i]) * t.per_mm_up;
            const float sx = across - x[i] / z[i], sy = up - y[i] / z[i];
            const float inverse = 1 / __builtin_sqrtf(1 + sx * sx + sy * sy);
            const bool level = (across == 0) & (up == 0);
            x[i] = level ? x[i] : -sx * inverse;
            y[i] = level ? y[i] : -sy * inverse;
            z[i] = level ? z[i] : inverse;
        }
        for (std::size_t i = 0; i < count; ++i) to[i] = Vec3(x[i], y[i], z[i]);
    }
}

}  // namespace tangi
