#include "surface/base/json_reading.h"

#include "surface/base/error.h"
#include "surface/base/json_text.h"

namespace tangi {

using nlohmann::json;

json read_json(std::string_view text, const std::string& where) {
    try {
        return parse_json(text, where);
    } catch (const json::parse_error& error) {
        fail("{}: line {}: is not JSON: {}", where, line_of(text, error.byte), why_no_json(text, error.byte));
    }
}

json json_or_discarded(std::string_view text) {
    json none(json::value_t::discarded);
    if (text.size() > kLongestJson) return none;
    bool too_deep = false;
    const auto watch = [&](int depth, json::parse_event_t, const json&) {
        too_deep = too_deep || depth > kDeepestJson;
        return !too_deep;
    };
    json value = json::parse(text.begin(), text.end(), watch, false);
    return too_deep ? none : value;
}

std::string why_wrong_field(const std::exception& error) {
    const std::string_view words = error.what();  // "[json.exception.out_of_range.403] key 'lens' not found"
    const std::size_t from = words.find('\''), to = words.rfind('\'');
    if (words.find("key '") != std::string_view::npos && from < to)
        return fmt::format("the field {} is missing", shortened(words.substr(from, to - from + 1)));
    const std::size_t wanted = words.find("must be "), found = words.find(", but is ");
    if (wanted != std::string_view::npos && found != std::string_view::npos && wanted + 8 < found)
        return fmt::format("a field is a {} where a {} belongs", words.substr(found + 9),
                           words.substr(wanted + 8, found - wanted - 8));
    if (words.starts_with("[json.")) return "a field is missing, or of another kind than it should be";
    return first_line(words);
}

}  // namespace tangi
