// memory_budget.h: how much memory there is, looked up before a picture that needs much of it is unpacked. A
// file of a megabyte may hold a sound picture of a billion pixels; Linux grants memory for it that it has
// not, and ends the process, or another one, once it is used.
#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

namespace tangi {

// [bytes] that this process can still take: the least of what its limits leave (setrlimit: address space,
// data), what its control groups leave (cgroups, v1 and v2) and what the system has, swap included. Infinite
// where nothing of that can be read. `root`: where /proc and /sys are.
double memory_left(const std::filesystem::path& root = "/");

// Throws Error naming the file where `bytes` are more than memory_left(): "FILE: WHAT takes 21.6 GB of
// memory, and 9.1 GB are left; ...". Asks nothing for less than 64 MiB.
void require_memory(const std::filesystem::path& path, double bytes, std::string_view what);

// Memory that a library will take once it gives the first row of a file that is open: of many files that are
// open at once, the sum must be there. Given back once it was taken, which memory_left() sees then, or the
// file is closed. Any number of threads may have some.
class MemoryClaim {
public:
    MemoryClaim() = default;
    // Throws Error as require_memory(), of `bytes` and what all others claim.
    MemoryClaim(const std::filesystem::path& path, double bytes, std::string_view what);
    ~MemoryClaim() { give_back(); }
    MemoryClaim(MemoryClaim&& other) noexcept : bytes_(std::exchange(other.bytes_, 0)) {}
    MemoryClaim& operator=(MemoryClaim&& other) noexcept {
        std::swap(bytes_, other.bytes_);
        return *this;
    }
    void give_back();

private:
    double bytes_ = 0;
};

// require_memory() for the maps that every Surface of this size has, and `beside` bytes a pixel more; where
// images of that size lie on disk (image_memory.h), that there is room. Throws Error naming file and folder.
void require_memory_of_surface(const std::filesystem::path& path, int width, int height, double beside,
                               std::string_view what);

}  // namespace tangi
