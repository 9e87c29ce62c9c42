// deflated.h: bytes as zlib packs them (RFC 1950), as chunks of PNG files hold.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tangi {

// Nothing where they are damaged, or are more than `most_bytes` unpacked. Throws std::bad_alloc.
std::optional<std::string> inflated(std::string_view packed, std::size_t most_bytes);

// The checksum of PNG chunks (ISO/IEC 15948, 5.5).
std::uint32_t crc32_of(std::string_view bytes);

}  // namespace tangi
