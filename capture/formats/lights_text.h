// lights_text.h: what stands in a lights file otherwise than as "name x y z", put that way.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "surface/maps/light.h"

namespace tangi {

struct LightsLine {
    int number = 0;    // in the file, from 1
    std::string text;  // trimmed, columns separated by blanks
};

// The lines of a lights file that hold something: without comments, which begin with # or ;, without a title
// line, and without columns after z where all lines have one or three more. Adds to
// `warnings` what was understood so.
std::vector<LightsLine> lines_of_lights(std::string text, const std::string& file_name,
                                        std::vector<std::string>& warnings);

// Components from 0 to 255, 65535 or 1, as normal maps store them, where that makes all of them unit vectors:
// puts them right, makes their lengths 1, and returns what to tell. Throws Error where they are azimuth and
// elevation. Else nothing. `vectors`: of the lights, as listed.
std::string decode_vectors(std::vector<glm::dvec3>& vectors, const std::string& file_name);

}  // namespace tangi
