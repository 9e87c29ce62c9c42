// texels.h: a surface as textures hold it: all maps of a pixel in 128 bits, in tiles with levels of detail.
//
// A texel is four words; unit values are scaled to the whole range of their bits:
//   x  normal: u, v (16 bits each) of an octahedron's upper half (Cigolle et al. 2014): p = n.xy / (|n.x| +
//      |n.y| + |n.z|), u = p.x + p.y, v = p.x - p.y, from -1..1
//   y  rho_d: sqrt(R / diffuse_max) 11 bits, G 11 bits, B 10 bits
//   z  sqrt(rho_s / specular_max) 16 bits; (log2(alpha) + 14) / 20 16 bits
//   w  confidence 8 bits; (height - height_min) / (height_max - height_min) 24 bits
//
// Levels of detail keep gloss (after Toksvig 2005 and Olano & Baker 2010, "LEAN mapping"): a texel of 2^l x
// 2^l pixels has their mean normal, and the spread of their slopes goes into its lobe: alpha is the rms
// slope, so alpha^2 = mean of (alpha^2 + slope^2) - slope of the mean^2, pixels weighted by rho_s. What a
// mean normal lacks in length goes into rho_d: uneven paint is a little darker from afar.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/surface.h"

namespace tangi {

using Texel = std::array<std::uint32_t, 4>;

// What the largest codes stand for.
struct TexelRange {
    float diffuse_max = 1, specular_max = 0.25f;
    float height_min_mm = 0, height_max_mm = 1;
};

// Of this surface, with room for paint of `paint_mm` on it.
TexelRange range_of(const Surface& surface, float paint_mm = 0);

// One pixel's maps, decoded.
struct Material {
    Vec3 normal{0, 0, 1};
    Rgb diffuse{0};
    float specular = 0, roughness = 1, height_mm = 0, confidence = 0;
};

Texel pack(const Material& material, const TexelRange& range);
Material unpack(const Texel& texel, const TexelRange& range);
Material material_at(const Surface& surface, int x, int y);

// All texels of a surface, in square tiles, ready to be uploaded: level l of a tile has (size >> l)^2 texels
// of 2^l pixels a side; those beyond the picture's border are 0.
class TexelTiles {
public:
    TexelTiles() = default;
    // `tile_bits`: tiles have 2^tile_bits pixels a side.
    TexelTiles(const Surface& surface, const TexelRange& range, int tile_bits);

    int width() const { return width_; }
    int height() const { return height_; }
    int tile_bits() const { return tile_bits_; }
    int columns() const { return columns_; }
    int rows() const { return rows_; }
    int count() const { return columns_ * rows_; }
    const TexelRange& range() const { return range_; }

    // Row-major, 2^(tile_bits - level) a side.
    std::span<const Texel> level(int tile, int level) const;
    const Texel& at(int x, int y, int level = 0) const;

    // Packs these pixels again, and all levels above them.
    void update(const Surface& surface, const Region& region);

    // The texels of a level that hold these pixels, clipped to one tile: region within the tile.
    Region region_in(int tile, int level, const Region& region) const;

private:
    std::size_t offset(int tile, int level) const;
    void make_level(int tile, int level, const Region& texels);

    int width_ = 0, height_ = 0, tile_bits_ = 0, columns_ = 0, rows_ = 0;
    TexelRange range_;
    std::size_t tile_texels_ = 0;
    std::vector<Texel> texels_;  // tile after tile, level after level
};

// The smallest tiles (2^7 at least) of which no more than `most` are needed. Throws Error for a picture
// larger than that with the largest tiles (2^max_bits).
int tile_bits_for(int width, int height, int most, int max_bits = 11);

}  // namespace tangi
