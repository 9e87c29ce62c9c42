#include "surface/file/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "surface/base/error.h"
#include "surface/file/anonymous_temp_file.h"

namespace tangi {

FileBytes::FileBytes(const std::filesystem::path& path)
    : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (file_ < 0) fail("{}: cannot be read: {}", path.string(), std::strerror(errno));
    struct stat about {};
    if (::fstat(file_, &about) == 0 && S_ISREG(about.st_mode))
        size_ = static_cast<std::uint64_t>(about.st_size);
}

FileBytes::~FileBytes() { ::close(file_); }

std::string FileBytes::bytes(std::uint64_t at, std::uint64_t length) const {
    if (at >= size_) return {};
    std::string result(static_cast<std::size_t>(std::min(length, size_ - at)), '\0');
    if (const int trouble = read_at(file_, at, std::as_writable_bytes(std::span(result))))
        fail("{}: cannot be read: {}", path_.string(), std::strerror(trouble));
    return result;
}

std::optional<std::uint64_t> FileBytes::number(std::uint64_t at, int length, bool big_endian) const {
    const std::string found = bytes(at, static_cast<std::uint64_t>(length));
    if (found.size() < static_cast<std::size_t>(length)) return {};
    return number_in(found, big_endian);
}

std::optional<std::string> trouble_reading(const std::filesystem::path& path) {
    constexpr std::size_t kAtOnce = 1 << 20;  // [bytes]
    std::string bytes(kAtOnce, '\0');
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    ssize_t count = file < 0 ? -1 : 1;
    while (count > 0 || (count < 0 && file >= 0 && errno == EINTR))
        count = ::read(file, bytes.data(), kAtOnce);
    const int trouble = count < 0 ? errno : 0;
    if (file >= 0) ::close(file);
    if (trouble == 0) return {};
    return std::strerror(trouble);
}

void require_readable(const std::filesystem::path& path) {
    if (const auto trouble = trouble_reading(path)) fail("{}: cannot be read: {}", path.string(), *trouble);
}

std::uint64_t number_in(std::string_view bytes, bool big_endian) {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const char byte = bytes[big_endian ? i : bytes.size() - 1 - i];
        number = number << 8 | static_cast<unsigned char>(byte);
    }
    return number;
}

}  // namespace tangi
