// file_bytes.h: bytes of a file from anywhere in it, for who looks at a file before a library reads it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace tangi {

class FileBytes {
public:
    // Throws Error naming the file where it cannot be opened.
    explicit FileBytes(const std::filesystem::path& path);
    ~FileBytes();
    FileBytes(const FileBytes&) = delete;
    FileBytes& operator=(const FileBytes&) = delete;

    std::uint64_t size() const { return size_; }
    // What there is of `length` bytes from a place on. Throws Error naming the file where the disk does not
    // give them.
    std::string bytes(std::uint64_t at, std::uint64_t length) const;
    // A whole number of 1 to 8 bytes; nothing where the file ends before it does.
    std::optional<std::uint64_t> number(std::uint64_t at, int length, bool big_endian) const;

private:
    std::filesystem::path path_;
    int file_;
    std::uint64_t size_ = 0;
};

// What the operating system says where it does not give all bytes of a file (no permission, a disk that
// fails); nothing where it does. For who is about to call a file damaged that a library could not read.
std::optional<std::string> trouble_reading(const std::filesystem::path& path);

// The same, as an Error that names the file.
void require_readable(const std::filesystem::path& path);

// The same number of bytes that are there.
std::uint64_t number_in(std::string_view bytes, bool big_endian);

}  // namespace tangi
