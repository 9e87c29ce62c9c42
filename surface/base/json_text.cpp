#include "surface/base/json_text.h"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"

namespace tangi {

namespace {

using nlohmann::json;

// Where the field with this number begins; fields are texts that a colon follows. The text is JSON.
std::size_t place_of_field(std::string_view text, int number) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '"') continue;
        const std::size_t begin = i;
        for (++i; i < text.size() && text[i] != '"'; ++i)
            if (text[i] == '\\') ++i;
        const std::size_t next = text.find_first_not_of(" \t\r\n", i + 1);
        if (next != std::string_view::npos && text[next] == ':' && number-- == 0) return begin;
    }
    return text.size();
}

// Told of what a parser finds.
class Watcher {
public:
    Watcher(std::string_view text, const std::string& where) : text_(text), where_(where) {}

    bool operator()(int depth, json::parse_event_t event, const json& parsed) {
        if (depth > kDeepestJson)
            fail("{}: has lists and objects in each other, deeper than {}", where_, kDeepestJson);
        if (event == json::parse_event_t::object_start) seen_.emplace_back();
        if (event == json::parse_event_t::object_end) seen_.pop_back();
        if (event != json::parse_event_t::key) return true;
        if (!seen_.back().insert(parsed.get_ref<const std::string&>()).second && !twice_)
            twice_.emplace(parsed.get<std::string>(), fields_);
        ++fields_;
        return true;
    }

    // Once all of it was read: before, it may be no JSON at all.
    void refuse() const {
        if (!twice_) return;
        const bool one_line = text_.find('\n') == std::string_view::npos;
        const std::string line =
            one_line ? "" : fmt::format(" line {}:", line_of(text_, place_of_field(text_, twice_->second)));
        fail("{}:{} has the field '{}' twice; keep one of them", where_, line, shortened(twice_->first));
    }

private:
    std::string_view text_;
    const std::string& where_;
    std::vector<std::set<std::string>> seen_;  // in the objects around
    int fields_ = 0;
    std::optional<std::pair<std::string, int>> twice_;  // and its number among all fields
};

constexpr const char* kAnother = "copy the file again, or make it anew";  // where there is nothing to correct

bool is_control(unsigned char c) { return c < ' ' || c == 0x7f; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool is_of_word(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '-' || c == '+' || c == '_';
}

// The word around a place, or the character there.
std::string_view word_at(std::string_view text, std::size_t at) {
    std::size_t begin = at, end = at;
    while (end < text.size() && is_of_word(text[end])) ++end;
    if (end == at) return text.substr(at, std::max<std::size_t>(utf8_length(text.substr(at)), 1));
    while (begin > 0 && is_of_word(text[begin - 1])) --begin;
    return text.substr(begin, end - begin);
}

// Without control characters, which would give orders to a terminal; names of files may have any bytes, and
// logs and JSON want UTF-8.
std::string in_one_line(std::string_view text) {
    std::string line;
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const std::size_t length = utf8_length(text.substr(i));
        // U+0080 to U+009F are control characters too: some terminals take U+009B for an escape sequence.
        const bool wide = byte == 0xc2 && length == 2 && static_cast<unsigned char>(text[i + 1]) < 0xa0;
        if (wide)
            line += fmt::format("\\u{:04x}", static_cast<unsigned char>(text[i + 1]));
        else if (length > 0 && !is_control(byte))
            line += text.substr(i, length);
        else
            line += byte == '\n' ? "\\n" : byte == '\t' ? "\\t" : fmt::format("\\x{:02x}", byte);
        i += std::max<std::size_t>(length, 1);
    }
    return line;
}

}  // namespace

json parse_json(std::string_view text, const std::string& where) {
    if (text.size() > kLongestJson)
        fail("{}: has {} bytes, and JSON of up to {} is read; is it the file that was meant?", where,
             text.size(), kLongestJson);
    Watcher watcher(text, where);
    const auto watch = [&](int depth, json::parse_event_t event, const json& parsed) {
        return watcher(depth, event, parsed);
    };
    json value;
    try {
        value = json::parse(text.begin(), text.end(), watch);
    } catch (const json::out_of_range&) {
        fail("{}: holds a number that is too large, as 1e400 is", where);
    }
    watcher.refuse();
    return value;
}

std::string json_line(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}
std::string json_lines(const json& value, int indent) {
    return value.dump(indent, ' ', false, json::error_handler_t::replace) + "\n";
}

int line_of(std::string_view text, std::size_t byte) {
    const std::string_view before = text.substr(0, std::min(byte, text.size()));
    return 1 + static_cast<int>(std::ranges::count(before, '\n'));
}

std::string why_no_json(std::string_view text, std::size_t byte) {
    if (std::ranges::all_of(text, is_space)) return fmt::format("it is empty; {}", kAnother);
    const std::size_t at = std::min(byte > 0 ? byte - 1 : 0, text.size());
    const std::size_t line = at == 0 ? 0 : text.find_last_of('\n', at - 1) + 1;
    int column = 0;  // characters, from 1
    for (std::size_t i = line; i < text.size() && i <= at;) {
        ++column;
        const std::size_t length = utf8_length(text.substr(i));
        const auto first = static_cast<unsigned char>(text[i]);
        if (length == 0 && at < text.size())
            return fmt::format("column {}: the byte 0x{:02x} is no UTF-8; save it as a text in UTF-8", column,
                               first);
        if (first < ' ' && !is_space(text[i]))
            return fmt::format("column {}: a byte 0x{:02x}, which no text has; {}", column, first, kAnother);
        i += std::max<std::size_t>(length, 1);
    }
    if (at == text.size()) return fmt::format("it ends before it is complete, as if cut off; {}", kAnother);
    if (is_space(text[at]))
        return fmt::format(
            "column {}: a tab or line end where the text before it is not over; close its quotes", column);
    const std::string_view word = word_at(text, at);
    for (const std::string_view none : {"NaN", "nan", "Infinity", "-Infinity", "inf", "-inf"})
        if (word == none)
            return fmt::format("column {}: JSON has no NaN and no Infinity; write a number", column);
    return fmt::format("column {}: '{}' does not belong there; correct it", column, shortened(word, 40));
}

std::string shown(const json& value) {
    // The writer of JSON gives more digits than a float has.
    if (value.is_number_float()) return fmt::format("{}", value.get<double>());
    return shortened(json_line(value));
}

std::string shortened(std::string_view text, std::size_t most_bytes) {
    if (text.size() <= most_bytes) return in_one_line(text);
    std::size_t end = most_bytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // whole characters
    return fmt::format("{}… ({} bytes)", in_one_line(text.substr(0, end)), text.size());
}

std::size_t utf8_length(std::string_view text) {
    if (text.empty()) return 0;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    const unsigned char second = byte(1);
    const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
    const bool beyond = (first == 0xed && second >= 0xa0) || (first == 0xf4 && second >= 0x90);
    return overlong || beyond ? 0 : length;
}

std::string valid_utf8(std::string_view text) {
    std::string valid;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = utf8_length(text.substr(at));
        valid += length > 0 ? text.substr(at, length) : std::string_view("\ufffd");
        at += std::max<std::size_t>(length, 1);
    }
    return valid;
}

bool is_one_line(std::string_view text) { return std::ranges::none_of(text, is_control); }

std::string first_line(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    return shortened(text.substr(0, text.find_first_of("\r\n")), 400);
}

}  // namespace tangi
