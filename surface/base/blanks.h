// blanks.h: what stands before and behind a word of a text.
#pragma once

#include <string_view>

namespace tangi {

// Without spaces, tabs and ends of lines at its beginning and end.
inline std::string_view without_blanks(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(kBlank);
    return begin == std::string_view::npos ? std::string_view()
                                           : text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

}  // namespace tangi
