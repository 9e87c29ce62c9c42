// edge_field.h: edges that stay where they are while the light moves, and circles made of them.
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

// The structure tensor (Foerstner, Guelch 1987) of the logarithm of the photographs, each divided by the
// length of its gradient, mean of all: x = gx gx / |g|, y = gx gy / |g|, z = gy gy / |g| with x right and y
// down. Gradients are bounded, so that a shadow's edge or a highlight that passes in one photograph counts
// once, and an edge that all show counts in all. Edges of either sign add up.
struct EdgeField {
    Image<Vec3> tensor;

    int width() const { return tensor.width(); }
    int height() const { return tensor.height(); }
};

// `step` is what one code of the file is worth: differences of that size are no edges.
EdgeField edge_field(std::span<const Image<float>> photos, float step);

// [1] Standard deviation of the noise of a photograph's dark parts, as stored.
float dark_noise(const Image<float>& photo);

struct Circle {
    glm::dvec2 centre_px{0, 0};  // y down
    double radius_px = 0;
    double score = 0;  // [1] outline_score()
};

struct CircleSearch {
    double smallest_px = 8, largest_px = 100;  // radius
    Region centres;                            // where the centre may lie
    std::vector<glm::dvec2> inside;            // points of which most lie in the circle
    int most = 12;  // circles wanted, of the sizes that are sought in one size of picture
};

// The circles with the best scores, best first: Hough's transform (Kimme, Ballard, Sklansky 1975: edges vote
// along their normals) and a climb from each of its peaks.
std::vector<Circle> find_circles(const EdgeField& field, const CircleSearch& search);

// [1] Part of the circle's outline in the picture that has an edge along it, less what lies around it in
// parallel: a sphere mirrors its surroundings in rings, and its outline is the outermost of them. 0 where
// less than half of it is in the picture.
double outline_score(const EdgeField& field, const glm::dvec2& centre, double radius);

}  // namespace tangi
