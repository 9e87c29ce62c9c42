// sphere_focal.h: how wide the camera sees, from what the spheres in the photographs show and what the user
// gives.
#pragma once

#include "capture/sphere_lights/focal_evidence.h"
#include "capture/sphere_lights/sphere_calibration.h"

namespace tangi {

// What is measured of a sphere, where an ideal camera would have seen it.
struct SphereView {
    std::string name;
    SphereImage image;
    std::optional<Known> elongation{};
    std::vector<Highlight> highlights{};  // one a photograph; empty for diffuse spheres
};

SphereView view_of(const FoundSphere& sphere, const std::optional<Lens>& lens);
std::vector<SphereView> views_of(const SphereCalibration& c, const SphereCalibrationOptions& options);
Known mean_radius_px(const std::vector<SphereView>& views);

double diagonal_of(const SphereCalibration& c);  // [px] of the photographs
MeasuredLengths lengths_of(const SphereCalibrationOptions& options, int width, int height);
PositionInput position_input(const SphereCalibration& c, const std::vector<SphereView>& views,
                             double radius_mm);

// Finds the focal length (c.camera) from what is given and what the spheres show, measuring them once more
// where it is another one than they were measured with, and says what contradicts it (c.poor). Throws Error
// where lengths cannot be.
FocalVerdict find_focal_length(SphereCalibration& c, const SphereCalibrationOptions& options);

// [1/px] What is not known of 1 / focal length (standard error), contradictions counted.
double inverse_focal_sigma(const FocalVerdict& verdict, const SphereCamera& camera);

// [rad] By so much (standard error) it turns all that a sphere reflects, or is shaded.
double turned_by_focal_length(const SphereView& sphere, const SphereCamera& camera,
                              const FocalVerdict& verdict);

// Warns where directions hang on a focal length that is not known; poor where by much.
void tell_of_focal_length(SphereCalibration& c, const std::vector<SphereView>& views,
                          const FocalVerdict& verdict);

// One sphere does not see lights from where the painting is, and cannot tell how far away they are: part of
// the errors.
void add_parallax(SphereCalibration& c, const SphereView& sphere);

}  // namespace tangi
