// painting_reader.h: any rectangle of a painting at any level of detail, from a painting file or from a
// folder of tiles (painting_tiles.h) alike: what is larger than memory is looked at through this.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "surface/maps/surface.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

// What a painting says of itself, without its maps.
struct PaintingHeader {
    int width = 0, height = 0;                                // [pixels]
    bool has_specular_colour = false, has_lobe_axes = false;  // maps that not all paintings have
    ReflectanceModel reflectance_model;
    double mm_per_pixel = 1;  // [mm]
    bool scale_known = false;
    Photography photography;
    std::string provenance;       // JSON
    std::string dry_hash;         // of all pixels (painting_file.h); empty where that is not stored
    std::vector<PartInfo> parts;  // beside `dry` (painting_parts.h)
};

// Of a surface that is in memory, without a hash and parts.
PaintingHeader header_of(const Surface& surface);
// Its numbers and words into a surface, whose maps stay what they are.
void describe(const PaintingHeader& header, Surface& surface);

// Flat and not measured, with the maps that the painting has.
Surface blank_surface(const PaintingHeader& header, int width, int height);

// Pixels of a level of detail: those of level 0 are the painting's, one of level l stands for 2^l x 2^l.
struct LevelExtent {
    int width = 0, height = 0;
    Region region() const { return {0, 0, width, height}; }
};
LevelExtent level_extent(int width, int height, int level);

// [mm]
struct HeightRange {
    float lowest = 0, highest = 0;
};
HeightRange height_range(const Image<float>& height_mm, const Region& region);

// Safe for several threads. What it hands out is checked as read_painting() checks it, and tiles by their
// checksums: a method throws Error that names the file and what to do about it.
class PaintingReader {
public:
    virtual ~PaintingReader() = default;
    PaintingReader(const PaintingReader&) = delete;
    PaintingReader& operator=(const PaintingReader&) = delete;

    const std::filesystem::path& path() const { return path_; }
    const PaintingHeader& header() const { return header_; }
    int width() const { return header_.width; }
    int height() const { return header_.height; }
    // The coarsest level has 1024 pixels a side at most.
    int levels() const;
    LevelExtent extent(int level) const { return level_extent(width(), height(), level); }

    // All maps of a rectangle, in pixels of the level and within it: with the numbers and words of the header
    // but for mm_per_pixel, which is of the level's pixels, and its place in the painting (Surface::part_of),
    // so that it is lit as that part of the whole. Levels from 1 on are means, as MeanMaterial has them
    // (surface/maps/material.h).
    virtual Surface read(const Region& region, int level = 0) const = 0;
    // [mm] Its heights alone, of which many more are kept in memory: for shadows that come from afar.
    virtual Image<float> read_heights(const Region& region, int level = 0) const = 0;
    // All maps of rows of the painting in their whole width, for who goes over them from top to bottom, in
    // one thread: no other rows are unpacked for them, and tiles are not checked by their checksums.
    virtual Surface read_rows(int y0, int y1) const { return read({0, y0, width(), y1}); }
    // Channels of a part that has the painting's size, of a rectangle: plane [channel], row by row.
    virtual std::vector<Image<float>> read_part(const PartInfo& part, const Region& region) const = 0;

    // [mm] The lowest and the highest height in each of blocks(): how far shadows may reach.
    virtual std::vector<HeightRange> height_ranges() const = 0;
    // In which rectangles of level 0 it is read fastest, each pixel once, row by row of them: those of the
    // tiles, or of bands of rows. What goes over a whole painting takes these.
    virtual std::vector<Region> blocks() const = 0;

protected:
    PaintingReader(std::filesystem::path path, PaintingHeader header)
        : path_(std::move(path)), header_(std::move(header)) {}
    // For read(): its maps are those of nothing.
    Surface blank(const Region& region, int level) const;

    std::filesystem::path path_;
    PaintingHeader header_;
};

// [bytes] of unpacked pixels that a reader keeps, beside what it hands out.
constexpr std::size_t kReaderCache = std::size_t(512) << 20;

// Of a painting file, or of a folder of tiles. Reads headers only. Throws Error as read_painting() does, and
// of a folder: it is not finished, painting.json is missing or damaged.
std::shared_ptr<const PaintingReader> open_painting(const std::filesystem::path& path,
                                                    std::size_t cache_bytes = kReaderCache);

// Of a surface that is in memory, as what takes readers wants it; `path` is what its Errors name.
std::shared_ptr<const PaintingReader> reader_of(std::shared_ptr<const Surface> surface,
                                                std::filesystem::path path = {});

}  // namespace tangi
