// scale_agreement.h: scales of one plane that were told in several ways: which to use, and what contradicts
// it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/geometry/scale.h"

namespace tangi {

constexpr double kPointSigma_px = 1;  // of corners that people point at

// How large a pixel at a place [px] is on the plane, in any unit that is the same for all places: 1
// everywhere where the camera looks straight.
using RelativeScale = std::function<double(const glm::dvec2& place_px)>;

// Puts the scale first that the most others agree with (within 3 standard errors, or 1 %), of several the
// most certain; the others behind it, the most certain first. So one that is wrong outvotes no two that are
// right.
void rank_scales(std::vector<Scale>& scales, const RelativeScale& relative);

// For people: each scale that the first contradicts, with the numbers.
std::vector<std::string> contradictions(const std::vector<Scale>& scales, const RelativeScale& relative);

// For people: by how much corners that were pointed at contradict the size that was told, where no camera of
// this focal length, or of any from 20 to 170 mm (35-mm equivalent) where it is empty, sees a rectangle of
// that size so; empty where one does. `diagonal_px` of the photographs.
std::optional<std::string> contradiction_of_corners(const Corners& corners_px, const glm::dvec2& size_mm,
                                                    const std::optional<double>& focal_px,
                                                    const glm::dvec2& principal_px, double diagonal_px);

}  // namespace tangi
