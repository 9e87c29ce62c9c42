// openlime_annotations.h: Web Annotations as OpenLIME shows them.
#pragma once

#include <nlohmann/json.hpp>

namespace tangi {

// As the SVG layer of OpenLIME 1.2.6 takes them ("label", "description" as HTML, "svg", "class", "data" with
// "idx" and, where the annotation keeps a view (docs/guide/web-export.md), "light": x, y of the direction to
// the light). Pixels of the picture. `annotations`: as read_annotations() (surface/publish/web_annotations.h)
// gives them.
nlohmann::json openlime_annotations(const nlohmann::json& annotations, int width, int height);

}  // namespace tangi
