#include "surface/painting_file/tiles_reader.h"

#include <algorithm>

#include "surface/base/error.h"
#include "surface/base/parallel.h"
#include "surface/maps/surface_part.h"
#include "surface/painting_file/painting_file.h"
#include "surface/painting_file/surface_channels.h"
#include "surface/painting_file/tile_parts.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTileRemedy =
    "make the painting again with the same command, which makes what is missing or damaged and keeps the "
    "other "
    "tiles; or copy this one again";

// Reads a tile; what is wrong with it is told with the remedy of tiles.
template <class Read>
auto reading_tile(const fs::path& file, const Read& read) {
    std::error_code unreadable;
    if (!fs::exists(file, unreadable)) fail("{}: this tile is missing; {}", file.string(), kTileRemedy);
    try {
        return read();
    } catch (const Error& error) {
        fail("{}. A tile of a painting: {}", error.what(), kTileRemedy);
    }
}

// Calls visit(tile, the part of its pixels that lies in the region, in pixels of the level).
template <class Visit>
void for_each_tile(const TileGrid& grid, const Region& region, int level, const Visit& visit) {
    for (int row = region.y0 / kPaintingTile; row * kPaintingTile < region.y1; ++row)
        for (int column = region.x0 / kPaintingTile; column * kPaintingTile < region.x1; ++column) {
            const PaintingTile tile{level, column, row};
            const Region all = grid.region(tile);
            visit(tile, all,
                  Region{std::max(all.x0, region.x0), std::max(all.y0, region.y0),
                         std::min(all.x1, region.x1), std::min(all.y1, region.y1)});
        }
}

Region within(const Region& part, const Region& whole) {
    return {part.x0 - whole.x0, part.y0 - whole.y0, part.x1 - whole.x0, part.y1 - whole.y0};
}

TilesDescription description_at(const fs::path& folder) {
    if (fs::exists(folder)) return read_tiles_description(folder);
    fs::path partial = folder;
    partial += ".partial";
    if (fs::exists(partial))
        fail(
            "{}: is not finished yet: {} holds what there is of it; run the command that makes it again, "
            "which goes on there",
            folder.string(), partial.string());
    fail("{}: no such file or folder", folder.string());
}

}  // namespace

Surface read_tile(const fs::path& folder, const TileGrid& grid, const PaintingTile& tile,
                  const std::string& hash) {
    const fs::path file = file_of(folder, tile);
    const Region region = grid.region(tile);
    return reading_tile(file, [&] {
        Surface surface = read_painting(file);
        if (surface.width() != region.width() || surface.height() != region.height())
            fail("{}: is {} x {} pixels, and should be {} x {}", file.string(), surface.width(),
                 surface.height(), region.width(), region.height());
        if (!hash.empty())
            if (const std::string found = hash_of(surface); found != hash)
                fail("{}: is not the tile that the painting was finished with (hash {} expected, {} found)",
                     file.string(), hash, found);
        return surface;
    });
}

std::vector<Image<float>> read_part_of_tile(const fs::path& folder, const TileGrid& grid,
                                            const PaintingTile& tile, const PartInfo& part) {
    const fs::path file = file_of(folder, tile);
    const Region region = grid.region(tile);
    return reading_tile(file, [&]() -> std::vector<Image<float>> {
        const std::vector<PartInfo> there = painting_parts(file);
        const auto found = std::ranges::find(there, part.name, &PartInfo::name);
        if (found == there.end()) return {};
        if (found->width != region.width() || found->height != region.height())
            fail("{}: its part '{}' is {} x {} pixels, and should be {} x {}", file.string(), part.name,
                 found->width, found->height, region.width(), region.height());
        std::vector<Image<float>> read = checked_planes(file, *found);
        std::vector<Image<float>> planes;
        for (const std::string& channel : part.channels) {
            const auto at = std::ranges::find(found->channels, channel);
            planes.push_back(at == found->channels.end()
                                 ? Image<float>(region.width(), region.height())
                                 : std::move(read[static_cast<std::size_t>(at - found->channels.begin())]));
        }
        return planes;
    });
}

void read_part_of_tiles(const fs::path& folder, const PartInfo& part,
                        const std::function<void(int, int, std::span<const float* const>)>& take,
                        const Progress& progress) {
    const TilesReader reader(folder, 0);
    if (part.width != reader.width() || part.height != reader.height()) {
        const PaintingTile coarsest{reader.levels() - 1, 0, 0};
        read_painting_part(file_of(folder, coarsest), part, take, progress);
        return;
    }
    for (int y = 0; y < reader.height(); y += kPaintingTile) {
        report(progress, "read paint", y / static_cast<double>(reader.height()));
        const int end = std::min(y + kPaintingTile, reader.height());
        const std::vector<Image<float>> planes = reader.read_part(part, {0, y, reader.width(), end});
        std::vector<const float*> rows;
        for (const Image<float>& plane : planes) rows.push_back(plane.data());
        take(y, end, rows);
    }
}

TileRows::TileRows(fs::path folder, const TileGrid& grid, const PaintingHeader& header)
    : folder_(std::move(folder)), grid_(grid), header_(header) {}

