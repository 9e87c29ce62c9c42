// brackets.h: which photographs show the same light at several exposures.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/photo/development.h"

namespace tangi {

struct BracketFile {
    std::filesystem::path path;
    std::optional<double>
        exposure{};  // light on the sensor, in any unit that is the same for all; EXIF where empty
};

// Name of a light, as the lights file has it -> its photographs.
using Brackets = std::map<std::string, std::vector<BracketFile>>;

// A JSON file: {"NAME": ["FILE", {"file": "FILE", "exposure": NUMBER}, …], …}, NAME as in the lights file,
// FILE in `folder`, as photo_names.h finds it; lights that are not in it have one photograph as usual. Throws
// Error naming the file and the light: no JSON of that form, a photograph that is missing, an exposure that
// is not positive.
Brackets read_brackets(const std::filesystem::path& file, const std::filesystem::path& folder);

// Photographs NAME_1, NAME_2 … or NAME-1, NAME-2 … (any digits) for a light NAME, whose own extension, if it
// has one, does not count; case does not matter. Lights with fewer than two of them are left out.
Brackets find_brackets(const std::vector<std::filesystem::path>& photos,
                       const std::vector<std::string>& lights);

// Exposures as the files give them, or EXIF where none of the light's does, ascending, not yet relative to
// anything. Throws Error naming the file where neither tells, or two are the same.
std::vector<Exposure> exposures_of(const std::string& light, const std::vector<BracketFile>& files);

}  // namespace tangi
