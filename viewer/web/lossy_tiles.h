// lossy_tiles.h: texels of a web page as JPEG pictures, in a tenth of the bytes, and what that costs.
//
// A tile: for each grey field (web_tiles.h) in turn two numbers, the lowest and the highest code in this
// tile. Then three pieces of bytes, each after the number of its bytes: a JPEG picture of the colour fields,
// where 255 is the largest code; one of the grey fields, one below the other, where 0 and 255 are lowest and
// highest, each as high as the tile, up to a multiple of 8 rows; and the zlib stream of the exact fields, as
// web_tiles.h describes it. Numbers have 32 bits, the lowest byte first.
//
// The grey range is that of each tile, so heights and slopes are as fine as they are low.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "surface/maps/light.h"
#include "viewer/render/horizon.h"
#include "viewer/render/texels.h"

namespace tangi {

std::string lossy_tile(const TexelTiles& tiles, const TileName& name, int quality);

// A JPEG picture of the slices, one below the other.
std::string lossy_horizon(const HorizonMap& map, int quality);

// Of relit pictures, sRGB-encoded and clamped to 0..1, against those of the texels as they were; and of
// heights.
struct LossyError {
    double squared = 0, height_squared = 0;
    std::size_t values = 0, heights = 0;
    LossyError& operator+=(const LossyError& other);
    double psnr_db() const;
    double height_rms() const;  // [the surface's unit of height]
};

// Of a tile of the finest level that was packed so, relit by each of these lights. `surface`: whose laws of
// reflection they are.
LossyError error_of(const std::string& packed, const Surface& surface, const TexelTiles& tiles,
                    const TileName& name, std::span<const Light> lights);

constexpr int kBestQuality = 98;

// The lowest quality, of JPEG, by which a sample of the tiles is relit as well as that; kBestQuality where
// none does.
int quality_for(double psnr_db, const Surface& surface, const TexelTiles& tiles,
                std::span<const Light> lights);

}  // namespace tangi
