// scratch_memory.cpp: large memory of the web engine, which has no disk to put it aside on.
#include "surface/file/scratch_memory.h"

#include <cstdlib>
#include <new>
#include <utility>

namespace tangi {

ScratchMemory::ScratchMemory(std::size_t bytes, std::size_t, const std::string&)
    : data_(bytes > 0 ? std::calloc(bytes, 1) : nullptr), bytes_(bytes) {
    if (bytes > 0 && !data_) throw std::bad_alloc();
}

ScratchMemory::~ScratchMemory() { std::free(data_); }

ScratchMemory::ScratchMemory(ScratchMemory&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}

ScratchMemory& ScratchMemory::operator=(ScratchMemory&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

}  // namespace tangi
