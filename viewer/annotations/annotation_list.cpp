#include "viewer/annotations/annotation_list.h"

#include <algorithm>
#include <array>
#include <utility>

#include "surface/base/json_text.h"

namespace tangi {

namespace {

std::shared_ptr<const Annotation> annotation_of(nlohmann::json json, const AnnotatedPicture& picture) {
    Annotation annotation;
    annotation.id = json["id"];
    annotation.shape = shape_of_selector(selector_of(json["target"]), picture.width, picture.height);
    annotation.text = valid_utf8(text_of_annotation(json));
    annotation.view = view_of_annotation(json);
    annotation.json = std::move(json);
    return std::make_shared<const Annotation>(std::move(annotation));
}

auto place_in(const Annotations& annotations, const std::string& id) {
    return std::ranges::find_if(annotations, [&](const auto& one) { return one->id == id; });
}

bool is_same(const std::shared_ptr<const Annotation>& a, const std::shared_ptr<const Annotation>& b) {
    return a->json == b->json;
}

}  // namespace

Annotations annotations_of(const nlohmann::json& items, const AnnotatedPicture& picture) {
    Annotations annotations;
    for (const nlohmann::json& item : items) annotations.push_back(annotation_of(item, picture));
    return annotations;
}

nlohmann::json json_of(const Annotations& annotations) {
    nlohmann::json items = nlohmann::json::array();
    for (const auto& annotation : annotations) items.push_back(annotation->json);
    return items;
}

std::shared_ptr<const Annotation> annotation_in(const Annotations& annotations, const std::string& id) {
    const auto found = place_in(annotations, id);
    return found == annotations.end() ? nullptr : *found;
}

const char* name_of(AnnotationKind kind) {
    constexpr std::array kNames = {"Point", "Line", "Polygon", "Text"};
    return kNames[static_cast<std::size_t>(kind)];
}

std::string title_of(const Annotation& annotation) {
    const std::string line = annotation.text.substr(0, annotation.text.find('\n'));
    return line.empty() ? name_of(annotation.shape.kind) : line;
}

void AnnotationList::step(Annotations next, std::string what, bool goes_on) {
    const bool same_step = goes_on && !what.empty() && what == last_;
    if (!same_step) past_.push_back(now_);
    future_.clear();
    now_ = std::move(next);
    last_ = std::move(what);
}

void AnnotationList::change(const std::string& id, const AnnotationChange& by, bool goes_on) {
    const auto found = place_in(now_, id);
    if (found == now_.end()) return;
    Annotations next = now_;
    next[static_cast<std::size_t>(found - now_.begin())] =
        annotation_of(changed_annotation((*found)->json, by, picture_), picture_);
    step(std::move(next), (by.text ? "text " : by.shape ? "shape " : "view ") + id, goes_on);
}

std::string AnnotationList::add(const AnnotationShape& shape, const std::string& view) {
    Annotations next = now_;
    next.push_back(annotation_of(new_annotation(shape, view, picture_), picture_));
    const std::string id = next.back()->id;
    step(std::move(next));
    return id;
}

void AnnotationList::reshape(const std::string& id, const AnnotationShape& shape, bool goes_on) {
    change(id, {.shape = shape}, goes_on);
}

void AnnotationList::set_text(const std::string& id, const std::string& text, bool goes_on) {
    change(id, {.text = text}, goes_on);
}

void AnnotationList::set_view(const std::string& id, const std::string& view) {
    change(id, {.view = view}, false);
}

void AnnotationList::remove(const std::string& id) {
    Annotations next = now_;
    if (std::erase_if(next, [&](const auto& one) { return one->id == id; }) > 0) step(std::move(next));
}

void AnnotationList::merge(const Annotations& more) {
    Annotations next = now_;
    for (const auto& one : more) {
        const auto found = place_in(next, one->id);
        if (found == next.end())
            next.push_back(one);
        else
            next[static_cast<std::size_t>(found - next.begin())] = one;
    }
    replace(std::move(next));
}

void AnnotationList::replace(Annotations all) {
    if (!std::ranges::equal(all, now_, is_same)) step(std::move(all));
}

void AnnotationList::undo() {
    if (past_.empty()) return;
    future_.push_back(std::exchange(now_, std::move(past_.back())));
    past_.pop_back();
    last_.clear();
}

void AnnotationList::redo() {
    if (future_.empty()) return;
    past_.push_back(std::exchange(now_, std::move(future_.back())));
    future_.pop_back();
    last_.clear();
}

}  // namespace tangi
