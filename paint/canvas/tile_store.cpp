#include "paint/canvas/tile_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "surface/base/error.h"
#include "surface/file/anonymous_temp_file.h"

namespace tangi {

namespace {

std::string folder_for_tiles() {
    const char* given = std::getenv("TMPDIR");
    if (given && *given) return given;
    return ::access("/var/tmp", W_OK) == 0 ? "/var/tmp" : folder_for_scratch();
}

}  // namespace

class TileFile {
public:
    TileFile() = default;
    ~TileFile() {
        if (file_ >= 0) ::close(file_);
    }
    TileFile(const TileFile&) = delete;
    TileFile& operator=(const TileFile&) = delete;

    std::uint64_t put(std::span<const float> values) {
        const std::uint64_t offset = take(values.size_bytes());
        if (const int trouble = write_at(file_, offset, std::as_bytes(values))) {
            give_back(offset, values.size_bytes());
            no_room(trouble);
        }
        return offset;
    }
    void get(std::uint64_t offset, std::span<float> values) const {
        if (const int trouble = read_at(file_, offset, std::as_writable_bytes(values)))
            fail("{}: the temporary file of undo cannot be read back: {}", folder_, std::strerror(trouble));
    }
    void give_back(std::uint64_t offset, std::uint64_t bytes) {
        free_.emplace(bytes, offset);
        used_ -= bytes;
    }
    std::uint64_t used() const { return used_; }

private:
    std::uint64_t take(std::uint64_t bytes) {
        if (file_ < 0) file_ = open_nameless_file(folder_);
        if (file_ < 0) no_room(errno);
        // Tiles have a few sizes, so that a part of just the right one is free most times.
        auto part = free_.lower_bound(bytes);
        if (part == free_.end()) {
            std::uint64_t more = std::max(bytes, kGrow);
            if (reserve(more) != 0) more = bytes;
            if (const int trouble = reserve(more)) no_room(trouble);
            part = free_.emplace(more, length_);
            length_ += more;
        }
        const auto [have, offset] = *part;
        free_.erase(part);
        if (have > bytes) free_.emplace(have - bytes, offset + bytes);
        used_ += bytes;
        return offset;
    }

    int reserve(std::uint64_t more) const {
        return ::posix_fallocate(file_, static_cast<off_t>(length_), static_cast<off_t>(more));
    }
    [[noreturn]] void no_room(int trouble) const {
        fail(
            "{}: no room for steps that could be undone, which have {} MB there: {}; name a folder in TMPDIR",
            folder_, used_ >> 20, std::strerror(trouble));
    }

    static constexpr std::uint64_t kGrow = 4 << 20;
    const std::string folder_ = folder_for_tiles();
    int file_ = -1;
    std::multimap<std::uint64_t, std::uint64_t> free_;  // bytes, offset
    std::uint64_t length_ = 0, used_ = 0;
};

StoredTile::StoredTile(std::shared_ptr<TileFile> file, const PaintTile& tile)
    : file_(std::move(file)),
      ingredients_(tile.ingredients),
      floats_(tile.thickness_mm.size()),
      offset_(file_->put(tile.thickness_mm)) {}

StoredTile::~StoredTile() { file_->give_back(offset_, floats_ * sizeof(float)); }

PaintLayer::TilePtr StoredTile::read() const {
    auto tile = std::make_shared<PaintTile>();
    tile->ingredients = ingredients_;
    tile->thickness_mm.resize(floats_);
    file_->get(offset_, tile->thickness_mm);
    return tile;
}

TileStore::TileStore() : file_(std::make_shared<TileFile>()) {}

std::shared_ptr<const StoredTile> TileStore::put(const PaintLayer::TilePtr& tile) {
    TP_REQUIRE(tile, "there is a tile to store");
    if (known_.size() > prune_at_) {
        std::erase_if(known_, [](const auto& entry) { return entry.second.expired(); });
        prune_at_ = 2 * known_.size() + 1024;
    }
    std::weak_ptr<const StoredTile>& known = known_[tile];
    if (auto stored = known.lock()) return stored;
    const auto stored = std::make_shared<const StoredTile>(file_, *tile);
    known = stored;
    return stored;
}

PaintLayer::TilePtr TileStore::get(const std::shared_ptr<const StoredTile>& stored) {
    const PaintLayer::TilePtr tile = stored->read();
    known_[tile] = stored;
    return tile;
}

std::uint64_t TileStore::bytes() const { return file_->used(); }

}  // namespace tangi
