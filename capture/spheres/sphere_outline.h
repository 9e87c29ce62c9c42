// sphere_outline.h: a sphere's outline to a fraction of a pixel.
#pragma once

#include <optional>
#include <vector>

#include "capture/spheres/sphere_crops.h"

namespace tangi {

// [pixels] Part of the errors of every outline: of a limb that fades into what lies behind it.
constexpr double kCentreSystematic = 0.1, kRadiusSystematic = 0.4;

struct SphereOutline {
    SphereImage sphere;                // with standard errors
    std::vector<glm::dvec2> edges_px;  // that were used
    double coverage = 0;               // [1] part of the outline whose edge was used
    double residual_px = 0;            // robust standard deviation of the edges from the outline
    // [1] Length over width less 1, along the line from the picture's principal point; a camera far away sees
    // 0.
    std::optional<Known> elongation{};
};

// Starts from an outline that is right to about 5 % of the radius, or two pixels. The profiles of all
// photographs along the radius, each taken relative to its own contrast, first vote for an outline as a
// whole, edges beyond it counting against it; through the edges next to that goes the outline that a sphere
// has for this camera (a circle, an ellipse in perspective), by least squares with Tukey's weights. Nothing
// where less than a fifth of the outline shows.
std::optional<SphereOutline> refine_outline(const SphereCrops& crops, const SphereImage& start,
                                            const SphereCamera& camera);

}  // namespace tangi
