#include "surface/file/scratch_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <new>
#include <utility>

#include "surface/file/anonymous_temp_file.h"

namespace tangi {

namespace {

std::string folder_on_disk() {
    const char* given = std::getenv("TMPDIR");
    return given && *given ? given : "/var/tmp";
}

// Null where there is not the room: it is reserved now, since a page that finds none later ends the program.
void* on_disk(std::size_t bytes, const std::string& folder) {
    const int file = open_nameless_file(folder);
    if (file < 0) return nullptr;
    void* data = MAP_FAILED;
    if (::posix_fallocate(file, 0, static_cast<off_t>(bytes)) == 0)
        data = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);  // the mapping keeps it
    return data == MAP_FAILED ? nullptr : data;
}

}  // namespace

ScratchMemory::ScratchMemory(std::size_t bytes, std::size_t most_held, const std::string& folder)
    : bytes_(bytes) {
    if (bytes == 0) return;
    if (bytes > most_held) data_ = tangi::on_disk(bytes, folder.empty() ? folder_on_disk() : folder);
    on_disk_ = data_ != nullptr;
    if (on_disk_) return;
    data_ = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (data_ != MAP_FAILED) return;
    data_ = nullptr;
    throw std::bad_alloc();
}

ScratchMemory::~ScratchMemory() {
    if (data_) ::munmap(data_, bytes_);
}

ScratchMemory::ScratchMemory(ScratchMemory&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      bytes_(std::exchange(other.bytes_, 0)),
      on_disk_(std::exchange(other.on_disk_, false)) {}

ScratchMemory& ScratchMemory::operator=(ScratchMemory&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    std::swap(on_disk_, other.on_disk_);
    return *this;
}

}  // namespace tangi
