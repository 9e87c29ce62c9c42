// calibrate_arguments.h: what tangipaint calibrate can be told, and what that means.
#pragma once

#include "capture/calibration/plane_calibration.h"
#include "capture/colour_chart/colour_calibration.h"
#include "capture/sphere_lights/sphere_calibration.h"
#include "cli/arguments.h"

namespace tangi {

struct CalibrateArguments {
    std::string folder, out, transfer = "auto";
    bool force = false;  // replace files that this program did not write
    std::vector<std::string> photos;
    DevelopArguments develop;
    // spheres and camera
    std::vector<std::string> spheres;
    std::string principal, origin;
    double sphere_radius_mm = 0, focal_px = 0, focal_35mm = 0, camera_distance_mm = 0;
    std::optional<double> sphere_height_mm;
    bool matt = false, no_spheres = false, fixed_camera = false;
    // no spheres, but a nearly flat object
    bool uncalibrated = false, inverted = false;
    // chart
    std::string chart = "auto", chart_reference;
    double chart_pitch_mm = 0;
    // scale and plane
    double marker_mm = 0, ppi = 0;
    std::string marker_dictionary = "auto", scale_bar, corners, painting_mm, lens, align_to;
    bool rectify = false;

    void add_to(Flags& flags);

    // All throw UsageError naming the flag.
    SphereCalibrationOptions sphere_options() const;
    std::optional<ColourCalibrationOptions> colour_options() const;  // none: --chart off
    PlaneOptions plane_options(int width, int height) const;         // of the photographs

private:
    void add_sphere_flags(Flags& flags);
    void add_camera_flags(Flags& flags);
    void add_chart_flags(Flags& flags);
    void add_plane_flags(Flags& flags);
};

}  // namespace tangi
