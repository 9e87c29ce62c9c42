// svg_path.h: the outlines of a path of SVG 1.1 (8.3), curves and arcs as short straight lines.
#pragma once

#include <glm/vec2.hpp>
#include <string_view>
#include <vector>

namespace tangi {

struct SvgOutline {
    std::vector<glm::dvec2> points;
    bool closed = false;
};

// Of what is given as d. It ends before the first command of which a number is missing; outlines without a
// point are left out.
std::vector<SvgOutline> outlines_of_path(std::string_view d);

}  // namespace tangi
