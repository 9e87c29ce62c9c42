// reflectance_file.h: measured reflectances, as spectrophotometers export them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "paint/optics/spectrum.h"

namespace tangi {

// A reflectance (0..1, without the specular reflection) at the 12 bands, interpolated linearly: of a text
// file with a wavelength [nm] and a reflectance a line, separated by a comma, semicolon, tab or spaces. Lines
// that are empty or begin with '#', and a first line of words, do not count. Throws Error naming file and
// line: no numbers, wavelengths that do not increase, lie more than 50 nm apart or leave out 410 to 680 nm,
// reflectances outside of [0, 1].
Spectrum read_reflectance(const std::filesystem::path& path);
Spectrum parse_reflectance(std::string_view text, const std::string& where);

}  // namespace tangi
