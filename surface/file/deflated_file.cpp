// deflated_file.cpp: through libdeflate.
#include <libdeflate.h>

#include <algorithm>
#include <memory>
#include <new>

#include "surface/file/deflated.h"

namespace tangi {

std::optional<std::string> inflated(std::string_view packed, std::size_t most_bytes) {
    const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> unpacker(
        libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
    if (!unpacker) throw std::bad_alloc();
    // How long it will be is not told: most texts and profiles become three times as long.
    for (std::size_t room = std::min(4 * packed.size() + 64, most_bytes);;
         room = std::min(4 * room, most_bytes)) {
        std::string text(room, '\0');
        std::size_t length = 0;
        const libdeflate_result result = libdeflate_zlib_decompress(
            unpacker.get(), packed.data(), packed.size(), text.data(), text.size(), &length);
        text.resize(length);
        if (result == LIBDEFLATE_SUCCESS) return text;
        if (result != LIBDEFLATE_INSUFFICIENT_SPACE || room >= most_bytes) return {};
    }
}

std::uint32_t crc32_of(std::string_view bytes) { return libdeflate_crc32(0, bytes.data(), bytes.size()); }

}  // namespace tangi
