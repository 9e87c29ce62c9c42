// ball_lights.h: directions and positions of the lamps from what mirror balls show, and what contradicts
// what.
#pragma once

#include "capture/ball_calibration.h"
#include "capture/focal_evidence.h"

namespace tangi {

// What is measured of a ball, where an ideal camera would have seen it.
struct BallView {
    std::string name;
    BallImage image;
    std::optional<Known> elongation{};
    std::vector<Highlight> highlights{};  // one a photograph; empty for matt balls
};

BallView view_of(const FoundBall& ball, const std::optional<Lens>& lens);

MeasuredLengths lengths_of(const BallCalibrationOptions& options, int width, int height);

// Finds the focal length (c.camera) from what is given and what the balls show, measuring them once more
// where it is another one than they were measured with, and says what contradicts it. Throws Error where
// lengths cannot be.
FocalVerdict find_focal_length(BallCalibration& c, const BallCalibrationOptions& options);

// Fills lights, positions, camera and scale of `c`, whose balls are known; what contradicts each other
// becomes poor, and part of the errors.
void lights_from_balls(BallCalibration& c, const BallCalibrationOptions& options,
                       const FocalVerdict& verdict);

// Warns where directions hang on a focal length that is not known; poor where by much.
void tell_of_focal_length(BallCalibration& c, const std::vector<BallView>& views,
                          const FocalVerdict& verdict);

// A light's direction, unless it comes from below or is too uncertain.
void keep_direction(CalibratedLight& light, const glm::dvec3& direction, double sigma_rad);

// [rad] What is not known of the focal length turns all that a ball reflects, or is shaded, by so much
// (standard error).
double turned_by_focal_length(const BallView& ball, const BallCamera& camera, const FocalVerdict& verdict);

}  // namespace tangi
