// memory_budget.h: how much memory there is, looked up before a picture that needs much of it is unpacked. A
// file of a megabyte may hold a sound picture of a billion pixels; Linux grants memory for it that it has
// not, and ends the process, or another one, once it is used.
#pragma once

#include <filesystem>
#include <string_view>

namespace tangi {

// [bytes] that this process can still take: the least of what its limits leave (setrlimit: address space,
// data), what its control groups leave (cgroups, v1 and v2) and what the system has, swap included. Infinite
// where nothing of that can be read. `root`: where /proc and /sys are.
double memory_left(const std::filesystem::path& root = "/");

// Throws Error naming the file where `bytes` are more than memory_left(): "FILE: WHAT takes 21.6 GB of
// memory, and 9.1 GB are left; ...". Asks nothing for less than 64 MiB.
void require_memory(const std::filesystem::path& path, double bytes, std::string_view what);

// The same for the maps that every Surface of this size has, and `beside` bytes a pixel more.
void require_memory_of_surface(const std::filesystem::path& path, int width, int height, double beside,
                               std::string_view what);

}  // namespace tangi
