// plane_calibration.h: the painting's plane in a stack's photographs: its scale, the lens, and what makes
// upright pictures of them.
//
// What tells it: a scale bar, the resolution, ArUco markers, the painting's corners and size, the pitch of a
// colour chart, the painting itself as it was fitted before. All lie in the painting's plane. Pixels and the
// plane's frame are those of scale.h.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/colour_chart/colour_calibration.h"
#include "capture/formats/picture_geometry.h"
#include "capture/geometry/align_to_reference.h"
#include "capture/geometry/markers.h"
#include "surface/base/progress.h"

namespace tangi {

struct ScaleBar {
    glm::dvec2 first_px{0}, last_px{0};
    double length_mm = 0;
};

struct PlaneOptions {
    std::optional<ScaleBar> bar{};
    std::optional<double> pixels_per_inch{};
    std::optional<double> marker_mm{};        // side of the markers; they are not looked for where empty
    std::optional<std::string> dictionary{};  // of the markers; found out where empty
    std::optional<Corners> corners_px{};      // of the painting
    std::optional<glm::dvec2> painting_mm{};  // its width and height
    bool rectify = false;
    std::optional<EarlierPainting> earlier{};  // what the picture is to lie on, pixel by pixel
    std::optional<std::filesystem::path> lens{};
    std::optional<double> focal_px{};  // that of the lens where empty
    std::optional<glm::dvec2> principal_px{};
    std::optional<Transfer> transfer{};  // how photographs are decoded to look for markers; sRGB where empty

    bool asks_anything() const {
        return bar || pixels_per_inch || marker_mm || corners_px || rectify || earlier || lens;
    }
};

struct PlaneCalibration {
    int width = 0, height = 0;  // [px] of the photographs
    MarkerSearch markers;
    std::string markers_in;  // name of the photograph
    double marker_residual_px = 0;
    std::optional<FoundPainting> earlier{};
    std::vector<Scale> scales;  // all that was told; the first is the one used: the most certain of those
                                // that most others agree with
    std::optional<PictureGeometry> geometry{};
    std::string rectified_by;          // "corners", "markers", "chart", "painting"; empty: not rectified
    std::optional<double> tilt_deg{};  // of the painting's plane against the camera's, where known
    double tilt_sigma_deg = 0;         // standard error
    double photo_outside = 0;          // [1] part of the photographs that is not in the picture
    double picture_outside = 0;        // [1] part of the picture that the photographs do not show
    std::optional<double> focal_px{};  // as given, or the lens's
    glm::dvec2 principal_px{0};
    std::vector<std::string> warnings;
    std::vector<std::string> poor;  // what was told contradicts itself, with the numbers

    std::optional<Scale> scale() const {
        return scales.empty() ? std::nullopt : std::optional(scales.front());
    }
};

// `chart`: what was found of a chart, or null. Throws Error: a lens file that is none, no marker where a side
// was given, markers of another dictionary, corners that make no painting, nothing to rectify by, a plane
// that is seen from too far aside.
PlaneCalibration calibrate_plane(const PhotoSet& photos, const PlaneOptions& options,
                                 const ColourCalibration* chart, const Progress& progress = {});

// For capture.json: see docs/reference/capture-json.md.
nlohmann::json to_json(const PlaneCalibration& plane);

}  // namespace tangi
