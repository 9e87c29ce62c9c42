// profile_colours.h: what the ICC profiles of photographs say about their primaries.
#pragma once

#include <optional>
#include <string_view>

#include "capture/formats/capture_colour.h"
#include "capture/stack/stack.h"

namespace tangi {

// Linear Rec. 709 -> linear red, green and blue of a profile, white to white: from its colorants (ICC.1:2010,
// 9.2, r/g/bXYZ, relative to D50). Empty where it has none, or they are Rec. 709's within 2 % of white.
std::optional<glm::dmat3> to_camera_of_icc(std::string_view profile);

// The colours of photographs whose profiles, once related (photo_profiles.h), all have the same primaries,
// other than Rec. 709's: Adobe RGB,
// Display P3, eciRGB, ProPhoto RGB. Empty for grey photographs, camera raw, and what says nothing. Reads the
// headers of the photographs.
std::optional<CaptureColour> colour_of_profiles(const Stack& stack);

}  // namespace tangi
