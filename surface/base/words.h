// words.h: words of a text, without what stands around them and whatever their capitals.
#pragma once

#include <string>
#include <string_view>

namespace tangi {

// Without spaces, tabs and ends of lines at its beginning and end.
inline std::string_view without_blanks(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(kBlank);
    return begin == std::string_view::npos ? std::string_view()
                                           : text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

// A to Z in lower case, whatever the locale; other letters as they are.
inline std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

}  // namespace tangi
