#include "surface/publish/svg_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "surface/base/json_text.h"

namespace tangi {

namespace {

constexpr std::string_view kBetween = " \t\r\n,";

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

}  // namespace

SvgElements svg_elements_of(std::string_view text) {
    SvgElements found;
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
        if (!closes && open.empty() && !found.all.empty())
            found.wrong = "has more than one element at its root";
        if (!found.wrong.empty()) return found;
        if (closes) {
            open.pop_back();
            continue;
        }
        const auto colon = name.find(':');
        found.all.push_back({tag, colon == name.npos ? name : name.substr(colon + 1)});
        if (!tag.ends_with('/')) open.push_back(name);
    }
    if (!open.empty()) found.wrong = fmt::format("does not close <{}>", open.back());
    if (found.all.empty()) found.wrong = "is no SVG at all";
    return found;
}

std::optional<std::string_view> attribute_of(const SvgElement& element, std::string_view name) {
    const std::string_view words = element.words;
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

bool is_svg_shape(const SvgElement& element) {
    return std::ranges::find(kSvgShapes, element.name) != kSvgShapes.end();
}

}  // namespace tangi
