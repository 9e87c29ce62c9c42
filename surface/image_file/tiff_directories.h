// tiff_directories.h: the directories of a TIFF file and their entries (TIFF 6.0, section 2; BigTIFF).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "surface/file/file_bytes.h"

namespace tangi {

struct TiffEntry {
    std::uint64_t tag = 0, type = 0, count = 0;
    std::uint64_t count_at = 0;  // where the count stands
    std::uint64_t value_at = 0;  // where the value begins
    std::uint64_t bytes = 0;     // of the value; more than the file has where the count says so
};

struct TiffDirectory {
    std::vector<TiffEntry> entries;
    std::uint64_t next = 0;  // where the next one is; 0 behind the last
};

// Places [bytes] are from the beginning of the file, which must live as long.
class TiffDirectories {
public:
    explicit TiffDirectories(const FileBytes& file);

    // Where the first directory is; 0 where this is no TIFF file, or has none.
    std::uint64_t first() const { return first_; }
    // Nothing where it has more entries than there can be.
    std::optional<TiffDirectory> at(std::uint64_t place) const;

    // Whole numbers that an entry holds, `most` at most; none of other kinds.
    std::vector<std::uint64_t> values(const TiffEntry& entry, std::uint64_t most) const;
    // The first of them; 0 where there is none.
    double value(const TiffEntry& entry) const;

    // [bytes] Of a count and of a place.
    int offset_bytes() const { return is_big_ ? 8 : 4; }
    const FileBytes& file() const { return file_; }

private:
    std::uint64_t number(std::uint64_t at, int length) const {
        return file_.number(at, length, big_endian_).value_or(0);
    }

    const FileBytes& file_;
    bool big_endian_ = false, is_big_ = false;
    std::uint64_t first_ = 0;
};

constexpr std::size_t kMostTiffDirectories = 4096;  // pages and pyramids have some tens

}  // namespace tangi
