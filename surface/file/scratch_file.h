// scratch_file.h: room on disk for pixels that are too many for memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tangi {

// A file without a name in the folder for temporary files ($TMPDIR, or /tmp): so the system takes the room
// back however the program ends, be it by an error, Ctrl-C or the loss of power. Reading is safe from several
// threads, and so is writing to parts that do not overlap.
class ScratchFile {
public:
    // Reserves the room at once, so that a disk that is too small is known before the work. `what` says in
    // the message what the room is for ("60 camera raws"). Throws Error naming the folder, the room wanted
    // and the room there is.
    ScratchFile(std::uint64_t bytes, std::string what);
    ~ScratchFile();
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

    std::uint64_t size() const { return size_; }

    // Throw Error naming the folder where the disk fails.
    void write(std::uint64_t offset, std::span<const std::byte> bytes);
    void read(std::uint64_t offset, std::span<std::byte> bytes) const;

private:
    std::string folder_, what_;
    std::uint64_t size_ = 0;
    int file_ = -1;
};

}  // namespace tangi
