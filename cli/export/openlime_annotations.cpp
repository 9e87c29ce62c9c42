#include "cli/export/openlime_annotations.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "surface/base/html_escape.h"
#include "surface/base/json_text.h"
#include "surface/publish/web_annotations.h"

namespace tangi {

using nlohmann::json;

namespace {

// x, y of the light that an annotation keeps; null where it keeps none.
json light_of(const json& annotation) {
    const std::string words = view_of_annotation(annotation);
    const auto azimuth = number_in_view(words, "azimuth"), elevation = number_in_view(words, "elevation");
    if (!azimuth || !elevation) return {};
    const double a = *azimuth * std::numbers::pi / 180, e = *elevation * std::numbers::pi / 180;
    return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e)};
}

}  // namespace

json openlime_annotations(const json& annotations, int width, int height) {
    json all = json::array();
    for (const json& annotation : annotations) {
        const std::size_t number = all.size() + 1;
        const std::string text = valid_utf8(text_of_annotation(annotation)),
                          line = text.substr(0, text.find('\n'));
        json data = {{"idx", number}};
        if (const json light = light_of(annotation); !light.is_null()) data["light"] = light;
        all.push_back({{"id", fmt::format("note-{}", number)},
                       {"label", escaped(line.empty() ? fmt::format("Annotation {}", number) : line)},
                       {"description", escaped(text)},
                       {"class", "note"},
                       {"svg", svg_of_selector(selector_of(annotation["target"]), width, height)},
                       {"data", data}});
    }
    return all;
}

}  // namespace tangi
