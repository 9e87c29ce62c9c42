// uncalibrated_report.h: lights of which nothing is written down, from photographs on disk to files
// (uncalibrated.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "capture/sphere_lights/sphere_calibration.h"
#include "capture/stack/photo_set.h"
#include "capture/uncalibrated/uncalibrated.h"
#include "surface/image/colour.h"

namespace tangi {

struct UncalibratedStackOptions {
    bool inverted = false;               // the other reading
    std::optional<Transfer> transfer{};  // as the photographs' metadata say where empty, else linear
};

struct UncalibratedStack {
    SphereCalibration calibration;  // without spheres; its method is "uncalibrated"
    UncalibratedLights found;       // of the photographs that are not left out
    Transfer transfer;
};

// Reads the photographs small. Black ones are left out. Throws Error as uncalibrated_lights(), naming the
// folder, and for photographs that cannot be read.
UncalibratedStack calibrate_uncalibrated(const PhotoSet& set, const UncalibratedStackOptions& options = {},
                                         const Progress& progress = {});

// HTML for Calibration::section: the relief in both readings, side by side. `scratch` as for picture_url().
std::string readings_section(const UncalibratedLights& found, const std::filesystem::path& scratch);

}  // namespace tangi
