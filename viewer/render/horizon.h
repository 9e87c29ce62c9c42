// horizon.h: how high the relief stands around each place, for cast shadows that keep up with the hand.
//
// Max 1988, "Horizon mapping": for each place and 16 azimuths, the elevation of the horizon. A shader looks
// one up instead of marching over the heights for every light.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/base/progress.h"
#include "surface/image/image.h"

namespace tangi {

struct HorizonMap {
    static constexpr int kAzimuths = 16;  // counter-clockwise from x, 22.5 degrees apart

    int width = 0, height = 0;
    // [azimuth][row][column]: elevation = (value / 255)^2 * 90 degrees, 0 where nothing stands in the way.
    std::vector<std::uint8_t> values;

    double elevation_deg(int x, int y, int azimuth) const;
};

// Mean heights of squares of pixels, such that no side has more than `largest_side`.
struct CoarseHeights {
    Image<float> height_mm;
    double mm_per_texel = 1;
};
CoarseHeights coarse_heights(const Image<float>& height_mm, double mm_per_pixel, int largest_side = 1024);

// The horizon towards one azimuth, between the two nearest of the map: square roots of the elevation over 90
// degrees [1], of which 65535 stands for 1; width x height of them, row by row.
void horizon_towards(const HorizonMap& map, double azimuth_deg, std::span<std::uint16_t> roots);

HorizonMap horizon_map(const CoarseHeights& heights, const Progress& progress = {});

}  // namespace tangi
