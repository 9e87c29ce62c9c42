// no_files.cpp: the web engine keeps nothing in files: what is stored is the page's business
// (web/app/storage.js). Undo beyond its memory is given up (paint/session/history.h), as on a full disk.
#include <stdlib.h>

#include <cerrno>

#include "surface/base/error.h"
#include "surface/file/anonymous_temp_file.h"
#include "surface/file/atomic_file.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

namespace {

// Rooms that look for a folder for temporary files find this name, and ask no system.
[[maybe_unused]] const int kNamed = ::setenv("TMPDIR", "/tmp", 1);

}  // namespace

std::string folder_for_scratch() { return "/tmp"; }

int open_nameless_file(const std::string&) {
    errno = ENOSPC;
    return -1;
}
int write_at(int, std::uint64_t, std::span<const std::byte>) { return ENOSPC; }
int read_at(int, std::uint64_t, std::span<std::byte>) { return EIO; }

std::string read_text_file(const std::filesystem::path& path) {
    fail("{}: there are no files in a browser", path.string());
}
void read_painting_part(const std::filesystem::path& path, const PartInfo&,
                        const std::function<void(int, int, std::span<const float* const>)>&,
                        const Progress&) {
    fail("{}: there are no files in a browser", path.string());
}
void write_text_file(const std::filesystem::path& path, std::string_view) {
    fail("{}: there are no files in a browser", path.string());
}

}  // namespace tangi
