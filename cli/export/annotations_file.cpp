#include "cli/export/annotations_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "cli/export/selector_check.h"
#include "surface/base/error.h"
#include "surface/base/html_escape.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr const char* kViewType = "urn:tangipaint:View";  // as viewer/web/page/annotation.js has it

json first_of(const json& value) {
    return value.is_array() ? (value.empty() ? json() : value.front()) : value;
}

std::string text_in(const json& object, const char* key) {
    if (!object.is_object()) return {};
    const json value = object.value(key, json());
    return value.is_string() ? value.get<std::string>() : std::string();
}

// The list in a file of any of the kinds that hold annotations; null where it is none.
json items_of(const json& read) {
    if (read.is_array()) return read;
    if (!read.is_object()) return {};
    if (text_in(read, "type") == "Annotation") return json::array({read});
    if (text_in(read, "type") == "Manifest") {
        json all = json::array();
        const json canvas = first_of(read.value("items", json()));
        for (const json& page :
             canvas.is_object() ? canvas.value("annotations", json::array()) : json::array())
            for (const json& item : page.value("items", json::array())) all.push_back(item);
        return all;
    }
    if (read.contains("items")) return read["items"];
    const json first = read.value("first", json());
    return first.is_object() ? first.value("items", json()) : json();
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

// "xywh=percent:10,10,50,50" as a rectangle.
std::string svg_of_fragment(std::string_view value, int width, int height) {
    value.remove_prefix(value.find("xywh=") + 5);
    const bool percent = value.starts_with("percent:");
    if (const auto colon = value.find(':'); colon != value.npos) value.remove_prefix(colon + 1);
    const std::vector<double> v = numbers_in_list(value).numbers;
    const double sx = percent ? width / 100.0 : 1, sy = percent ? height / 100.0 : 1;
    return fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}"/>)", v[0] * sx, v[1] * sy, v[2] * sx,
                       v[3] * sy);
}

std::string svg_of(const json& target, int width, int height) {
    const auto framed = [](const std::string& inner) {
        return "<svg xmlns=\"http://www.w3.org/2000/svg\">" + inner + "</svg>";
    };
    if (target.is_string()) return framed(svg_of_fragment(target.get<std::string>(), width, height));
    const json all = target["selector"].is_array() ? target["selector"] : json::array({target["selector"]});
    const auto found = std::ranges::find_if(all, [](const json& one) { return why_no_place(one).empty(); });
    const json& selector = *found;
    if (selector["type"] == "SvgSelector") return selector["value"];
    if (selector["type"] == "FragmentSelector")
        return framed(svg_of_fragment(selector["value"].get<std::string>(), width, height));
    return framed(fmt::format(R"(<circle cx="{}" cy="{}" r="{}"/>)", selector["x"].get<double>(),
                              selector["y"].get<double>(), 0.005 * std::max(width, height)));
}

// A number of the words of a view: "azimuth=135&elevation=20&…".
std::optional<double> word_in(std::string_view words, std::string_view name) {
    while (!words.empty()) {
        const std::string_view word = words.substr(0, words.find('&'));
        words.remove_prefix(std::min(word.size() + 1, words.size()));
        if (word.size() <= name.size() || !word.starts_with(name) || word[name.size()] != '=') continue;
        const std::vector<double> value = numbers_in_list(word.substr(name.size() + 1)).numbers;
        return value.empty() ? std::nullopt : std::optional(value.front());
    }
    return {};
}

// x, y of the light that an annotation keeps; null where it keeps none.
json light_of(const json& target) {
    const json states = target.is_object() ? target.value("state", json()) : json();
    for (const json& state : states.is_array() ? states : json::array({states})) {
        if (text_in(state, "type") != kViewType) continue;
        const std::string words = text_in(state, "value");
        const auto azimuth = word_in(words, "azimuth"), elevation = word_in(words, "elevation");
        if (!azimuth || !elevation) continue;
        const double a = *azimuth * std::numbers::pi / 180, e = *elevation * std::numbers::pi / 180;
        return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e)};
    }
    return {};
}

}  // namespace

json read_annotations(const std::string& file) {
    if (file.empty()) return json::array();
    const json items = items_of(read_json(read_text_file(file), file));
    if (!items.is_array())
        fail(
            "--annotations {}: is no AnnotationPage of W3C Web Annotations: it has no list 'items'; download "
            "one from the page of export --to web",
            file);
    json annotations = json::array();
    std::map<std::string, std::size_t> numbers;  // of items, by their ids
    for (json item : items) {
        const std::size_t number = annotations.size() + 1;
        std::string place = fmt::format("--annotations {}: item {}", file, number);
        if (text_in(item, "type") != "Annotation" || !item.contains("target"))
            fail("{} is no Annotation with a target; remove it, or give it both", place);
        std::string id = text_in(item, "id");
        if (!id.empty()) place += fmt::format(" (\"{}\")", shortened(id));
        json& target = item["target"];
        if (target.is_array()) target = first_of(target);  // one picture is published
        if (const std::string why = why_nowhere(target); !why.empty())
            fail("{}: its {}; correct the selector, or remove the item", place, why);
        if (id.empty()) item["id"] = id = fmt::format("urn:tangipaint:annotation:{}", number);
        if (const auto [other, is_new] = numbers.emplace(id, number); !is_new)
            fail("{}: has the id of item {}; give it another one, or remove one of them", place,
                 other->second);
        annotations.push_back(std::move(item));
    }
    return annotations;
}

std::string text_of_annotation(const json& annotation) {
    if (std::string value = text_in(annotation, "bodyValue"); !value.empty()) return value;
    const json body = annotation.value("body", json());
    std::string text;
    for (const json& one : body.is_array() ? body : json::array({body})) {
        const std::string line = one.is_string() ? one.get<std::string>() : text_in(one, "value");
        if (!line.empty()) text += (text.empty() ? "" : "\n") + line;
    }
    return text;
}

json openlime_annotations(const json& annotations, int width, int height) {
    json all = json::array();
    for (const json& annotation : annotations) {
        const std::size_t number = all.size() + 1;
        const std::string text = valid_utf8(text_of_annotation(annotation)),
                          line = text.substr(0, text.find('\n'));
        json data = {{"idx", number}};
        if (const json light = light_of(annotation["target"]); !light.is_null()) data["light"] = light;
        all.push_back({{"id", fmt::format("note-{}", number)},
                       {"label", escaped(line.empty() ? fmt::format("Annotation {}", number) : line)},
                       {"description", escaped(text)},
                       {"class", "note"},
                       {"svg", svg_of(annotation["target"], width, height)},
                       {"data", data}});
    }
    return all;
}

}  // namespace tangi
