// tiles_reader.h: a painting that is a folder of tiles (painting_tiles.h), read.
#pragma once

#include <list>
#include <mutex>

#include "surface/painting_file/dry_part.h"
#include "surface/painting_file/painting_reader.h"
#include "surface/painting_file/painting_tiles.h"
#include "surface/painting_file/tiles_description.h"

namespace tangi {

// All of a tile, whose checksum is looked at, and compared with `hash` where that is not empty. Throws Error
// naming the tile and the remedy: missing, damaged, of another size or another painting.
Surface read_tile(const std::filesystem::path& folder, const TileGrid& grid, const PaintingTile& tile,
                  const std::string& hash = {});

// Planes of a part of a tile, of its channels in their order; empty where the tile has none of it. Throws
// Error likewise.
std::vector<Image<float>> read_part_of_tile(const std::filesystem::path& folder, const TileGrid& grid,
                                            const PaintingTile& tile, const PartInfo& part);

// read_painting_part() of a folder of tiles.
void read_part_of_tiles(const std::filesystem::path& folder, const PartInfo& part,
                        const std::function<void(int y0, int y1, std::span<const float* const> planes)>& take,
                        const Progress& progress);

// Rows of a painting in their whole width, from top to bottom: the tiles beside each other are held open, and
// no more of them is unpacked. Not checked by their checksums.
class TileRows {
public:
    TileRows(std::filesystem::path folder, const TileGrid& grid, const PaintingHeader& header);

    Surface read(int y0, int y1);

private:
    void open(int row);
    void read(int y0, int y1, Surface& into, int top);

    std::filesystem::path folder_;
    TileGrid grid_;
    PaintingHeader header_;
    int row_ = -1;
    std::vector<DryPart> open_;
};

class TilesReader : public PaintingReader {
public:
    TilesReader(const std::filesystem::path& folder, std::size_t cache_bytes);

    Surface read(const Region& region, int level) const override;
    Image<float> read_heights(const Region& region, int level) const override;
    Surface read_rows(int y0, int y1) const override;
    std::vector<Image<float>> read_part(const PartInfo& part, const Region& region) const override;
    std::vector<HeightRange> height_ranges() const override { return description_.heights; }
    std::vector<Region> blocks() const override;

    const TileGrid& grid() const { return grid_; }
    const std::string& made_of() const { return description_.made_of; }

private:
    using Tile = std::shared_ptr<const Surface>;
    using Heights = std::shared_ptr<const Image<float>>;
    // What was used last, first.
    template <class Value>
    struct Kept {
        std::list<std::pair<PaintingTile, Value>> list;
        std::size_t most = 1;
    };
    template <class Value, class Make>
    Value kept(Kept<Value>& cache, const PaintingTile& tile, const Make& make) const;
    Tile tile(const PaintingTile& tile) const;
    Heights heights(const PaintingTile& tile) const;

    TilesDescription description_;
    TileGrid grid_;
    mutable std::mutex mutex_;
    mutable Kept<Tile> tiles_;
    mutable Kept<Heights> heights_;
    mutable TileRows rows_;
};

}  // namespace tangi
