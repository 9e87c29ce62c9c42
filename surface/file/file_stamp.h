// file_stamp.h: which file lies at a path, to see before it is written anew whether it is still the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace tangi {

struct FileStamp {
    std::uint64_t device = 0, inode = 0, bytes = 0;
    std::int64_t modified_ns = 0;

    friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

// Of the file that the path, or the link there, leads to; nothing where there is none.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

// Whether a file may be the one that was stamped `before`, though its stamp is another: network file systems
// give other inodes, and many keep times less exactly than they were told at first. Its content says it then.
bool may_be_same(const FileStamp& before, const FileStamp& now);

}  // namespace tangi
