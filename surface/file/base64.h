// base64.h: bytes as text (RFC 4648), for what pages hold in themselves.
#pragma once

#include <string>
#include <string_view>

namespace tangi {

inline std::string base64(std::string_view bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned value = 0;
        for (std::size_t k = 0; k < 3; ++k)
            value = value << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k > bytes.size() - i ? '=' : digits[value >> (18 - 6 * k) & 63];
    }
    return text;
}

}  // namespace tangi
