// canvas_part.h: a part of a canvas that an event names: a circle or a polygon, in mm.
#pragma once

#include <variant>
#include <vector>

#include "surface/image/image.h"
#include "surface/image/row_span.h"

namespace tangi {

// In the surface frame: mm from the centre of the picture, x right, y up.
struct PointMm {
    double x = 0, y = 0;
    friend bool operator==(const PointMm&, const PointMm&) = default;
};
struct CirclePart {
    PointMm centre;
    double radius_mm = 0;
    friend bool operator==(const CirclePart&, const CirclePart&) = default;
};
struct PolygonPart {
    std::vector<PointMm> corners;  // 3 or more; the last is joined to the first
    friend bool operator==(const PolygonPart&, const PolygonPart&) = default;
};
struct WholeCanvas {
    friend bool operator==(const WholeCanvas&, const WholeCanvas&) = default;
};
using CanvasPart = std::variant<WholeCanvas, CirclePart, PolygonPart>;

// Runs of pixels of each row of a canvas of `width` x `height` pixels whose centres lie in the part, from
// left to right, without overlaps. A polygon that crosses itself is inside where a line to the outside
// crosses it an odd number of times.
std::vector<std::vector<RowSpan>> rows_of(const CanvasPart& part, int width, int height, double mm_per_pixel);

}  // namespace tangi
