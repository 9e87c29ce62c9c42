// hatching.h: the lines and dots that a visible retouch is made of, inside a mask.
//
// A pixel belongs to one mark or to none: a half-covered pixel would be a thin film, whose colour is not the
// mean of paint and ground. So widths and distances are rounded to whole pixels.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "retouch/mask/mask.h"

namespace tangi {

// Pixels from the top left corner, y down; a path of one point is a dot.
struct Mark {
    std::vector<glm::vec2> path_px;
};

struct MarkGeometry {
    double pitch_px = 4;    // between the middles of neighbouring marks
    double width_px = 2;    // of a line, or a dot's diameter
    double length_px = 30;  // of a line at most
    std::uint64_t seed = 0;
};

// Vertical lines, `pitch` apart, in pieces of `length` whose ends do not line up (tratteggio: Brandi 1963).
std::vector<Mark> vertical_marks(const Mask& mask, const MarkGeometry& geometry);

// Lines along `direction_rad` (against x, y down), evenly spaced (Jobard & Lefer 1997).
std::vector<Mark> flow_marks(const Mask& mask, const Image<float>& direction_rad,
                             const MarkGeometry& geometry);

// Short lines in three crossing directions, woven (astrazione cromatica: Baldini 1978).
std::vector<Mark> crossed_marks(const Mask& mask, const MarkGeometry& geometry);

// Dots no nearer to each other than `pitch`, else as dense as they go: blue noise (Poisson discs, Cook 1986).
std::vector<Mark> dots(const Mask& mask, const MarkGeometry& geometry);

// The number of the mark that covers each pixel, later ones on top; -1 where there is none or the mask is
// below 1/2. Vertical lines come out as whole columns.
Image<int> rasterised(const std::vector<Mark>& marks, const Mask& mask, double width_px);

// The direction in which the surroundings' form runs, carried on into `hole`: eigenvectors of the structure
// tensor of lightness (Bigun & Granlund 1987) at `sigma_px`, its components interpolated by a membrane.
Image<float> form_direction_rad(const Image<float>& lightness, const Mask& hole, double sigma_px);

}  // namespace tangi
