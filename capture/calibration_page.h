// calibration_page.h: a light calibration as files: lights.lp, capture.json for programs, capture.html for
// people.
#pragma once

#include <filesystem>

#include "capture/ball_calibration.h"
#include "capture/colour_calibration.h"

namespace tangi {

struct CalibrationFiles {
    std::filesystem::path lights, json, page;
};

// Where write_calibration() writes: the lights file, and capture.json and capture.html beside it.
CalibrationFiles calibration_files(const std::filesystem::path& lights);

// Each file appears whole or not at all, the lights file last. Throws Error naming the file that cannot be
// written.
// `section` is HTML that the page shows after its lights.
CalibrationFiles write_calibration(const std::filesystem::path& lights, const BallCalibration& calibration,
                                   const std::optional<ColourCalibration>& colours = {},
                                   const std::string& section = {});

// A picture, 0..1, as the page takes it: data:image/jpeg. `scratch` is beside which file it may be written
// for a moment.
std::string picture_url(const Image<Rgb>& picture, const std::filesystem::path& scratch);

// Each ball under all lights at once (the brightest of all photographs), lightened, for the page.
Image<Rgb> ball_picture(const FoundBall& ball);

// The page: one file, no script, no network. `ball_urls` are the balls' pictures, data: or a path. Whatever
// names contain, they stay text.
std::string calibration_page(const BallCalibration& calibration, const std::vector<std::string>& ball_urls,
                             const std::optional<ColourCalibration>& colours = {},
                             const std::string& section = {});

}  // namespace tangi
