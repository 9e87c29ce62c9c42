// lights_to_relight.h: the lights of `relight --lights`, and the pictures that are called after them.
#pragma once

#include <filesystem>
#include <vector>

#include "capture/formats/lights_format.h"

namespace tangi {

// Of a lights file of any format; of a capture file in the frame of the picture that it describes. Throws
// Error where there is none, or one without the name of its photograph.
LightList lights_in(const std::filesystem::path& path);

// FOLDER/STEM.png of each light, by its photograph's name. Throws Error where two are called the same, or
// where one would overwrite one of `inputs` or a photograph of the lights.
std::vector<std::filesystem::path> pictures_of(const std::vector<Light>& lights,
                                               const std::filesystem::path& lights_file,
                                               const std::filesystem::path& folder,
                                               const std::vector<std::filesystem::path>& inputs);

}  // namespace tangi
