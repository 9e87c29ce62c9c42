// annotation_shape.h: where an annotation lies on a painting, and the selectors of Web Annotations that say
// it (REC-annotation-model-20170223, 4.2), as viewer/web/page/annotation.js reads and writes them.
#pragma once

#include <glm/vec2.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tangi {

enum class AnnotationKind { point, line, polygon, text };
inline constexpr int kAnnotationKinds = 4;

// In pixels of the painting, whole numbers are centres. In selectors pixels begin at whole numbers: half a
// pixel more.
struct AnnotationShape {
    AnnotationKind kind = AnnotationKind::point;
    std::vector<std::vector<glm::dvec2>> rings;  // one, but of polygons with holes or in parts

    friend bool operator==(const AnnotationShape&, const AnnotationShape&) = default;
};

// The first selector of a target that says where it lies, as {"type", "value"} or {"type", "x", "y"}; of a
// target that is an address with #xywh=, a FragmentSelector. Null where there is none: why_nowhere() says
// why.
nlohmann::json selector_of(const nlohmann::json& target);
// In words that follow "its"; empty where it says where.
std::string why_nowhere(const nlohmann::json& target);

// The shape that a sound selector (selector_of()) has on a painting of this size [pixels]. Throws Error, in
// words that follow "its", where it has no points that are numbers.
AnnotationShape shape_of_selector(const nlohmann::json& selector, int width, int height);

// An SvgSelector's value. `side` [pixels]: the painting's longer one, by which a point and a word are large
// enough to be seen. `text`: what is written there, of which a text shows the first line.
std::string svg_of_shape(const AnnotationShape& shape, const std::string& text, int side);

// As SVG: "xywh=percent:10,10,50,50" is a rectangle, a PointSelector a circle.
std::string svg_of_selector(const nlohmann::json& selector, int width, int height);

}  // namespace tangi
