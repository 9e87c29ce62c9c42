// texels.h: a surface as textures hold it: all maps of a pixel in 128 bits, in levels of detail cut into
// tiles.
//
// A texel is four words; unit values are scaled to the whole range of their bits:
//   x  normal: u, v (16 bits each) of an octahedron's upper half (Cigolle et al. 2014): p = n.xy / (|n.x| +
//      |n.y| + |n.z|), u = p.x + p.y, v = p.x - p.y, from -1..1
//   y  rho_d: sqrt(R / diffuse_max) 11 bits, G 11 bits, B 10 bits
//   z  sqrt(rho_s / specular_max) 16 bits; (log2(alpha) + 14) / 20 16 bits
//   w  confidence 8 bits; (height - height_min) / (height_max - height_min) 24 bits
// and where lobes have colours:
//   z  sqrt(rho_s / specular_max) 12 bits; (log2(alpha) + 14) / 20 13 bits; the lobe's colour in the channel
//      after its largest 7 bits
//   w  confidence 6 bits; the largest channel 2 bits; the colour in the channel before it 7 bits; height 17
//   bits
// and where lobes are anisotropic (whether or not they have colours):
//   x  normal: u 13 bits, v 12 bits; the lobe's colour in the channel before its largest 7 bits
//   y  rho_d: 10, 10 and 9 bits; confidence 3 bits
//   z  sqrt(rho_s / specular_max) 11 bits; (log2(alpha) + 14) / 20 12 bits; the colour in the channel after
//      the largest 7 bits; the largest channel 2 bits
//   w  stretch (anisotropy.h): x, y, code 127 is 0, 0 and 254 are -1 and 1, 8 bits each; height 16 bits
//
// Levels of detail keep gloss, as MeanMaterial does (surface/maps/material.h).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "surface/file/scratch_memory.h"
#include "surface/maps/material.h"
#include "surface/maps/surface.h"

namespace tangi {

using Texel = std::array<std::uint32_t, 4>;

// What the largest codes stand for.
struct TexelRange {
    float diffuse_max = 1, specular_max = 0.25f;
    float height_min_mm = 0, height_max_mm = 1;
    bool coloured_specular = false;     // texels have colours of lobes
    bool anisotropic_specular = false;  // ... and stretches as well
};

// Of this surface, with room for paint of `paint_mm` on it.
TexelRange range_of(const Surface& surface, float paint_mm = 0);

Texel pack(const Material& material, const TexelRange& range);
Material unpack(const Texel& texel, const TexelRange& range);

constexpr int kTileBits = 8;  // tiles have 256 texels a side
constexpr int kTileSide = 1 << kTileBits;
constexpr std::size_t kTileTexels = std::size_t(1) << (2 * kTileBits);

// [texels] of a level of detail, whose texels have 2^level pixels a side.
struct LevelSize {
    int width = 0, height = 0;
    int columns() const { return (width + kTileSide - 1) >> kTileBits; }
    int rows() const { return (height + kTileSide - 1) >> kTileBits; }
};
LevelSize level_size(int width, int height, int level);
// Levels of a painting of so many pixels: the last has 16 texels a side at most, in one tile.
int level_count(int width, int height);

struct TileName {
    int level = 0, column = 0, row = 0;
    bool operator==(const TileName&) const = default;
};

// All texels of a surface, ready to be uploaded; those beyond the picture's border are 0. One thread may
// update them while others read tiles under the lock.
class TexelTiles {
public:
    TexelTiles(const Surface& surface, const TexelRange& range);
    // Of a surface of this size: all are 0 until they are updated.
    TexelTiles(int width, int height, const TexelRange& range);

    int width() const { return width_; }
    int height() const { return height_; }
    int levels() const { return static_cast<int>(first_.size()); }
    const TexelRange& range() const { return range_; }

    // Row-major, 256 a side.
    std::span<const Texel> tile(const TileName& name) const;
    const Texel& at(int x, int y, int level = 0) const;
    std::unique_lock<std::mutex> lock() const { return std::unique_lock(mutex_); }

    // Packs these pixels again, and what holds them of all levels above.
    void update(const Surface& surface, const Region& region);
    // The same of a surface that shows this region only, which is within the picture.
    void update_part(const Surface& part, const Region& region);

    // The texels of a level that hold these pixels, as far as there are such.
    Region region_at(int level, const Region& region) const;

private:
    std::size_t offset(int x, int y, int level) const;
    template <class MaterialAt>
    void update(const Region& region, const MaterialAt& material);
    template <class Make>
    void make(int level, const Region& texels, const Make& make);

    int width_ = 0, height_ = 0;
    TexelRange range_;
    std::vector<std::size_t> first_;  // tile of each level
    ScratchMemory memory_;  // 21 bytes a pixel: of large paintings, on disk as far as there is no room
    std::span<Texel> texels_;
    mutable std::mutex mutex_;
};

}  // namespace tangi
