#include "surface/publish/web_annotations.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <random>

#include "surface/base/error.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/publish/svg_elements.h"

namespace tangi {

using nlohmann::json;

namespace {

constexpr const char* kContext = "http://www.w3.org/ns/anno.jsonld";
constexpr const char* kViewType = "urn:tangipaint:View";  // as viewer/web/page/annotation.js has it

json as_list(const json& value) {
    return value.is_array() ? value : value.is_null() ? json::array() : json::array({value});
}

json first_in(const json& value) {
    return value.is_array() ? (value.empty() ? json() : value.front()) : value;
}

json in(const json& object, const char* key) {
    return object.is_object() ? object.value(key, json()) : json();
}

std::string word_of(const json& object, const char* key) {
    const json value = in(object, key);
    return value.is_string() ? value.get<std::string>() : std::string();
}

// The list in a file of any of the kinds that hold annotations; null where it is none.
json items_of(const json& read) {
    if (read.is_array()) return read;
    if (!read.is_object()) return {};
    if (word_of(read, "type") == "Annotation") return json::array({read});
    if (word_of(read, "type") == "Manifest") {
        json all = json::array();
        for (const json& page : as_list(in(first_in(in(read, "items")), "annotations")))
            for (const json& item : as_list(in(page, "items"))) all.push_back(item);
        return all;
    }
    if (read.contains("items")) return read["items"];
    return in(in(read, "first"), "items");
}

json bodies_of(const json& annotation) {
    if (const std::string value = word_of(annotation, "bodyValue"); !value.empty())
        return json::array({{{"type", "TextualBody"}, {"value", value}}});
    return as_list(in(annotation, "body"));
}

// Why nothing can be drawn of a target, in words that follow "its"; empty where something can.
std::string why_unplaced(const json& target) {
    constexpr int kAnySide = 100'000;  // [pixels] parts of the picture are numbers on one of any size
    if (std::string why = why_nowhere(target); !why.empty()) return why;
    try {
        (void)shape_of_selector(selector_of(target), kAnySide, kAnySide);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

// RFC 9562, version 4.
std::string new_id() {
    std::random_device random;
    std::array<std::uint8_t, 16> bytes{};
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    bytes[6] = static_cast<std::uint8_t>((bytes[6] & 0x0f) | 0x40);
    bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3f) | 0x80);
    std::string id = "urn:uuid:";
    for (std::size_t i = 0; i < bytes.size(); ++i)
        id += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", bytes[i]);
    return id;
}

// As xsd:dateTime, which dates of Web Annotations are.
std::string now() {
    const auto time = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
}

void set_text(json& annotation, const std::string& text) {
    json bodies = json::array({{{"type", "TextualBody"},
                                {"purpose", "describing"},
                                {"format", "text/plain"},
                                {"value", valid_utf8(text)}}});
    for (const json& body : bodies_of(annotation))
        if (body.is_object() && word_of(body, "type") != "TextualBody") bodies.push_back(body);
    annotation["body"] = bodies;
    annotation.erase("bodyValue");
}

}  // namespace

json read_annotations(const std::string& file, const std::string& named) {
    if (file.empty()) return json::array();
    const json items = items_of(read_json(read_text_file(file), file));
    if (!items.is_array())
        fail(
            "{}: is no AnnotationPage of W3C Web Annotations: it has no list 'items'; download one from the "
            "page of export --to web",
            named);
    json annotations = json::array();
    std::map<std::string, std::size_t> numbers;  // of items, by their ids
    for (json item : items) {
        const std::size_t number = annotations.size() + 1;
        std::string place = fmt::format("{}: item {}", named, number);
        if (word_of(item, "type") != "Annotation" || !item.contains("target"))
            fail("{} is no Annotation with a target; remove it, or give it both", place);
        std::string id = word_of(item, "id");
        if (!id.empty()) place += fmt::format(" (\"{}\")", shortened(id));
        json& target = item["target"];
        if (target.is_array()) target = first_in(target);  // one picture is published
        if (const std::string why = why_unplaced(target); !why.empty())
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
    std::string text;
    for (const json& one : bodies_of(annotation)) {
        const std::string line = one.is_string() ? one.get<std::string>() : word_of(one, "value");
        if (!line.empty()) text += (text.empty() ? "" : "\n") + line;
    }
    return text;
}

std::string view_of_annotation(const json& annotation) {
    for (const json& state : as_list(in(annotation["target"], "state")))
        if (word_of(state, "type") == kViewType) return word_of(state, "value");
    return {};
}

std::string_view word_in_view(std::string_view view, std::string_view name) {
    while (!view.empty()) {
        const std::string_view word = view.substr(0, view.find('&'));
        view.remove_prefix(std::min(word.size() + 1, view.size()));
        if (word.size() > name.size() && word.starts_with(name) && word[name.size()] == '=')
            return word.substr(name.size() + 1);
    }
    return {};
}

std::optional<double> number_in_view(std::string_view view, std::string_view name) {
    const std::vector<double> value = numbers_in_list(word_in_view(view, name)).numbers;
    return value.empty() ? std::nullopt : std::optional(value.front());
}

json new_annotation(const AnnotationShape& shape, const std::string& view, const AnnotatedPicture& picture) {
    json annotation = {
        {"@context", kContext}, {"id", new_id()},
        {"type", "Annotation"}, {"motivation", "commenting"},
        {"created", now()},     {"target", {{"type", "SpecificResource"}, {"source", picture.source}}}};
    return changed_annotation(std::move(annotation), {.shape = shape, .text = "", .view = view}, picture);
}

json changed_annotation(json annotation, const AnnotationChange& change, const AnnotatedPicture& picture) {
    annotation["modified"] = now();
    const json selector = selector_of(annotation["target"]);
    json& target = annotation["target"];
    if (!target.is_object()) {
        const std::string source = target.get<std::string>();
        target = {{"type", "SpecificResource"}, {"source", source.substr(0, source.find('#'))}};
        target["selector"] = selector;
    }
    if (change.text) set_text(annotation, *change.text);
    std::optional<AnnotationShape> shape = change.shape;
    if (!shape && change.text) {  // which a word on the painting shows
        shape = shape_of_selector(selector, picture.width, picture.height);
        if (shape->kind != AnnotationKind::text) shape.reset();
    }
    if (shape)
        target["selector"] = {{"type", "SvgSelector"},
                              {"value", svg_of_shape(*shape, text_of_annotation(annotation),
                                                     std::max(picture.width, picture.height))}};
    if (change.view) target["state"] = {{"type", kViewType}, {"value", *change.view}};
    return annotation;
}

std::string text_of_page(const json& annotations) {
    return json_lines(
        {{"@context", kContext}, {"id", new_id()}, {"type", "AnnotationPage"}, {"items", annotations}});
}

}  // namespace tangi
