// lights_file.h: .lp files, the RTI community's lists of photographs and light directions.
//
//   <count>
//   <photograph's name> <x> <y> <z>      one line a photograph; x right, y up, z towards the camera
//
// As found in the wild: names hold spaces and folders, vectors are not of unit length, blank and trailing
// lines, tabs, CRLF or CR, a byte-order mark, decimal commas, a count that is wrong or missing, comments (#
// or
// ;), names in Latin-1, columns separated by commas or semicolons, further columns (an intensity, a colour)
// after z, components from 0 to 255 or 0 to 1 as normal maps store them. All of that is read. Some hold
// positions instead of directions, in whatever unit.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "capture/photo/rejected_photo.h"
#include "surface/maps/light.h"

namespace tangi {

// [1] Distance of unit vectors that are one direction: 0.06 degrees.
constexpr float kSameDirection = 1e-3f;

struct LightsFile {
    std::vector<Light> lights;          // in the file's order; directions are unit vectors, gains 1
    std::vector<std::string> warnings;  // a count that disagrees with the lines, …
    std::vector<double> lengths{};      // of the vectors: distances, where these are positions
    int decimals = 0;                   // most that a component is given with
    std::vector<RejectedPhoto>
        rejected{};  // lines that are no light, told in the warnings too; names may be empty
};

// Lines without a name or three numbers, with a zero vector or NaN, and names that occur twice with different
// vectors are left out, each with a warning that names the line. Throws Error naming file and line where they
// are a third of all or more; not a lights file, no lights, azimuth and elevation instead of x, y and z.
LightsFile read_lights_file(const std::filesystem::path& path);
LightsFile parse_lights(const std::string& text, const std::string& file_name);

// Whether parse_lights() would take it.
bool looks_like_lights(const std::string& text);

// A lights file of unit directions, 6 decimals.
std::string lights_text(std::span<const Light> lights);

// Writes it, whole or not at all.
void write_lights_file(const std::filesystem::path& path, std::span<const Light> lights);

}  // namespace tangi
