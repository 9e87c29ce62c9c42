// surface_part.h: parts of maps and of surfaces.
#pragma once

#include <algorithm>
#include <glm/vec2.hpp>

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

// A pixel of a surface, in the painting that it is a part of; and that painting's size.
inline glm::ivec2 in_painting(const Surface& surface, int x, int y) {
    return surface.part_of ? glm::ivec2(x + surface.part_of->left, y + surface.part_of->top)
                           : glm::ivec2(x, y);
}
inline glm::ivec2 painting_size(const Surface& surface) {
    return surface.part_of ? glm::ivec2(surface.part_of->width, surface.part_of->height)
                           : glm::ivec2(surface.width(), surface.height());
}

template <class T>
void paste(const Image<T>& from, const Region& region, Image<T>& into, int x, int y) {
    if (into.empty() || from.empty()) return;
    for (int row = 0; row < region.height(); ++row)
        std::copy_n(from.row(region.y0 + row).begin() + region.x0, region.width(),
                    into.row(y + row).begin() + x);
}

// All maps within the part, with the law and the scale; it has no photographs and no provenance, and its
// frame has its origin in its own middle.
Surface cut(const Surface& surface, const Region& part);

// All maps of `part` to where (x, y) of `into` is, which has the same maps and room for them.
void paste(const Surface& part, Surface& into, int x, int y);
// Those within a region of `from` only.
void paste(const Surface& from, const Region& region, Surface& into, int x, int y);

}  // namespace tangi
