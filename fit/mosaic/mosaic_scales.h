// mosaic_scales.h: one scale of reflectance and one frame of slopes for all positions, from what they show
// alike.
#pragma once

#include <glm/mat3x3.hpp>
#include <vector>

#include "fit/mosaic/mosaic_cells.h"

namespace tangi {

// What brings a position's maps to the wall's.
struct PositionScale {
    Rgb diffuse{1};       // [1] factors of rho_d
    float specular = 1;   // [1] of rho_s
    float roughness = 1;  // [1] of alpha
    double tilt_deg = 0;  // [deg] of the camera against the wall's plane
    glm::dmat3 frame{1};  // vectors of the position -> those of the wall
};

// Of what two positions differ by where both are, before and after.
struct PairDifference {
    std::size_t first = 0, second = 0;
    std::size_t cells = 0;
    double delta_e_2000 = 0, delta_e_2000_p95 = 0;  // [1] of rho_d, means of cells, on one scale
    double tilt_before_deg = 0;                     // [deg] between their slopes, median
    double slope_rms = 0;                           // [1] that is left of it, in each direction
};

struct MosaicScales {
    std::vector<PositionScale> positions;
    std::vector<PairDifference> pairs;
};

// Cells that two positions cover say by what factor rho_d in each channel, rho_s and alpha differ, and by
// what slope: medians, since seams of paint that was touched in between must not say. Least squares over all
// pairs, each by its number of cells; the geometric mean of all factors is 1. The cameras' tilts are
// rotations (Rodrigues), small ones beside the turn that the layout has; the wall's own frame is the one in
// which its mean slope is 0, as a painting's height is above its mean plane.
MosaicScales solve_scales(const MosaicLayout& layout, const std::vector<CellMaps>& maps);

// [1] Mean slope of a cell as the wall has it.
glm::dvec2 slope_on_wall(const PositionScale& scale, const glm::vec2& slope);

}  // namespace tangi
