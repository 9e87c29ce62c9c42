// best_marker_photo.h: the photograph of a stack that shows its ArUco markers best.
#pragma once

#include <cstddef>

#include "capture/geometry/markers.h"
#include "capture/stack/photo_set.h"

namespace tangi {

struct MarkedPhoto {
    MarkerSearch markers;
    std::size_t photo = 0;
};

// That with the most markers of the brightest few; of all where these show none. Texture can look like one of
// the smaller markers, but not twice at one place: of several photographs two must show a marker. Photographs
// are decoded by `transfer`. Throws Error where there are none, naming another dictionary that is there, and
// for a dictionary that is none.
MarkedPhoto find_marked_photo(const PhotoSet& photos, const Transfer& transfer,
                              const std::optional<std::string>& dictionary, const Progress& progress);

}  // namespace tangi
