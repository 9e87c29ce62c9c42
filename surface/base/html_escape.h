// html_escape.h: text that stays text on a page.
#pragma once

#include <string>

namespace tangi {

inline std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    return result;
}

// JSON within <script>: only "<" could end that early, and JSON lets it be written otherwise.
inline std::string inside_script(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return result;
}

}  // namespace tangi
