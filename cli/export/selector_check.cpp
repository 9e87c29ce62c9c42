#include "cli/export/selector_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "surface/base/json_text.h"
#include "surface/base/words.h"

namespace tangi {

namespace {

constexpr std::string_view kBetween = " \t\r\n,";

// Words of an element: "polygon points="1,2 3,4"", and the name alone, without that of its space.
struct Tag {
    std::string_view words, name;
};

struct Elements {
    std::vector<Tag> tags;
    std::string wrong;  // why the text is no well-formed piece of XML with one element at its root
};

// The end of what begins with < at a place; the text's size where there is none.
std::size_t end_of_tag(std::string_view text, std::size_t at) {
    if (text.substr(at, 4) == "<!--") return std::min(text.find("-->", at), text.size() - 2) + 2;
    char quote = 0;
    for (std::size_t end = at + 1; end < text.size(); ++end)
        if (quote)
            quote = text[end] == quote ? 0 : quote;
        else if (text[end] == '"' || text[end] == '\'')
            quote = text[end];
        else if (text[end] == '>')
            return end;
    return text.size();
}

Elements elements_of(std::string_view text) {
    Elements found;
    std::vector<std::string_view> open;
    for (std::size_t at = 0; (at = text.find('<', at)) != text.npos;) {
        const std::size_t end = end_of_tag(text, at);
        if (end >= text.size()) {
            found.wrong = fmt::format("ends within {}", shortened(text.substr(at), 40));
            return found;
        }
        const std::string_view tag = text.substr(at + 1, end - at - 1);
        at = end + 1;
        if (tag.starts_with('?') || tag.starts_with('!')) continue;
        const bool closes = tag.starts_with('/');
        const std::string_view name =
            tag.substr(closes, tag.find_first_of(" \t\r\n/>", 1) - static_cast<std::size_t>(closes));
        if (closes && (open.empty() || open.back() != name))
            found.wrong = fmt::format("closes </{}>, which is not open", name);
        if (!closes && open.empty() && !found.tags.empty())
            found.wrong = "has more than one element at its root";
        if (!found.wrong.empty()) return found;
        if (closes) {
            open.pop_back();
            continue;
        }
        const auto colon = name.find(':');
        found.tags.push_back({tag, colon == name.npos ? name : name.substr(colon + 1)});
        if (!tag.ends_with('/')) open.push_back(name);
    }
    if (!open.empty()) found.wrong = fmt::format("does not close <{}>", open.back());
    if (found.tags.empty()) found.wrong = "is no SVG at all";
    return found;
}

// What an attribute has between its quotes.
std::optional<std::string_view> attribute_of(const Tag& tag, std::string_view name) {
    const std::string_view words = tag.words;
    for (std::size_t at = 0; (at = words.find(name, at + 1)) != words.npos;) {
        const std::size_t equals = words.find_first_not_of(" \t\r\n", at + name.size());
        if (kBetween.find(words[at - 1]) == kBetween.npos || equals == words.npos || words[equals] != '=')
            continue;
        const std::size_t quote = words.find_first_of("\"'", equals);
        if (quote == words.npos) return {};
        const std::size_t end = words.find(words[quote], quote + 1);
        return words.substr(quote + 1, end - quote - 1);
    }
    return {};
}

std::string why_no_points(const Tag& tag, std::size_t fewest) {
    const std::string_view points = attribute_of(tag, "points").value_or("");
    const NumberList list = numbers_in_list(points);
    const std::size_t count = list.numbers.size() / 2;
    if (!list.rest.empty())
        return fmt::format("'{}' in point {}, which is no number", shortened(list.rest, 40), count + 1);
    if (list.numbers.size() % 2 != 0) return fmt::format("an x without its y in point {}", count + 1);
    return count < fewest
               ? fmt::format("{} point{}, and takes {} or more", count, count == 1 ? "" : "s", fewest)
               : "";
}

// Pixels, as "12" or "12px".
std::string why_no_lengths(const Tag& tag, std::initializer_list<std::string_view> names,
                           std::size_t wanted) {
    std::size_t number = 0;
    for (const std::string_view name : names) {
        const bool is_wanted = number++ < wanted;
        const auto value = attribute_of(tag, name);
        if (!value && is_wanted) return fmt::format("no {}", name);
        if (!value) continue;
        std::string_view word = without_blanks(*value);
        if (word.ends_with("px")) word.remove_suffix(2);
        const NumberList list = numbers_in_list(word);
        if (list.numbers.size() != 1 || !list.rest.empty())
            return fmt::format("{} '{}', which is no number of pixels", name, shortened(*value, 40));
        if (is_wanted && list.numbers[0] < 0) return fmt::format("{} {}, which is below 0", name, *value);
    }
    return "";
}

std::string why_no_path(const Tag& tag) {
    const std::string_view d = without_blanks(attribute_of(tag, "d").value_or(""));
    constexpr std::string_view kCommands = "MmZzLlHhVvCcSsQqTtAa";
    if (d.empty() || (d[0] != 'M' && d[0] != 'm')) return "no d that begins with M";
    std::size_t numbers = 0;
    for (std::size_t at = 0; at < d.size();) {
        const std::size_t next = std::min(d.find_first_of(kCommands, at), d.size());
        const NumberList list = numbers_in_list(d.substr(at, next - at));
        if (!list.rest.empty()) return fmt::format("'{}' in d, which is no number", shortened(list.rest, 40));
        numbers += list.numbers.size();
        at = next + 1;
    }
    constexpr std::size_t kFewest = 3;  // a point, and where a line from it goes
    return numbers < kFewest ? "fewer than two points in d" : "";
}

constexpr std::array<std::string_view, 8> kShapes = {"circle",   "ellipse", "rect", "line",
                                                     "polyline", "polygon", "path", "text"};

// What a shape has wrong; empty where nothing is.
std::string wrong_of_shape(const Tag& tag) {
    if (tag.name == "polygon") return why_no_points(tag, 3);
    if (tag.name == "polyline") return why_no_points(tag, 2);
    if (tag.name == "circle") return why_no_lengths(tag, {"r", "cx", "cy"}, 1);
    if (tag.name == "ellipse") return why_no_lengths(tag, {"rx", "ry", "cx", "cy"}, 2);
    if (tag.name == "rect") return why_no_lengths(tag, {"width", "height", "x", "y"}, 2);
    if (tag.name == "line") return why_no_lengths(tag, {"x1", "y1", "x2", "y2"}, 0);
    if (tag.name == "text") return why_no_lengths(tag, {"x", "y"}, 0);
    return why_no_path(tag);
}

}  // namespace

NumberList numbers_in_list(std::string_view text) {
    NumberList list;
    while (true) {
        text.remove_prefix(std::min(text.find_first_not_of(kBetween), text.size()));
        list.rest = text;
        if (text.empty()) return list;
        const std::size_t plus = text.starts_with('+');
        double value = 0;
        const auto [end, error] = std::from_chars(text.data() + plus, text.data() + text.size(), value);
        if (error != std::errc() || !std::isfinite(value)) return list;
        list.numbers.push_back(value);
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
}

std::string why_no_fragment(std::string_view value) {
    std::string_view list = value.substr(std::min(value.find('=') + 1, value.size()));
    for (const std::string_view unit : {"pixel:", "percent:"})
        if (list.starts_with(unit)) list.remove_prefix(unit.size());
    const NumberList place = numbers_in_list(list);
    if (!value.starts_with("xywh=") || !place.rest.empty() || place.numbers.size() != 4)
        return fmt::format("FragmentSelector is \"{}\", not the four numbers xywh=x,y,width,height",
                           shortened(value));
    if (place.numbers[2] > 0 && place.numbers[3] > 0) return "";
    return fmt::format("FragmentSelector \"{}\" has a width or height of 0 or less", shortened(value));
}

std::string why_no_svg(std::string_view value) {
    const Elements elements = elements_of(value);
    if (!elements.wrong.empty()) return "SvgSelector " + elements.wrong;
    bool has_shape = false;
    for (const Tag& tag : elements.tags) {
        if (std::ranges::find(kShapes, tag.name) == kShapes.end()) continue;
        has_shape = true;
        if (const std::string wrong = wrong_of_shape(tag); !wrong.empty())
            return fmt::format("SvgSelector has a {} with {}", tag.name, wrong);
    }
    return has_shape ? "" : fmt::format("SvgSelector has no shape: {}", fmt::join(kShapes, ", "));
}

}  // namespace tangi
