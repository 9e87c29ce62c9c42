// calibration_page.h: a calibration as files: lights.lp, capture.json for programs, capture.html for
// people.
#pragma once

#include <filesystem>

#include "capture/calibration/plane_calibration.h"
#include "capture/colour_chart/colour_calibration.h"
#include "capture/formats/capture_file.h"
#include "capture/sphere_lights/sphere_calibration.h"

namespace tangi {

// Of these files, those that are there and are not as write_calibration() leaves them: others wrote or
// changed them. A lights file is ours where the capture file beside it has the same lights.
std::vector<std::filesystem::path> not_ours(const CalibrationFiles& files);

// All that was found. Without spheres only the size of the photographs, the camera and the frame are used of
// `lights`.
struct Calibration {
    SphereCalibration lights;
    std::optional<ColourCalibration> colours{};
    std::optional<PlaneCalibration> plane{};
    nlohmann::json development = nullptr;  // to_json(DevelopReport)
    std::string raw_colour{};              // "camera", "rec709"; empty for files that are no raws
    std::string section{};                 // HTML that the page shows after the lights
};

// All files are on the disk before the first of them takes its name, so that a disk that is full leaves what
// was there; the lights file comes last, and only where there is a light. Throws Error naming the file that
// cannot be written.
CalibrationFiles write_calibration(const std::filesystem::path& out, const Calibration& calibration);

// The whole capture.json: see docs/reference/capture-json.md.
nlohmann::json to_json(const Calibration& calibration);

// Each sphere under all lights at once (the brightest of all photographs), lightened, for the page.
Image<Rgb> sphere_picture(const FoundSphere& sphere);

// The page: one file, no script, no network. `sphere_urls` are the spheres' pictures, data: or a path.
// Whatever names contain, they stay text.
std::string calibration_page(const Calibration& calibration, const std::vector<std::string>& sphere_urls);

}  // namespace tangi
