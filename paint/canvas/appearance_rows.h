// appearance_rows.h: what is seen of paint beside its colour, its gloss and its slopes, for many pixels at
// once (appearance.h).
#pragma once

#include <cstddef>

#include "surface/image/image.h"

namespace tangi {

// Of n pixels: thickness [mm] of a film, and the sums of its paints' rho_s and alpha by volume.
struct FilmRows {
    float *mm, *specular, *roughness;
};
// Adds a paint of this rho_s and alpha.
void add_paint_rows(std::size_t n, const float* volume_mm, float specular, float roughness,
                    const FilmRows& film);

// Of n pixels: rho_s, alpha, and the part of rho_s that is of what is dry.
struct SheenRows {
    float *specular, *roughness, *coloured;
};
// The gloss of a film over that of what lies below, in place.
void lay_sheen_rows(std::size_t n, const FilmRows& film, float covering_mm, const SheenRows& below);

// [1] 1 - exp(-mm / covering_mm); mm >= 0.
void covered_rows(std::size_t n, const float* mm, float covering_mm, float* covered);

// Normals of what is dry, with the slopes of paint on it: thickness [mm] at the places to the right, to the
// left, above and below that a difference is taken of, and 1 over the way between these [1/mm]. Where no
// paint slopes, what is dry comes out bit for bit.
struct ThicknessAround {
    const float *right, *left, *above, *below;
    float per_mm_across, per_mm_up;
};
void tilt_rows(std::size_t n, const ThicknessAround& thickness, const Vec3* dry, Vec3* normal);

}  // namespace tangi
