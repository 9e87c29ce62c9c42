// brush_strokes.h: one stroke of a bristle brush as a function of a point, and many of them in painting
// order.
//
// Points are in mm in the surface frame (y up). A stroke runs along a circular arc; s is the way along it
// from its start, v the distance to its left.
#pragma once

#include <span>
#include <vector>

#include "surface/base/noise.h"
#include "surface/image/image.h"

namespace tangi::procedural {

// The painting at one point.
struct PaintSample {
    float height_mm = 0;
    Rgb diffuse{1};
    float specular = 0;
    float roughness = 0.6f;
    Rgb specular_colour{1};
};

struct Stroke {
    float x_mm = 0, y_mm = 0;  // middle of the stroke
    float cos = 1, sin = 0;    // direction there
    float curvature = 0;       // [1/mm] > 0 turns left
    float length_mm = 20, half_width_mm = 3;
    float thickness_mm = 0.1f;  // of the paint between the ridges
    float ridge_mm = 0.1f;      // height of the rim that the brush pushes to its sides and leaves at its end
    float load = 2;             // [1] paint on the brush; below about 1.4 it runs dry before the end
    float level_mm = 0;         // height of the layers below, whose relief the new paint partly fills
    Rgb first{1}, second{1};    // two paints that the brush carries, not quite mixed
    float specular = 0.04f, roughness = 0.3f;
    Seed seed = 0;
};

// Lays the stroke over what is there.
void apply(const Stroke& stroke, float x_mm, float y_mm, PaintSample& sample);

// Strokes in painting order, found by place.
class StrokeGrid {
public:
    // The picture spans +-half_width_mm, +-half_height_mm. Strokes further out are never found.
    StrokeGrid(std::vector<Stroke> strokes, float half_width_mm, float half_height_mm);

    // Lays all strokes that reach the point, which lies in the picture or close to it, in order.
    void apply_all(float x_mm, float y_mm, PaintSample& sample) const;

private:
    std::vector<Stroke> strokes_;
    float half_width_mm_, half_height_mm_, cell_mm_;
    Image<std::vector<int>> cells_;  // indices of the strokes that may reach a cell, ascending
};

}  // namespace tangi::procedural
