#include "surface/publish/annotation_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/base/error.h"
#include "surface/base/html_escape.h"
#include "surface/base/json_text.h"
#include "surface/base/words.h"
#include "surface/publish/selector_check.h"
#include "surface/publish/svg_elements.h"
#include "surface/publish/svg_path.h"

namespace tangi {

using nlohmann::json;

namespace {

using Ring = std::vector<glm::dvec2>;
using Kind = AnnotationKind;

constexpr int kSamplesOfCircle = 64;  // as annotation.js: off by 0.0012 of the radius

std::string text_in(const json& object, const char* key) {
    if (!object.is_object()) return {};
    const json value = object.value(key, json());
    return value.is_string() ? value.get<std::string>() : std::string();
}

// Why a selector says no place, in words that follow "its"; empty where it does.
std::string why_no_place(const json& selector) {
    const std::string type = text_in(selector, "type"), value = text_in(selector, "value");
    if (type == "PointSelector")
        return selector.value("x", json()).is_number() && selector.value("y", json()).is_number()
                   ? ""
                   : "PointSelector has no numbers x and y";
    if (type == "FragmentSelector") return why_no_fragment(value);
    if (type == "SvgSelector") return why_no_svg(value);
    return fmt::format("selector is {}, none of SvgSelector, FragmentSelector and PointSelector",
                       type.empty() ? "missing" : type);
}

// x, y, width, height [pixels].
std::vector<double> box_of_fragment(std::string_view value, int width, int height) {
    value.remove_prefix(value.find("xywh=") + 5);
    const bool percent = value.starts_with("percent:");
    if (const auto colon = value.find(':'); colon != value.npos) value.remove_prefix(colon + 1);
    std::vector<double> box = numbers_in_list(value).numbers;
    const double sx = percent ? width / 100.0 : 1, sy = percent ? height / 100.0 : 1;
    return {box[0] * sx, box[1] * sy, box[2] * sx, box[3] * sy};
}

Ring ring_of_box(double x, double y, double width, double height) {
    return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

Ring ring_of_ellipse(const glm::dvec2& centre, const glm::dvec2& radii) {
    Ring ring;
    for (int i = 0; i < kSamplesOfCircle; ++i) {
        const double a = 2 * std::numbers::pi * i / kSamplesOfCircle;
        ring.push_back(centre + radii * glm::dvec2(std::cos(a), std::sin(a)));
    }
    return ring;
}

// An attribute's number; 0 where it is missing.
double number_of(const SvgElement& element, std::string_view name) {
    const NumberList list = numbers_in_list(attribute_of(element, name).value_or(""));
    return list.numbers.empty() ? 0 : list.numbers.front();
}

Ring points_of(const SvgElement& element) {
    const std::vector<double> v = numbers_in_list(attribute_of(element, "points").value_or("")).numbers;
    Ring ring;
    for (std::size_t i = 0; i + 1 < v.size(); i += 2) ring.emplace_back(v[i], v[i + 1]);
    return ring;
}

// Without the half pixel.
AnnotationShape shape_of_element(const SvgElement& element) {
    const auto of = [&](std::string_view name) { return number_of(element, name); };
    if (element.name == "text") return {Kind::text, {{{of("x"), of("y")}}}};
    if (element.name == "rect")
        return {Kind::polygon, {ring_of_box(of("x"), of("y"), of("width"), of("height"))}};
    if (element.name == "circle" && attribute_of(element, "class") == "point")
        return {Kind::point, {{{of("cx"), of("cy")}}}};
    if (element.name == "circle")
        return {Kind::polygon, {ring_of_ellipse({of("cx"), of("cy")}, glm::dvec2(of("r")))}};
    if (element.name == "ellipse")
        return {Kind::polygon, {ring_of_ellipse({of("cx"), of("cy")}, {of("rx"), of("ry")})}};
    if (element.name == "line") return {Kind::line, {{{of("x1"), of("y1")}, {of("x2"), of("y2")}}}};
    if (element.name == "polyline") return {Kind::line, {points_of(element)}};
    if (element.name == "polygon") return {Kind::polygon, {points_of(element)}};
    AnnotationShape shape{Kind::line, {}};
    for (SvgOutline& outline : outlines_of_path(attribute_of(element, "d").value_or(""))) {
        if (outline.closed) shape.kind = Kind::polygon;
        shape.rings.push_back(std::move(outline.points));
    }
    if (shape.rings.size() == 1 && shape.rings[0].size() == 1) shape.kind = Kind::point;
    if (shape.kind == Kind::polygon && shape.rings[0].size() < 3) shape.kind = Kind::line;
    return shape;
}

// Several closed shapes are one polygon; of others, the first is shown.
AnnotationShape shape_of_svg(std::string_view value) {
    std::vector<AnnotationShape> all;
    for (const SvgElement& element : svg_elements_of(value).all)
        if (is_svg_shape(element)) all.push_back(shape_of_element(element));
    AnnotationShape shape = all.front();
    const bool closed =
        std::ranges::all_of(all, [](const AnnotationShape& s) { return s.kind == Kind::polygon; });
    for (std::size_t i = 1; closed && i < all.size(); ++i)
        shape.rings.insert(shape.rings.end(), all[i].rings.begin(), all[i].rings.end());
    return shape;
}

std::string framed(const std::string& inner) {
    return "<svg xmlns=\"http://www.w3.org/2000/svg\">" + inner + "</svg>";
}

// [pixels of a selector] as annotation.js writes them.
double in_selector(double v) { return std::round(100 * (v + 0.5)) / 100 + 0.0; }

std::string pairs_of(const Ring& ring) {
    std::string text;
    for (const glm::dvec2& p : ring)
        text += fmt::format("{}{},{}", text.empty() ? "" : " ", in_selector(p.x), in_selector(p.y));
    return text;
}

}  // namespace

json selector_of(const json& target) {
    if (target.is_string()) {
        const std::string whole = target.get<std::string>();
        const auto hash = whole.find("#xywh=");
        if (hash == whole.npos || !why_no_fragment(std::string_view(whole).substr(hash + 1)).empty())
            return {};
        return {{"type", "FragmentSelector"}, {"value", whole.substr(hash + 1)}};
    }
    json all = target.is_object() ? target.value("selector", json()) : json();
    if (!all.is_array()) all = json::array({all});
    const auto found = std::ranges::find_if(all, [](const json& one) { return why_no_place(one).empty(); });
    return found == all.end() ? json() : *found;
}

std::string why_nowhere(const json& target) {
    if (target.is_string()) {
        const std::string_view whole = target.get_ref<const std::string&>();
        const auto hash = whole.find("#xywh=");
        return hash == whole.npos ? "target is a whole resource, without a selector"
                                  : why_no_fragment(whole.substr(hash + 1));
    }
    const json selector = target.is_object() ? target.value("selector", json()) : json();
    if (!selector.is_array()) return why_no_place(selector);
    std::string why = "target has an empty list of selectors";
    for (const json& one : selector)
        if (why = why_no_place(one); why.empty()) return "";
    return why;
}

AnnotationShape shape_of_selector(const json& selector, int width, int height) {
    AnnotationShape shape;
    if (selector["type"] == "PointSelector") {
        shape.rings = {{{selector["x"].get<double>(), selector["y"].get<double>()}}};
    } else if (selector["type"] == "FragmentSelector") {
        const std::vector<double> box = box_of_fragment(text_in(selector, "value"), width, height);
        shape = {Kind::polygon, {ring_of_box(box[0], box[1], box[2], box[3])}};
    } else {
        const std::string value = text_in(selector, "value");
        shape = shape_of_svg(value);
    }
    const auto is_none = [](const glm::dvec2& p) { return !std::isfinite(p.x) || !std::isfinite(p.y); };
    const auto has_none = [&](const Ring& ring) {
        return ring.empty() || std::ranges::any_of(ring, is_none);
    };
    if (shape.rings.empty() || std::ranges::any_of(shape.rings, has_none))
        fail("selector has a shape without numbers");
    for (Ring& ring : shape.rings)
        for (glm::dvec2& p : ring) p -= 0.5;
    return shape;
}

std::string svg_of_shape(const AnnotationShape& shape, const std::string& text, int side) {
    const Ring& ring = shape.rings.front();
    const double x = in_selector(ring[0].x), y = in_selector(ring[0].y);
    const auto size = [&](double part) { return std::round(10 * part * side) / 10; };
    switch (shape.kind) {
        case Kind::point:
            return framed(
                fmt::format(R"(<circle class="point" cx="{}" cy="{}" r="{}"/>)", x, y, size(0.005)));
        case Kind::line:
            return framed(fmt::format(R"(<polyline fill="none" points="{}"/>)", pairs_of(ring)));
        case Kind::text:
            return framed(fmt::format(R"(<text x="{}" y="{}" font-size="{}">{}</text>)", x, y, size(0.025),
                                      escaped(valid_utf8(text.substr(0, text.find('\n'))))));
        case Kind::polygon:
            break;
    }
    if (shape.rings.size() == 1) return framed(fmt::format(R"(<polygon points="{}"/>)", pairs_of(ring)));
    std::string d;
    for (const Ring& one : shape.rings) d += "M" + pairs_of(one) + "Z";
    return framed(fmt::format(R"(<path fill-rule="evenodd" d="{}"/>)", d));
}

std::string svg_of_selector(const json& selector, int width, int height) {
    if (selector["type"] == "SvgSelector") return selector["value"];
    if (selector["type"] == "FragmentSelector") {
        const std::vector<double> box = box_of_fragment(text_in(selector, "value"), width, height);
        return framed(
            fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}"/>)", box[0], box[1], box[2], box[3]));
    }
    return framed(fmt::format(R"(<circle cx="{}" cy="{}" r="{}"/>)", selector["x"].get<double>(),
                              selector["y"].get<double>(), 0.005 * std::max(width, height)));
}

}  // namespace tangi
