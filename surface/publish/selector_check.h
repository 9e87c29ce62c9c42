// selector_check.h: what is wrong with a selector of a Web Annotation, by what a page shows of it.
#pragma once

#include <string>
#include <string_view>

namespace tangi {

// These say why it selects no place, in words that follow "its"; empty where it does.

// "xywh=10,10,50,50", also with pixel: or percent: before the numbers.
std::string why_no_fragment(std::string_view value);
// A piece of SVG (REC-annotation-model, 4.2.4): well-formed, with a shape, whose numbers are there: three
// points of a polygon, two of a line, a rectangle's width.
std::string why_no_svg(std::string_view value);

}  // namespace tangi
