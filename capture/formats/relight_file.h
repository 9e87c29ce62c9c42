// relight_file.h: .relight files, the projects of Relight: JSON with the photographs and what lit them.
//
//   images    [{filename, skip}]; those with skip own no light
//   dome      as in a .dome file (dome_file.h)
//   spheres   [{directions: [[x, y, z]]}] that mirror spheres showed, one for each photograph that is not
//   skipped;
//             [0, 0, 0] where none was found
//   pixelSize [mm] of a pixel of the photographs on the plane of the object; 0 where unknown
//
// (Relight of the CNR's Visual Computing Lab.) Lights are the dome's where it has any, else the mean
// directions of the spheres.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/maps/light.h"

namespace tangi {

struct RelightFile {
    std::vector<Light> lights;  // named as the project names its photographs; positions all or none
    std::optional<double> picture_width_mm{};
    std::optional<double> mm_per_pixel{};
    std::vector<std::string> warnings;  // photographs without a light, …
};

// Throws Error naming the file, and line or JSON path: not JSON, no photographs, no lights, more or fewer
// lights than photographs.
RelightFile read_relight_file(const std::filesystem::path& path);
RelightFile parse_relight(const std::string& text, const std::string& file_name);

// Whether it is JSON with photographs, and a dome or spheres.
bool looks_like_relight(const std::string& text);

}  // namespace tangi
