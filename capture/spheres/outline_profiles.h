// outline_profiles.h: edges along the radii of a sphere, and how well an outline agrees with them.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "capture/spheres/sphere_crops.h"

namespace tangi {

// Edges along the radius at one angle, mean over the photographs, kSample apart, the middle one at `middle`.
struct EdgeProfile {
    static constexpr double kSample = 0.25;  // [pixels]

    glm::dvec2 middle, outwards;
    std::vector<double> clear;  // [0..1] of the logarithm, bounded: whether there is an edge, however strong
    std::vector<double>
        slope;  // [1 per pixel] relative to the contrast nearby: where it is, unbiased by the logarithm

    // Of `clear`, at this distance [pixels] from the middle; 0 beyond its ends.
    double at(double offset) const;
};

// Around a sphere, about one for each pixel of its outline, `reach` [pixels] to either side of it; none where
// a profile leaves the picture.
std::vector<EdgeProfile> profiles_around(const SphereCrops& crops, const SphereImage& sphere,
                                         const SphereCamera& camera, double reach);

// [1] Mean over the profiles of how clear the edge on an outline is, and of how clear those right outside of
// it are; of the outline moved by `step` (centre, radius).
struct OutlineContrast {
    double on = 0, outside = 0;

    // A sphere's outline is the outermost of the rings that it shows: edges outside of it count against it.
    double agreement() const;
    // Whether it is told from whatever else has edges there, as the pattern of a painting.
    bool stands_out() const;
};
OutlineContrast contrast_of(const std::vector<EdgeProfile>& profiles, const glm::dvec3& step);

}  // namespace tangi
