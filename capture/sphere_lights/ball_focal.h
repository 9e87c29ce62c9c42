// ball_focal.h: how wide the camera sees, from what the balls in the photographs show and what the user
// gives.
#pragma once

#include "capture/sphere_lights/ball_calibration.h"
#include "capture/sphere_lights/focal_evidence.h"

namespace tangi {

// What is measured of a ball, where an ideal camera would have seen it.
struct BallView {
    std::string name;
    BallImage image;
    std::optional<Known> elongation{};
    std::vector<Highlight> highlights{};  // one a photograph; empty for matt balls
};

BallView view_of(const FoundBall& ball, const std::optional<Lens>& lens);
std::vector<BallView> views_of(const BallCalibration& c, const BallCalibrationOptions& options);
Known mean_radius_px(const std::vector<BallView>& views);

double diagonal_of(const BallCalibration& c);  // [px] of the photographs
MeasuredLengths lengths_of(const BallCalibrationOptions& options, int width, int height);
PositionInput position_input(const BallCalibration& c, const std::vector<BallView>& views, double radius_mm);

// Finds the focal length (c.camera) from what is given and what the balls show, measuring them once more
// where it is another one than they were measured with, and says what contradicts it (c.poor). Throws Error
// where lengths cannot be.
FocalVerdict find_focal_length(BallCalibration& c, const BallCalibrationOptions& options);

// [1/px] What is not known of 1 / focal length (standard error), contradictions counted.
double inverse_focal_sigma(const FocalVerdict& verdict, const BallCamera& camera);

// [rad] By so much (standard error) it turns all that a ball reflects, or is shaded.
double turned_by_focal_length(const BallView& ball, const BallCamera& camera, const FocalVerdict& verdict);

// Warns where directions hang on a focal length that is not known; poor where by much.
void tell_of_focal_length(BallCalibration& c, const std::vector<BallView>& views,
                          const FocalVerdict& verdict);

// One ball does not see lamps from where the painting is, and cannot tell how far away they are: part of the
// errors.
void add_parallax(BallCalibration& c, const BallView& ball);

}  // namespace tangi
