// dome_file.h: .dome files, in which Relight keeps the lights of an RTI dome: JSON with
//
//   lightConfiguration   "directional", "spherical" or "lights3d"; directional where missing
//   directions           [{x, y, z}] towards the lights; x right, y up, z towards the camera
//   positionsSphere      [{x, y, z}] [mm] of lights on the dome; older files: positions
//   positions3d          [{x, y, z}] [mm] of lights anywhere
//   imageWidth           [mm] of the photographs on the plane of the object; 0 where unknown
//   domeDiameter, verticalOffset [mm]: a light on the dome is at direction * diameter / 2, lifted by the
//   offset
//
// (Relight of the CNR's Visual Computing Lab, as its versions of 2021 to 2025 write it.) Names of photographs
// are not in it: lights are in the order of the photographs. Factors of colour (ledAdjust) are not read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/formats/json_field.h"
#include "surface/maps/light.h"

namespace tangi {

struct DomeFile {
    std::vector<Light> lights;  // without names, in the file's order; positions all or none
    std::optional<double> picture_width_mm{};
    std::vector<std::string> warnings;
};

// Throws Error naming the file, and line or JSON path: not JSON, no lights, a vector that is zero, not finite
// or incomplete. Positions whose scale is unknown (imageWidth) are read as directions, with a warning.
DomeFile read_dome_file(const std::filesystem::path& path);
DomeFile parse_dome(const std::string& text, const std::string& file_name);

// Whether it is JSON with vectors of a dome; else parse_dome() would have none.
bool looks_like_dome(const std::string& text);

// The same of the dome in another file; no lights at all are no error here.
DomeFile dome_in(const JsonField& dome);

}  // namespace tangi
