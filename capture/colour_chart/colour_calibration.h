// colour_calibration.h: the colours of a stack from the colour chart in its photographs.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/colour_chart/chart_colour.h"
#include "capture/colour_chart/colour_tolerance.h"
#include "capture/radiometry/white_balances.h"
#include "capture/stack/photo_set.h"
#include "surface/base/progress.h"
#include "surface/image/colour.h"

namespace tangi {

struct ColourCalibrationOptions {
    std::optional<ChartCorners> corners_px{};          // sought where empty
    std::optional<std::filesystem::path> reference{};  // the classic chart where empty
    std::optional<Transfer>
        transfer{};  // where empty, that of linear, sRGB and gamma 2.2 which fits the chart best
    std::optional<double> pitch_mm{};  // from one patch's middle to the next
    int most_photos = 24;              // that are read; spread over the stack where there are more
};

struct ColourCalibration {
    FoundChart chart;
    std::string found_in;             // name of the photograph
    std::vector<std::string> photos;  // that were read
    Transfer transfer;
    std::string transfer_source;  // "given", "chart"
    ChartReference reference;
    ColourCorrection correction;   // of photographs whose white balance is undone where it differs
    WhiteBalances white_balances;  // of `photos`
    std::vector<ToleranceResult> tolerances;
    std::optional<Scale> scale{};  // at the chart, where the pitch is known
    std::vector<std::string> warnings;
};

// Looks for the chart in the brightest photographs, then reads it in all of them (one in memory at a time) at
// the same place. Nothing where there is no chart and none was said to be there. Throws Error: corners that
// hold no chart, a damaged photograph or reference file.
std::optional<ColourCalibration> calibrate_colours(const PhotoSet& photos,
                                                   const ColourCalibrationOptions& options,
                                                   const Progress& progress = {});

// For capture.json: see docs/reference/capture-json.md.
nlohmann::json to_json(const ColourCalibration& calibration);

// The part of the calibration's page that is about colour: swatches and tables, as HTML.
std::string colour_section(const ColourCalibration& calibration);

}  // namespace tangi
