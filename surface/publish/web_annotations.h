// web_annotations.h: W3C Web Annotations (REC-annotation-model-20170223): of files, as exports, the window
// and web pages share them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "surface/publish/annotation_shape.h"

namespace tangi {

// The annotations of an AnnotationPage, of an AnnotationCollection with its first page, of a IIIF manifest's
// canvas, of a list, or the one that the file is; "" gives none. Each is an object of the type Annotation
// that has an id of its own, and whose target has a selector that says where it lies: an SvgSelector, a
// FragmentSelector (xywh=; selector_check.h) or a PointSelector. Throws Error naming the file as `named`
// ("--annotations FILE"), the item and the remedy.
nlohmann::json read_annotations(const std::string& file, const std::string& named);

// What people read of one: its textual bodies, a line each.
std::string text_of_annotation(const nlohmann::json& annotation);
// The view that it keeps, as words: what is behind the # of a link to it (docs/guide/web-export.md); "" where
// it keeps none.
std::string view_of_annotation(const nlohmann::json& annotation);
// A number of these words: "azimuth=135&elevation=20&…".
std::optional<double> number_in_view(std::string_view view, std::string_view name);
// The word itself; "" where it is missing.
std::string_view word_in_view(std::string_view view, std::string_view name);

// What is annotated: an IRI, and its size [pixels].
struct AnnotatedPicture {
    std::string source;
    int width = 0, height = 0;
};

// What of one is to be another; whatever else it holds stays as it is.
struct AnnotationChange {
    std::optional<AnnotationShape> shape{};
    std::optional<std::string> text{}, view{};
};
nlohmann::json new_annotation(const AnnotationShape& shape, const std::string& view,
                              const AnnotatedPicture& picture);
nlohmann::json changed_annotation(nlohmann::json annotation, const AnnotationChange& change,
                                  const AnnotatedPicture& picture);

// An AnnotationPage of them, as text: what files of annotations are.
std::string text_of_page(const nlohmann::json& annotations);

}  // namespace tangi
