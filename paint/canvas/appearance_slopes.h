// appearance_slopes.h: the normals of a painted canvas (appearance.h): slopes of what is dry and of paint
// add.
#pragma once

#include <vector>

#include "paint/canvas/canvas.h"
#include "surface/maps/surface.h"

namespace tangi {

constexpr int kSlopesReach = 2;  // [pixels] that slopes look beyond a pixel

inline Region grown(const Region& r) {
    return {r.x0 - kSlopesReach, r.y0 - kSlopesReach, r.x1 + kSlopesReach, r.y1 + kSlopesReach};
}

// A surface that shows a part of the canvas.
struct Shown {
    Surface& surface;
    Region part;

    template <class T>
    T& at(Image<T> Surface::*map, int x, int y) const {
        return (surface.*map)(x - part.x0, y - part.y0);
    }
};

// Normals in a region of the canvas that is shown; `layers`: all paint, from the bottom up.
void update_normals(const Canvas& canvas, const std::vector<const PaintLayer*>& layers, const Region& region,
                    const Shown& shown);

}  // namespace tangi
