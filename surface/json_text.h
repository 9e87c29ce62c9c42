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

// The line that a place in a text is in, from 1.
int line_of(std::string_view text, std::size_t byte);

// A value in a message: numbers as short as they are exact, and nothing longer than a line.
std::string shown(const nlohmann::json& value);
std::string shortened(std::string_view text, std::size_t most_bytes = 80);

}  // namespace tangi
