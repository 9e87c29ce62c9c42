#include "surface/image_file/png_check.h"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace tangi {

namespace {

std::uint32_t big_endian(std::string_view bytes) {
    std::uint32_t number = 0;
    for (const char byte : bytes) number = number << 8 | static_cast<unsigned char>(byte);
    return number;
}

}  // namespace

bool is_whole_png(const std::filesystem::path& path) {
    using std::string_view_literals::operator""sv;
    constexpr std::uintmax_t checksum = 4;
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(path, unknown);
    std::ifstream stream(path, std::ios::binary);
    std::string bytes(8, '\0');
    if (unknown || !stream.read(bytes.data(), 8) || bytes != "\x89PNG\r\n\x1a\n"sv) return true;
    for (std::uintmax_t begin = 8;;) {
        if (!stream.read(bytes.data(), 8)) return stream.bad();
        const std::uintmax_t end = begin + 8 + big_endian(std::string_view(bytes).substr(0, 4)) + checksum;
        if (end > size) return false;
        if (std::string_view(bytes).substr(4) == "IEND"sv) return true;
        stream.seekg(static_cast<std::streamoff>(end));
        begin = end;
    }
}

}  // namespace tangi
