#include "surface/file/anonymous_temp_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace tangi {

namespace {

template <class Bytes, class Call>
int all_of(int file, std::uint64_t offset, Bytes bytes, const Call& call) {
    while (!bytes.empty()) {
        const ssize_t done = call(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) return done < 0 ? errno : EIO;
        bytes = bytes.subspan(static_cast<std::size_t>(done));
        offset += static_cast<std::uint64_t>(done);
    }
    return 0;
}

}  // namespace

std::string folder_for_scratch() {
    const char* given = std::getenv("TMPDIR");
    return given && *given ? given : "/tmp";
}

int open_nameless_file(const std::string& folder) {
    const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0) return file;
    // Some network file systems have no nameless files: there the name is gone a moment later.
    std::string pattern = folder + "/tangipaint-XXXXXX";
    const int named = ::mkostemp(pattern.data(), O_CLOEXEC);
    if (named >= 0) ::unlink(pattern.c_str());
    return named;
}

int write_at(int file, std::uint64_t offset, std::span<const std::byte> bytes) {
    return all_of(file, offset, bytes, ::pwrite);
}

int read_at(int file, std::uint64_t offset, std::span<std::byte> bytes) {
    return all_of(file, offset, bytes, ::pread);
}

}  // namespace tangi
