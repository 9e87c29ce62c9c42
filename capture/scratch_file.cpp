#include "capture/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "surface/error.h"

namespace tangi {

namespace fs = std::filesystem;

namespace {

std::string in_words(std::uint64_t bytes) {
    if (bytes < 1'000'000'000) return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
    return fmt::format("{:.1f} GB", static_cast<double>(bytes) / 1e9);
}

int open_nameless(const std::string& folder) {
    const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0) return file;
    // Some network file systems have no nameless files: there the name is gone a moment later.
    std::string pattern = folder + "/tangipaint-XXXXXX";
    const int named = ::mkostemp(pattern.data(), O_CLOEXEC);
    if (named >= 0) ::unlink(pattern.c_str());
    return named;
}

std::string folder_for_scratch() {
    const char* given = std::getenv("TMPDIR");
    return given && *given ? given : "/tmp";
}

}  // namespace

ScratchFile::ScratchFile(std::uint64_t bytes, std::string what)
    : folder_(folder_for_scratch()), what_(std::move(what)), size_(bytes) {
    file_ = open_nameless(folder_);
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
    while (!bytes.empty()) {
        const ssize_t done = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0)
            fail(
                "{}: the temporary file for {} cannot be written: {}; make room, or name another folder in "
                "TMPDIR",
                folder_, what_, std::strerror(errno));
        bytes = bytes.subspan(static_cast<std::size_t>(done));
        offset += static_cast<std::uint64_t>(done);
    }
}

void ScratchFile::read(std::uint64_t offset, std::span<std::byte> bytes) const {
    TP_REQUIRE(offset + bytes.size() <= size_, "the part lies in the file");
    while (!bytes.empty()) {
        const ssize_t done = ::pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0)
            fail("{}: the temporary file for {} cannot be read back: {}", folder_, what_,
                 done < 0 ? std::strerror(errno) : "it ends too early");
        bytes = bytes.subspan(static_cast<std::size_t>(done));
        offset += static_cast<std::uint64_t>(done);
    }
}

}  // namespace tangi
