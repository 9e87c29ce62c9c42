// scratch_memory.h: large memory that the system may put aside on disk when others need the room.
#pragma once

#include <cstddef>
#include <string>

namespace tangi {

// $TMPDIR, or /var/tmp.
std::string folder_for_scratch_memory();

// [bytes] So many pages of files the process has in memory at a time, some more for a moment: beyond that,
// those of scratch memory are taken out of it, piece by piece until there are no more, at any time and beside
// any use. They come back from their file as they are touched; where the system has the room it still keeps
// them. Without a limit at first.
void limit_scratch_pages(std::size_t bytes);

class ScratchMemory {
public:
    ScratchMemory() = default;
    // All 0. Up to `most_held` bytes are ordinary memory; more are pages of a file without a name in `folder`
    // (empty: $TMPDIR, or /var/tmp, which is a disk's where /tmp is not), of which the system keeps as many
    // in memory as there is room for. Ordinary memory, too, where the disk has not the room. Throws
    // std::bad_alloc.
    explicit ScratchMemory(std::size_t bytes, std::size_t most_held = std::size_t(1) << 30,
                           const std::string& folder = {});
    ~ScratchMemory();
    ScratchMemory(ScratchMemory&& other) noexcept;
    ScratchMemory& operator=(ScratchMemory&& other) noexcept;

    void* data() const { return data_; }
    bool on_disk() const { return on_disk_; }

private:
    void* data_ = nullptr;
    std::size_t bytes_ = 0;
    bool on_disk_ = false;
};

}  // namespace tangi
