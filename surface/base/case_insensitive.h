// case_insensitive.h: names that are the same but for capitals.
#pragma once

#include <string>
#include <string_view>

namespace tangi {

// A to Z in lower case, whatever the locale; other letters as they are.
inline std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return result;
}

}  // namespace tangi
