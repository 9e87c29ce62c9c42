// surface_part.h: parts of maps and of surfaces.
#pragma once

#include <algorithm>

#include "surface/maps/surface.h"

namespace tangi {

// The pixels of a map within a part of it; empty where the map is.
template <class T>
Image<T> cut(const Image<T>& map, const Region& part) {
    if (map.empty()) return {};
    Image<T> result(part.width(), part.height());
    for (int y = 0; y < part.height(); ++y)
        std::copy_n(map.row(part.y0 + y).begin() + part.x0, part.width(), result.row(y).begin());
    return result;
}

// All maps within the part, with the law and the scale; it has no photographs and no provenance, and its
// frame has its origin in its own middle.
Surface cut(const Surface& surface, const Region& part);

}  // namespace tangi
