// stale_temporaries.h: what a program that was killed left of the files that it was writing.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace tangi {

// Temporary files and folders are named `.<stem>.<process>-<machine>.tmp<extension>`; <machine> is of its
// name and of the processes that see each other on it (a container has its own).
std::string temporary_name(const std::string& stem, const std::string& extension);

// The stem of a hidden folder in the one that its files are for: nothing of it is to be read in a message.
inline constexpr const char* kWithinFolder = "tangipaint-new";

// Removes those beside `target` that were of it and whose process is gone. Of a process of another machine
// that shares the folder nobody knows: what it left goes when nobody has touched it for ten minutes; empty
// ones, which a long work keeps to write to at its end, for a day. What cannot be removed stays.
void remove_stale_temporaries(const std::filesystem::path& target, const std::string& stem,
                              const std::string& extension);
// All in a folder that a program of this machine left, of whatever file, once in the life of this program.
// Names that earlier versions gave, without the machine, and those of other machines, wait for the above.
void sweep_temporaries(const std::filesystem::path& folder);

// A message with temporary names in it, as those who asked for the files know them: "a.exr" for
// ".a.12-0123abcd.tmp.exr".
std::string in_lasting_names(std::string message);

// Of a file.
inline void remove_stale_temporaries(const std::filesystem::path& file) {
    remove_stale_temporaries(file, file.stem().string(), file.extension().string());
}

}  // namespace tangi
