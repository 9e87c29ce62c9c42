// json_text.h: JSON that people write, read strictly, and its values as messages show them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace tangi {

// As nlohmann::json::parse(), which throws parse_error where the text is no JSON. Throws Error, naming
// `where` and the line in a text of several, for an object that has a field twice (a parser keeps one of
// them, and its user meant both), and for more than 64 levels of lists and objects in each other.
nlohmann::json parse_json(std::string_view text, const std::string& where);

// JSON as text, on one line without its end, or with a line for each value and the last line's end. What is
// no UTF-8 becomes U+FFFD. Writing and reading go through here and json_reading.h: the library's templates
// take seconds to compile in each source that uses them.
std::string json_line(const nlohmann::json& value);
std::string json_lines(const nlohmann::json& value, int indent = 2);

// The line that a place in a text is in, from 1.
int line_of(std::string_view text, std::size_t byte);
// Why a text is no JSON, at the place where a parser gave up (parse_error::byte), with its column, and what
// to do about it: cut off, not UTF-8, not a text at all, NaN, or what does not belong there.
std::string why_no_json(std::string_view text, std::size_t byte);

// A value in a message: numbers as short as they are exact, nothing longer than a line, and each control
// character of ASCII as \n, \t or \x1b.
std::string shown(const nlohmann::json& value);
std::string shortened(std::string_view text, std::size_t most_bytes = 80);

// Bytes of the character that a text begins with in UTF-8; 0 where it begins with none (Unicode 15, table
// 3-7).
std::size_t utf8_length(std::string_view text);

// Text of unknown origin (lines and attributes of files) as valid UTF-8, for messages and JSON: each byte
// that is none becomes U+FFFD. shown() and shortened() do it too.
std::string valid_utf8(std::string_view text);
// A name that fits in one line: no control characters (of ASCII).
bool is_one_line(std::string_view text);
constexpr std::size_t kMostOfName = 200;  // [bytes] of names of paints, layers and brushes
// The first line of what a library says of an error, as valid UTF-8: theirs run on and repeat themselves.
std::string first_line(std::string_view text);

}  // namespace tangi
