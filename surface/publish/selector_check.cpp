#include "surface/publish/selector_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "surface/base/json_text.h"
#include "surface/base/words.h"
#include "surface/publish/svg_elements.h"

namespace tangi {

namespace {

std::string why_no_points(const SvgElement& element, std::size_t fewest) {
    const std::string_view points = attribute_of(element, "points").value_or("");
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
std::string why_no_lengths(const SvgElement& element, std::initializer_list<std::string_view> names,
                           std::size_t wanted) {
    std::size_t number = 0;
    for (const std::string_view name : names) {
        const bool is_wanted = number++ < wanted;
        const auto value = attribute_of(element, name);
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

std::string why_no_path(const SvgElement& element) {
    const std::string_view d = without_blanks(attribute_of(element, "d").value_or(""));
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

// What a shape has wrong; empty where nothing is.
std::string wrong_of_shape(const SvgElement& element) {
    if (element.name == "polygon") return why_no_points(element, 3);
    if (element.name == "polyline") return why_no_points(element, 2);
    if (element.name == "circle") return why_no_lengths(element, {"r", "cx", "cy"}, 1);
    if (element.name == "ellipse") return why_no_lengths(element, {"rx", "ry", "cx", "cy"}, 2);
    if (element.name == "rect") return why_no_lengths(element, {"width", "height", "x", "y"}, 2);
    if (element.name == "line") return why_no_lengths(element, {"x1", "y1", "x2", "y2"}, 0);
    if (element.name == "text") return why_no_lengths(element, {"x", "y"}, 0);
    return why_no_path(element);
}

}  // namespace

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
    const SvgElements elements = svg_elements_of(value);
    if (!elements.wrong.empty()) return "SvgSelector " + elements.wrong;
    bool has_shape = false;
    for (const SvgElement& element : elements.all) {
        if (!is_svg_shape(element)) continue;
        has_shape = true;
        if (const std::string wrong = wrong_of_shape(element); !wrong.empty())
            return fmt::format("SvgSelector has a {} with {}", element.name, wrong);
    }
    return has_shape ? "" : fmt::format("SvgSelector has no shape: {}", fmt::join(kSvgShapes, ", "));
}

}  // namespace tangi
