// painting_tiles.h: a painting as a folder of tiles, NAME.tangi/: what no memory holds as a whole is written
// tile by tile, in any order, by any number of processes, and goes on where a run was stopped.
//
//   painting.json       what the painting is, and the checksum of each tile; written last
//   LEVEL/COL_ROW.exr   tiles of 1024 x 1024 pixels (fewer at the right and lower border); level 0 is the
//                       painting, each further one has half the pixels a side
//
// Each tile is a painting file (painting_file.h) of its own, with the same channels, units and attributes;
// the hash of its part `dry` is its checksum, and other parts have theirs in the attribute `hash`. Parts that
// have a size of their own (a palette, a residual of blocks) are in the one tile of the coarsest level.
// docs/reference/formats.md has all.
//
// Until it is finished a painting is NAME.tangi.partial/, without painting.json; NAME.tangi is there as a
// whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surface/base/progress.h"
#include "surface/file/held_file.h"
#include "surface/maps/surface.h"
#include "surface/painting_file/painting_parts.h"
#include "surface/painting_file/painting_reader.h"

namespace tangi {

constexpr int kPaintingTile = 1024;  // [pixels] a side

struct PaintingTile {
    int level = 0, column = 0, row = 0;
    friend bool operator==(const PaintingTile&, const PaintingTile&) = default;
};

// Whether a path is a folder of tiles, finished or not, by its name or by what is in it; what is wrong with
// it is for open_painting() to say.
bool is_tiled_painting(const std::filesystem::path& path);
// Whether an output is to be one: its name ends in .tangi.
bool names_tiled_painting(const std::filesystem::path& path);

// How a painting is cut.
class TileGrid {
public:
    TileGrid(int width, int height);
    int width() const { return width_; }
    int height() const { return height_; }
    int levels() const;  // the coarsest has one tile
    int columns(int level = 0) const;
    int rows(int level = 0) const;
    int count(int level = 0) const { return columns(level) * rows(level); }
    PaintingTile tile(int number, int level = 0) const;  // row by row from 0
    // [pixels of the level]
    Region region(const PaintingTile& tile) const;

private:
    int width_, height_;
};

enum class TileState { missing, damaged, foreign, valid };  // foreign: of another painting or another run

// LEVEL/COL_ROW.exr in a folder.
std::filesystem::path file_of(const std::filesystem::path& folder, const PaintingTile& tile);

// Writes a painting. Any number of these, in any number of processes and machines that share the folder, may
// write to one painting at a time; tiles that two of them write at once come from one of them.
class PaintingTilesWriter {
public:
    // `made_of`: words that are the same if and only if all tiles would be (a hash of what they are made of,
    // with the options and the program's version). Tiles of other words count as missing. Makes
    // NAME.tangi.partial where it is not there. Throws Error naming the folder: it cannot be made, or
    // NAME.tangi is something else than a painting of tiles.
    PaintingTilesWriter(std::filesystem::path target, int width, int height, std::string made_of);

    // For who writes a whole painting by himself: waits, and says so, until nobody else does who took it, so
    // that neither takes tiles from under the other's hands. The last one's painting stays, as of files.
    // Throws Cancelled.
    static HeldFile claim(const std::filesystem::path& target, const Progress& progress = {});

    // Throws Error where the constructor would, but makes nothing.
    static void require_place(const std::filesystem::path& target);
    static std::filesystem::path partial_of(const std::filesystem::path& target);

    const TileGrid& grid() const { return grid_; }
    const std::filesystem::path& target() const { return target_; }
    const std::filesystem::path& partial() const { return partial_; }

    // One of level 0, whole or not at all: `surface` has the size of its region, and `parts` have, too; a
    // part that is 0 everywhere is left out. Of the surface's words (provenance, photographs) nothing is
    // stored: they are the whole painting's. Throws Error on a full disk, …
    void write(const PaintingTile& tile, Surface surface, std::span<const PartToWrite> parts = {});

    // The same, unless a sound tile of the same words is there that holds just these parts; for paintings
    // whose words tell the surface.
    void write_if_other(const PaintingTile& tile, Surface surface, std::span<const PartToWrite> sealed_parts);

    // What is there of a tile; all of it is read. A valid one of the finished painting of the same words
    // counts, and is taken over.
    TileState state(const PaintingTile& tile) const;
    // Numbers (TileGrid::tile()) of the tiles of level 0 that are still to be written.
    std::vector<int> missing(const Progress& progress = {}) const;

    // Makes the tiles of a coarser level from those of the level below, as far as they are not there; those
    // from `first` up to `end` only, so that several may share the work of a level.
    void reduce(int level, int first, int end, const Progress& progress = {});
    // All levels, then painting.json, then the place: NAME.tangi is the painting, and one that was there is
    // gone. Size and maps of `header` are taken from the tiles, as is dry_hash, and its parts say only in
    // which order the painting has them. `whole` are parts with a size of their own. Throws Error that names
    // the tiles which are missing or damaged, how many and which are first, and that running again makes
    // them.
    void finish(const PaintingHeader& header, std::span<const PartToWrite> whole = {},
                const Progress& progress = {});
    // The same but for the place: NAME.tangi.partial is all that NAME.tangi is to be.
    void complete(const PaintingHeader& header, std::span<const PartToWrite> whole = {},
                  const Progress& progress = {});

private:
    TileState state_in(const std::filesystem::path& folder, const PaintingTile& tile) const;
    void store(const PaintingTile& tile, Surface surface, std::span<const PartToWrite> parts);
    bool holds(const PaintingTile& tile, const Surface& surface, std::span<const PartToWrite> parts) const;
    void require_tiles(const Progress& progress) const;
    void add_whole_parts(std::span<const PartToWrite> whole);
    void put_in_place();

    std::filesystem::path target_, partial_;
    TileGrid grid_;
    std::string made_of_;
};

// The file that a painting is told apart by: itself; of a folder of tiles painting.json, which has the hash
// of each.
std::filesystem::path main_file_of(const std::filesystem::path& path);
// Its SHA-256.
std::string sha256_of_painting(const std::filesystem::path& path);

// A painting of any kind as a folder of tiles, with all its parts, block by block; goes on where it was
// stopped. And back.
void write_tiles(const PaintingReader& painting, const std::filesystem::path& target,
                 const Progress& progress = {});
void write_file(const PaintingReader& painting, const std::filesystem::path& target,
                const Progress& progress = {});

}  // namespace tangi
