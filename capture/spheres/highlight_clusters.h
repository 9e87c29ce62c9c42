// highlight_clusters.h: where in the picture a small bright spot wanders about as the light moves, one a
// photograph: that is how a mirror sphere shows.
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "surface/image/image.h"

namespace tangi {

// [1] The median over all photographs, pixel by pixel: what stays while the light moves.
Image<float> median_of(std::span<const Image<float>> photos);

struct HighlightSpot {
    glm::dvec2 place_px{0, 0};
    float peak = 0;  // [1]
    double area_px = 0;
};

// Spots of one photograph nearly as bright as anything in it, far brighter than the median there, and small.
// The reflection of a light in a mirror is.
std::vector<HighlightSpot> highlight_spots(const Image<float>& photo, const Image<float>& median);

struct HighlightCluster {
    glm::dvec2 centre_px{0, 0};
    double radius_px = 0;  // of the smallest circle around `centre_px` that holds all `places_px`
    std::vector<glm::dvec2> places_px;  // of the spot, in the photographs that have exactly one there
    double score = 0;  // [1] part of the photographs that have one spot, less those with several
};

// Best first; clusters do not overlap. `spots` has one list for each photograph.
std::vector<HighlightCluster> highlight_clusters(std::span<const std::vector<HighlightSpot>> spots, int width,
                                                 int height);

}  // namespace tangi
