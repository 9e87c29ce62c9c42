// stale_temporaries.h: what a program that was killed left of the files that it was writing.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace tangi {

// Temporary files and folders are named `.<stem>.<process>-<machine>.tmp<extension>`; <machine> is of its
// name and of the processes that see each other on it (a container has its own).
std::string temporary_name(const std::string& stem, const std::string& extension);

// Removes those beside `target` that were of it and whose process is gone. Of a process of another machine
// that shares the folder nobody knows: what it left goes when nobody has touched it for ten minutes; empty
// ones, which a long work keeps to write to at its end, for a day. What cannot be removed stays.
void remove_stale_temporaries(const std::filesystem::path& target, const std::string& stem,
                              const std::string& extension);
// Of a file.
inline void remove_stale_temporaries(const std::filesystem::path& file) {
    remove_stale_temporaries(file, file.stem().string(), file.extension().string());
}

}  // namespace tangi
