// memory_file.h: a file that is memory, for libraries that write to paths only. They notice little of a disk
// that is full; what they wrote here is written to the disk by us, who do.
#pragma once

#include <string>
#include <string_view>

namespace tangi {

class MemoryFile {
public:
    // Empty. Throws Error where there is none to be had.
    MemoryFile();
    ~MemoryFile();
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    // By which this process can open it, as long as this is there.
    const std::string& path() const { return path_; }
    // What was written so far; valid until the next call. Throws std::bad_alloc.
    std::string_view bytes();
    // What the system says to more bytes at its end: why a library could not write to it.
    std::string refusal() const;

private:
    int file_ = -1;
    std::string path_;
    void* mapped_ = nullptr;
    std::size_t length_ = 0;
};

}  // namespace tangi
