// svg_elements.h: the elements of a piece of SVG with their attributes, and lists of numbers in these: as
// much of SVG as selectors of Web Annotations hold.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tangi {

// Numbers one after the other, with blanks and commas between them as in the lists of SVG; `rest` begins at
// the first word that is none, or is not finite.
struct NumberList {
    std::vector<double> numbers;
    std::string_view rest;
};
NumberList numbers_in_list(std::string_view text);

// Views of the text that it was read from.
struct SvgElement {
    std::string_view words;  // polygon points="1,2 3,4"
    std::string_view name;   // without that of its space
};

struct SvgElements {
    std::vector<SvgElement> all;  // as they begin
    std::string wrong;            // why the text is no well-formed piece of XML with one element at its root
};
SvgElements svg_elements_of(std::string_view text);

// What an attribute has between its quotes.
std::optional<std::string_view> attribute_of(const SvgElement& element, std::string_view name);

// Those that select a place.
inline constexpr std::array<std::string_view, 8> kSvgShapes = {"circle",   "ellipse", "rect", "line",
                                                               "polyline", "polygon", "path", "text"};
bool is_svg_shape(const SvgElement& element);

}  // namespace tangi
