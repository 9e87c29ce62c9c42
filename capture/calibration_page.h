// calibration_page.h: a calibration as files: lights.lp, capture.json for programs, capture.html for
// people.
#pragma once

#include <filesystem>

#include "capture/ball_calibration.h"
#include "capture/colour_calibration.h"
#include "capture/plane_calibration.h"

namespace tangi {

struct CalibrationFiles {
    std::filesystem::path lights, json, page;
};

// Where write_calibration() writes: three files of one name, so that a second calibration beside it replaces
// none of them. `out` is the lights file (.lp) or the capture file (.json); beside lights.lp the others are
// capture.json and capture.html.
CalibrationFiles calibration_files(const std::filesystem::path& out);

// Of these files, those that are there and are not as write_calibration() leaves them: others wrote or
// changed them. A lights file is ours where the capture file beside it has the same lights.
std::vector<std::filesystem::path> not_ours(const CalibrationFiles& files);

// All that was found. Without balls only the size of the photographs, the camera and the frame are used of
// `lights`.
struct Calibration {
    BallCalibration lights;
    std::optional<ColourCalibration> colours{};
    std::optional<PlaneCalibration> plane{};
    nlohmann::json development = nullptr;  // to_json(DevelopReport)
    std::string raw_colour{};              // "camera", "rec709"; empty for files that are no raws
    std::string section{};                 // HTML that the page shows after the lights
};

// Each file appears whole or not at all, the lights file last, and only where there is a light; none of them
// where one cannot be written. Throws Error
// naming the file that cannot be written.
CalibrationFiles write_calibration(const std::filesystem::path& out, const Calibration& calibration);

// The whole capture.json: see docs/capture.md.
nlohmann::json to_json(const Calibration& calibration);

// Each ball under all lights at once (the brightest of all photographs), lightened, for the page.
Image<Rgb> ball_picture(const FoundBall& ball);

// The page: one file, no script, no network. `ball_urls` are the balls' pictures, data: or a path. Whatever
// names contain, they stay text.
std::string calibration_page(const Calibration& calibration, const std::vector<std::string>& ball_urls);

}  // namespace tangi
