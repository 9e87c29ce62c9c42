// annotation_list.h: the annotations of a painting, and what was done to them, which can be undone.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "surface/publish/web_annotations.h"

namespace tangi {

struct Annotation {
    std::string id;
    nlohmann::json json;  // as files have it (surface/publish/web_annotations.h)
    AnnotationShape shape;
    std::string text, view;  // view: words (viewer/model/view_words.h); empty where it keeps none
};
using Annotations = std::vector<std::shared_ptr<const Annotation>>;

// Of what read_annotations() gave.
Annotations annotations_of(const nlohmann::json& items, const AnnotatedPicture& picture);
nlohmann::json json_of(const Annotations& annotations);
// Null where there is none of this id.
std::shared_ptr<const Annotation> annotation_in(const Annotations& annotations, const std::string& id);
// "Polygon"; what it is called in a list: its first line, else its kind.
const char* name_of(AnnotationKind kind);
std::string title_of(const Annotation& annotation);

class AnnotationList {
public:
    AnnotationList() = default;
    // As a file has them: there is nothing to undo.
    AnnotationList(Annotations saved, AnnotatedPicture picture)
        : now_(saved), saved_(std::move(saved)), picture_(std::move(picture)) {}

    const Annotations& now() const { return now_; }
    const AnnotatedPicture& picture() const { return picture_; }
    // An IRI of the painting, for those that are added from now on.
    void set_source(std::string source) { picture_.source = std::move(source); }

    // Each is one step. Where it `goes_on`, it belongs to the step before, if that did the same to the same
    // annotation: a text that is typed, a corner that is dragged. Ids of annotations that are not there do
    // nothing.
    std::string add(const AnnotationShape& shape, const std::string& view);  // its id
    void reshape(const std::string& id, const AnnotationShape& shape, bool goes_on);
    void set_text(const std::string& id, const std::string& text, bool goes_on);
    void set_view(const std::string& id, const std::string& view);
    void remove(const std::string& id);
    // One of the same id as one that is there replaces it.
    void merge(const Annotations& more);
    void replace(Annotations all);  // one step, unless they are those that are there

    bool can_undo() const { return !past_.empty(); }
    bool can_redo() const { return !future_.empty(); }
    void undo();
    void redo();

    // Other ones than in the file.
    bool unsaved() const { return now_ != saved_; }
    void is_saved() { saved_ = now_; }

private:
    void change(const std::string& id, const AnnotationChange& by, bool goes_on);
    void step(Annotations next, std::string what = {}, bool goes_on = false);

    Annotations now_, saved_;
    AnnotatedPicture picture_;
    std::vector<Annotations> past_, future_;
    std::string last_;  // step, if more may belong to it
};

}  // namespace tangi
