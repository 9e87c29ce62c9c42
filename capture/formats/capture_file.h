// capture_file.h: capture.json, what `tangipaint calibrate` found, as a fit takes it
// (docs/reference/capture-json.md).
#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/formats/capture_colour.h"
#include "capture/formats/picture_geometry.h"
#include "surface/image/image.h"
#include "surface/maps/light.h"

namespace tangi {

// Lights and camera are in the frame of the photographs, as if the camera looked straight down on the
// painting, until in_picture() carries them into the one of the picture that is fitted.
struct CaptureFile {
    std::vector<Light> lights;  // those that were found, in the file's order; gains 1; positions all or none;
                                // none where no sphere was looked for
    // [deg] Standard error of the direction of each, where spheres tell it; else 0. Lights that were found
    // from the photographs alone have none: the same photographs can say nothing more of them.
    std::vector<double> direction_sigma_deg;
    int width = 0, height = 0;             // of the photographs
    glm::dvec2 origin_px{0};               // pixel of the photographs where x = y = 0
    std::optional<double> mm_per_pixel{};  // at z = 0
    std::optional<Vec3> camera_mm{};
    std::optional<CaptureColour> colour{};      // of a chart
    std::optional<PictureGeometry> geometry{};  // of a lens or a rectification
    std::vector<std::string> warnings;
    std::vector<std::string> poor;  // what calibrate called poor, for the user
};

struct CalibrationFiles {
    std::filesystem::path lights, json, page;
};

// Where `tangipaint calibrate` writes: three files of one name, so that a second calibration beside it
// replaces none of them. `out` is the lights file (.lp) or the capture file (.json); beside lights.lp the
// others are capture.json and capture.html.
CalibrationFiles calibration_files(const std::filesystem::path& out);

// Whether a lights file has the lights of the capture file beside it; false where one of them is none.
bool is_lights_file_of(const std::filesystem::path& lights, const std::filesystem::path& capture);

// Whether it is JSON that says that it is a capture file, of this version or a later one.
bool looks_like_capture(const std::string& text);

// Lights of which only the direction was found, among others with positions, are taken to be as far away as
// the others' median, with a warning. Throws Error naming the file and the field: not JSON, another file's
// JSON, a later format, a number that is missing or makes no sense.
CaptureFile read_capture_file(const std::filesystem::path& path);

// The same in the frame of the picture that its geometry makes of the photographs: size, origin (the
// picture's centre), scale, camera and lights. As it is where there is no geometry.
CaptureFile in_picture(const CaptureFile& capture);

// The same as seen by a part of the photographs: the origin moved to the centre of `crop`, and the strengths
// with it: lights of known positions are taken for one light that was carried around, so that its light at
// the origin falls with the square of the distance; the median gain is 1. Without a scale positions say
// nothing about a part, and only directions are left.
CaptureFile seen_from(const CaptureFile& capture, const Region& crop);

}  // namespace tangi
