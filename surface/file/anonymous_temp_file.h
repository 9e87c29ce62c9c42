// anonymous_temp_file.h: temporary files that have no name, so that the system takes the room back however
// the program ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tangi {

// $TMPDIR, or /tmp.
std::string folder_for_scratch();

// The descriptor of a new, empty file in a folder, which the caller closes; -1 and errno where there can be
// none.
int open_nameless_file(const std::string& folder);

// All of the bytes, or the number of the error (errno.h; EIO where the file ends too early). Safe from
// several threads for parts that do not overlap.
int write_at(int file, std::uint64_t offset, std::span<const std::byte> bytes);
int read_at(int file, std::uint64_t offset, std::span<std::byte> bytes);

}  // namespace tangi
