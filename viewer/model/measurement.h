// measurement.h: what a conservator measures on a painting: heights along a line, statistics of a region.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "surface/image/colour.h"
#include "surface/maps/surface.h"

namespace tangi {

// Heights at even steps of at most a pixel from one point to another, bilinear between pixels.
struct HeightProfile {
    glm::dvec2 from_px{0}, to_px{0};
    bool scale_known = false;      // false: lengths and heights are in pixels
    double step_mm = 1;            // between heights
    std::vector<float> height_mm;  // at least two; parts of the line beyond the picture are left out
};
// Empty heights where no part of the line lies on the painting.
HeightProfile height_profile(const Surface& surface, const glm::dvec2& from_px, const glm::dvec2& to_px);

// One of a surface of unknown scale, whose pixels are told to be of this size.
HeightProfile in_mm(HeightProfile profile, double mm_per_pixel);

// "distance_mm,height_mm" and a line for each height; "_px" where the scale is unknown.
std::string csv_of(const HeightProfile& profile);

struct MeanAndSpread {
    double mean = 0, deviation = 0;  // standard deviation over the pixels
};

// Of the pixels of a region that were measured (confidence > 0); paint counts as measured.
struct RegionStatistics {
    Region region;
    std::size_t pixels = 0;
    Lab lab_of_mean;           // D65, of the mean rho_d
    double colour_spread = 0;  // [1] mean CIEDE2000 of the pixels to that
    MeanAndSpread specular, roughness, height_mm, confidence;
    double rms_slope = 0;  // [1] of the normals, less their mean
};
RegionStatistics statistics_of(const Surface& surface, const Region& region);

}  // namespace tangi
