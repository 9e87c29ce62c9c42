#include "surface/file/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "surface/base/error.h"
#include "surface/file/anonymous_temp_file.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::string in_words(std::uint64_t bytes) {
    if (bytes < 1'000'000'000) return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
    return fmt::format("{:.1f} GB", static_cast<double>(bytes) / 1e9);
}

}  // namespace

ScratchFile::ScratchFile(std::uint64_t bytes, std::string what)
    : folder_(folder_for_scratch()), what_(std::move(what)), size_(bytes) {
    file_ = open_nameless_file(folder_);
    if (file_ < 0)
        fail("{}: no temporary file can be made there for {}: {}; name another folder in TMPDIR", folder_,
             what_, std::strerror(errno));
    if (bytes == 0) return;
    const int trouble = ::posix_fallocate(file_, 0, static_cast<off_t>(bytes));
    if (trouble == 0) return;
    ::close(file_);
    std::error_code ignored;
    const std::uint64_t there = fs::space(folder_, ignored).available;
    fail(
        "{}: {} need {} of temporary room on disk, {} are free there: {}; make room, or name a folder on "
        "another "
        "disk in TMPDIR",
        folder_, what_, in_words(bytes), in_words(ignored ? 0 : there), std::strerror(trouble));
}

ScratchFile::~ScratchFile() { ::close(file_); }

void ScratchFile::write(std::uint64_t offset, std::span<const std::byte> bytes) {
    TP_REQUIRE(offset + bytes.size() <= size_, "the part lies in the file");
    if (const int trouble = write_at(file_, offset, bytes))
        fail(
            "{}: the temporary file for {} cannot be written: {}; make room, or name another folder in "
            "TMPDIR",
            folder_, what_, std::strerror(trouble));
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
    TP_REQUIRE(offset + bytes.size() <= size_, "the part lies in the file");
    if (const int trouble = read_at(file_, offset, bytes))
        fail("{}: the temporary file for {} cannot be read back: {}", folder_, what_, std::strerror(trouble));
}

}  // namespace tangi