void TileRows::open(int row) {
    if (row == row_) return;
    open_.clear();
    row_ = -1;
    for (int column = 0; column < grid_.columns(); ++column) {
        const fs::path file = file_of(folder_, {0, column, row});
        open_.push_back(reading_tile(file, [&] { return DryPart(file); }));
    }
    row_ = row;
}

Surface TileRows::read(int y0, int y1) {
    Surface rows = blank_surface(header_, grid_.width(), y1 - y0);
    for (int y = y0; y < y1;) {
        const int end = std::min((y / kPaintingTile + 1) * kPaintingTile, y1);
        read(y, end, rows, y - y0);
        y = end;
    }
    return rows;
}

void TileRows::read(int y0, int y1, Surface& into, int top) {
    const int row = y0 / kPaintingTile, first = row * kPaintingTile;
    open(row);
    parallel_for(0, grid_.columns(), 1, [&](int begin, int end) {
        for (int column = begin; column < end; ++column)
            reading_tile(file_of(folder_, {0, column, row}), [&] {
                open_[static_cast<std::size_t>(column)].read(y0 - first, y1 - first, into,
                                                             column * kPaintingTile, top);
                return true;
            });
    });
}

TilesReader::TilesReader(const fs::path& folder, std::size_t cache_bytes)
    : PaintingReader(folder, {}),
      description_(description_at(folder)),
      grid_(description_.header.width, description_.header.height),
      rows_(folder, grid_, description_.header) {
    header_ = description_.header;
    constexpr std::size_t pixels = std::size_t(kPaintingTile) * kPaintingTile;
    // Of the memory four parts in five are for whole tiles; the rest is for heights, of which shadows take
    // those of tiles around.
    constexpr std::size_t maps = 2 * sizeof(Vec3) + 4 * sizeof(float) + sizeof(Rgb) + sizeof(LobeAxes);
    tiles_.most = std::max<std::size_t>(cache_bytes / 5 * 4 / (pixels * maps), 1);
    heights_.most = std::max<std::size_t>(cache_bytes / 5 / (pixels * sizeof(float)), 1);
}

std::vector<Region> TilesReader::blocks() const {
    std::vector<Region> blocks;
    for (int i = 0; i < grid_.count(); ++i) blocks.push_back(grid_.region(grid_.tile(i)));
    return blocks;
}

// Not made under the lock, and nobody waits for another one's: a thread that waits within a parallel loop may
// have what it waits for on its own stack. So two may make the same now and then.
template <class Value, class Make>
Value TilesReader::kept(Kept<Value>& cache, const PaintingTile& tile, const Make& make) const {
    const auto find = [&] {
        return std::ranges::find(cache.list, tile, &std::pair<PaintingTile, Value>::first);
    };
    {
        const std::lock_guard lock(mutex_);
        if (const auto held = find(); held != cache.list.end()) {
            cache.list.splice(cache.list.begin(), cache.list, held);
            return held->second;
        }
        while (cache.list.size() >= cache.most) cache.list.pop_back();  // room for what is made
    }
    Value made = make();
    const std::lock_guard lock(mutex_);
    if (find() == cache.list.end()) cache.list.emplace_front(tile, made);
    return made;
}

TilesReader::Tile TilesReader::tile(const PaintingTile& name) const {
    return kept(tiles_, name, [&]() -> Tile {
        const auto number = static_cast<std::size_t>(name.row * grid_.columns(name.level) + name.column);
        return std::make_shared<Surface>(read_tile(
            path(), grid_, name, description_.hashes[static_cast<std::size_t>(name.level)][number]));
    });
}

TilesReader::Heights TilesReader::heights(const PaintingTile& name) const {
    return kept(heights_, name,
                [&]() -> Heights { return std::make_shared<Image<float>>(tile(name)->height_mm); });
}

Surface TilesReader::read(const Region& region, int level) const {
    Surface s = blank(region, level);
    for_each_tile(grid_, region, level, [&](const PaintingTile& name, const Region& all, const Region& part) {
        paste(*tile(name), within(part, all), s, part.x0 - region.x0, part.y0 - region.y0);
    });
    return s;
}

Surface TilesReader::read_rows(int y0, int y1) const {
    Surface rows = rows_.read(y0, y1);
    describe(header_, rows);
    rows.part_of = {0, y0, static_cast<double>(width()), static_cast<double>(height())};
    return rows;
}

Image<float> TilesReader::read_heights(const Region& region, int level) const {
    Image<float> result(region.width(), region.height());
    for_each_tile(grid_, region, level, [&](const PaintingTile& name, const Region& all, const Region& part) {
        paste(*heights(name), within(part, all), result, part.x0 - region.x0, part.y0 - region.y0);
    });
    return result;
}

std::vector<Image<float>> TilesReader::read_part(const PartInfo& part, const Region& region) const {
    std::vector<Image<float>> planes(part.channels.size(), Image<float>(region.width(), region.height()));
    for_each_tile(grid_, region, 0, [&](const PaintingTile& name, const Region& all, const Region& some) {
        const std::vector<Image<float>> read = read_part_of_tile(path(), grid_, name, part);
        for (std::size_t c = 0; c < read.size(); ++c)
            paste(read[c], within(some, all), planes[c], some.x0 - region.x0, some.y0 - region.y0);
    });
    return planes;
}

}  // namespace tangi
