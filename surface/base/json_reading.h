// json_reading.h: JSON of files and attributes. Everything that the program takes for JSON comes through
// here.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace tangi {

// As parse_json() (json_text.h) does it of a whole file: what is no JSON is an Error, too, that names the
// line and why.
nlohmann::json read_json(std::string_view text, const std::string& where);

// JSON that a program wrote, which nobody edits: discarded (is_discarded()) where it is none, or beyond the
// same limits. The parser itself takes what comes: values in each other a hundred thousand deep, of which the
// stack of its writer ends.
nlohmann::json json_or_discarded(std::string_view text);

// Lists and objects in each other; ours have eight.
constexpr int kDeepestJson = 64;
// [bytes] More is no JSON of ours: a capture of 1000 photographs has one million. A list of numbers takes ten
// times as much in memory.
constexpr std::size_t kLongestJson = std::size_t(64) << 20;

// What was wrong with a field, for what the JSON library throws where one is missing or of another kind.
std::string why_wrong_field(const std::exception& error);

}  // namespace tangi
