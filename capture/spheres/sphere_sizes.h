// sphere_sizes.h: spheres are taken to be of one size, in one plane: what else shows lights is none.
//
// A glossy bump of a painting is a small convex mirror, too, and shows where the lights are about as well as
// a sphere does; its size gives it away.
#pragma once

#include <optional>

#include "capture/spheres/mirror_sphere.h"

namespace tangi {

// Whether two radii differ by less than lengths that were measured, or outlines, may be off: a factor of 1.3.
bool is_of_size(double radius_px, double expected_px);

// [1] Ratio of radii up to which spheres count as equally large.
constexpr double kTwinSize = 1.13;

// Whether two outlines that were measured may be of spheres of one size, in one plane.
bool is_twin_size(double radius_px, double other_px);

// Spheres are solid: two on one plane are seen at least their radii apart, less what a camera that looks at
// the plane aslant foreshortens. 0.7 of that is a view from 45 degrees.
bool cannot_both_be(const SphereImage& a, const SphereImage& b);

// [1] How much speaks for a sphere: part of its outline that shows, times part of the photographs in which it
// shows the light.
double weight_of(const FoundSphere& sphere);

// Of spheres that nobody spoke of, keeps those of the expected size where there are any; else those of the
// size that most speaks for: highlights found and outline seen, summed over all spheres of that size. Others
// are left out, each with a warning.
void keep_one_size(SphereSearch& search, const std::optional<double>& expected_px);

}  // namespace tangi
