// memory_error.h: what libraries throw where memory ran out, which is not always std::bad_alloc.
#pragma once

#include <cerrno>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

namespace tangi {

inline constexpr const char* kNoMemory = "not enough memory";

// The same in words, of libraries that have no other.
inline bool says_no_memory(std::string_view words) {
    for (const std::string_view part :
         {"Resource temporarily unavailable", "Cannot allocate memory", "std::bad_alloc",
          "Failed to allocate", "nsufficient memory", "ut of memory",
          "Data compression (zlib) failed"})  // of OpenEXR, for Z_MEM_ERROR: it gives zlib room enough
        if (words.find(part) != std::string_view::npos) return true;
    return false;
}

// A thread takes memory, too: that it cannot be made (EAGAIN) is the same, or a limit on their number.
inline bool says_no_memory(const std::exception& error) {
    if (dynamic_cast<const std::bad_alloc*>(&error)) return true;
    if (const auto* system = dynamic_cast<const std::system_error*>(&error);
        system && (system->code().value() == ENOMEM || system->code().value() == EAGAIN))
        return true;
    return says_no_memory(std::string_view(error.what()));
}

}  // namespace tangi
