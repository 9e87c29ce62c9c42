#include "surface/file/memory_file.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <new>

#include "surface/base/error.h"
#include "surface/base/memory_error.h"

namespace tangi {

MemoryFile::MemoryFile() : file_(::memfd_create("tangipaint", MFD_CLOEXEC)) {
    if (file_ < 0) fail("no memory for a file: {}", std::strerror(errno));
    path_ = fmt::format("/proc/self/fd/{}", file_);
}

MemoryFile::~MemoryFile() {
    if (mapped_) ::munmap(mapped_, length_);
    ::close(file_);
}

std::string_view MemoryFile::bytes() {
    if (mapped_) ::munmap(mapped_, length_);
    mapped_ = nullptr;
    struct stat about {};
    if (::fstat(file_, &about) != 0 || about.st_size == 0) return {};
    length_ = static_cast<std::size_t>(about.st_size);
    void* const mapped = ::mmap(nullptr, length_, PROT_READ, MAP_SHARED, file_, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    mapped_ = mapped;
    return {static_cast<const char*>(mapped_), length_};
}

std::string MemoryFile::refusal() const {
    const std::array<char, 4096> page{};
    off_t end = ::lseek(file_, 0, SEEK_END);
    ssize_t written = 0;
    do {  // a limit is met by writing less, first
        end += written;
        written = ::pwrite(file_, page.data(), page.size(), end);
    } while (written > 0 && static_cast<std::size_t>(written) < page.size());
    if (written < 0) return std::strerror(errno);
    return kNoMemory;  // which another process may have given back since
}

}  // namespace tangi
