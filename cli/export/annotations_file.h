// annotations_file.h: W3C Web Annotations of a file, as exports take them along.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace tangi {

// The annotations of an AnnotationPage, of an AnnotationCollection with its first page, of a IIIF manifest's
// canvas, of a list, or the one that the file is; "" gives none. Each is an object of the type Annotation
// that has an id of its own, and whose target has a selector that says where it lies: an SvgSelector, a
// FragmentSelector (xywh=; selector_check.h) or a PointSelector. Throws Error naming the file, the item and
// the remedy.
nlohmann::json read_annotations(const std::string& file);

// What people read of one: its textual bodies, a line each.
std::string text_of_annotation(const nlohmann::json& annotation);

// As the SVG layer of OpenLIME 1.2.6 takes them ("label", "description" as HTML, "svg", "class", "data" with
// "idx" and, where the annotation keeps a view (docs/guide/web-export.md), "light": x, y of the direction to
// the light). Pixels of the picture.
nlohmann::json openlime_annotations(const nlohmann::json& annotations, int width, int height);

}  // namespace tangi
