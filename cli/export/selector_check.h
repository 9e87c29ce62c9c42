// selector_check.h: what is wrong with a selector of a Web Annotation, by what a page shows of it.
#pragma once

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

// These say why it selects no place, in words that follow "its"; empty where it does.

// "xywh=10,10,50,50", also with pixel: or percent: before the numbers.
std::string why_no_fragment(std::string_view value);
// A piece of SVG (REC-annotation-model, 4.2.4): well-formed, with a shape, whose numbers are there: three
// points of a polygon, two of a line, a rectangle's width.
std::string why_no_svg(std::string_view value);

}  // namespace tangi
