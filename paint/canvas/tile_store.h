// tile_store.h: tiles of paint that memory has no room for, in a temporary file.
#pragma once

#include <map>
#include <memory>

#include "paint/canvas/paint_layer.h"

namespace tangi {

class TileFile;  // the file, and which parts of it are free

// A tile in the file. Its room is free again where nobody holds on to it any more.
class StoredTile {
public:
    StoredTile(std::shared_ptr<TileFile> file, const PaintTile& tile);
    ~StoredTile();
    StoredTile(const StoredTile&) = delete;
    StoredTile& operator=(const StoredTile&) = delete;

    PaintLayer::TilePtr read() const;

private:
    std::shared_ptr<TileFile> file_;
    std::vector<IngredientId> ingredients_;
    std::size_t floats_;
    std::uint64_t offset_;
};

class TileStore {
public:
    // The file is made when the first tile comes; in $TMPDIR, or /var/tmp, which is on a disk where /tmp may
    // be memory.
    TileStore();

    // Writes a tile; one that was written before, and is still there, is not written again. Throws Error
    // naming the folder where there is no room.
    std::shared_ptr<const StoredTile> put(const PaintLayer::TilePtr& tile);
    // The tile bit for bit, which put() knows again. Throws Error where the disk fails.
    PaintLayer::TilePtr get(const std::shared_ptr<const StoredTile>& stored);

    // [bytes] that tiles take in the file at present.
    std::uint64_t bytes() const;

private:
    std::shared_ptr<TileFile> file_;
    std::map<std::weak_ptr<const PaintTile>, std::weak_ptr<const StoredTile>, std::owner_less<>> known_;
    std::size_t prune_at_ = 1024;
};

}  // namespace tangi
