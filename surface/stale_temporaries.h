// stale_temporaries.h: what a program that was killed left of the files that it was writing.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace tangi {

// Temporary files and folders are named `.<stem>.<process>.tmp<extension>`.
std::string temporary_name(const std::string& stem, const std::string& extension);

// Removes those beside `target` that were of it, whose process is gone and that nobody touched for ten
// minutes; empty ones, which a long work keeps to write to at its end, for a day: the process may be one of
// another machine that shares the folder. What cannot be removed stays.
void remove_stale_temporaries(const std::filesystem::path& target, const std::string& stem,
                              const std::string& extension);
// Of a file.
inline void remove_stale_temporaries(const std::filesystem::path& file) {
    remove_stale_temporaries(file, file.stem().string(), file.extension().string());
}

}  // namespace tangi
