#include "surface/file/file_stamp.h"

#include <sys/stat.h>

#include <cstdlib>

namespace tangi {

namespace {

// FAT counts in steps of 2 s; others are finer (Linux, Documentation/filesystems).
constexpr std::int64_t kCoarsestClock_ns = 2'000'000'000;

}  // namespace

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
    struct stat status = {};
    if (::stat(path.c_str(), &status) != 0) return {};
    return FileStamp{
        status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
        static_cast<std::int64_t>(status.st_mtim.tv_sec) * 1'000'000'000 + status.st_mtim.tv_nsec};
}

bool may_be_same(const FileStamp& before, const FileStamp& now) {
    return before.bytes == now.bytes && std::abs(before.modified_ns - now.modified_ns) < kCoarsestClock_ns;
}

}  // namespace tangi
