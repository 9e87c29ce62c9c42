// treatment_annotations.cpp: damage maps for other programs: W3C Web Annotations, IIIF Presentation 3.
#include <algorithm>

#include "paint/retouch/treatment_report.h"

namespace tangi {

using nlohmann::json;

namespace {

std::string words(DamageClass damage) {
    std::string text(name_of(damage));
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

// One annotation a class; coordinates are pixels of the picture, as SVG selectors have them.
json annotation(const Treatment& treatment, DamageClass damage, const std::string& id, const json& source) {
    const Mask mask = treatment.mask(damage);
    const MaskArea area = area_of(mask, treatment.mm_per_pixel());
    const std::string svg =
        fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\"><path fill-rule=\"evenodd\" d=\"{}\"/></svg>",
                    svg_path(outlines_of(mask)));
    return {{"id", id},
            {"type", "Annotation"},
            {"motivation", "classifying"},
            {"body",
             {{{"type", "TextualBody"},
               {"purpose", "tagging"},
               {"format", "text/plain"},
               {"language", "en"},
               {"value", words(damage)}},
              {{"type", "TextualBody"},
               {"purpose", "describing"},
               {"format", "text/plain"},
               {"language", "en"},
               {"value",
                fmt::format("{} areas, {:.3g} cm², {:.3g} %", area.regions, area.mm2 / 100, area.percent)}}}},
            {"target", {{"source", source}, {"selector", {{"type", "SvgSelector"}, {"value", svg}}}}}};
}

}  // namespace

std::string svg_path(const std::vector<Polygon>& polygons, double scale) {
    std::string path;
    for (const Polygon& polygon : polygons) {
        for (std::size_t i = 0; i < polygon.size(); ++i)
            path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", polygon[i].x * scale,
                                polygon[i].y * scale);
        path += "Z";
    }
    return path;
}

json web_annotations(const Treatment& treatment, const std::string& target) {
    json items = json::array();
    for (const DamageClass damage : kDamageClasses)
        if (treatment.has_mask(damage))
            items.push_back(annotation(
                treatment, damage,
                fmt::format("urn:tangipaint:{}:{}", treatment.log().head().substr(0, 16), name_of(damage)),
                target));
    return {{"@context", "http://www.w3.org/ns/anno.jsonld"},
            {"id", fmt::format("urn:tangipaint:{}", treatment.log().head())},
            {"type", "AnnotationPage"},
            {"items", items}};
}

json iiif_manifest(const Treatment& treatment, const std::string& picture) {
    const std::string base = fmt::format("urn:tangipaint:{}", treatment.log().head());
    const std::string canvas = base + "/canvas/1";
    json annotations = json::array();
    for (const DamageClass damage : kDamageClasses)
        if (treatment.has_mask(damage))
            annotations.push_back(annotation(treatment, damage,
                                             fmt::format("{}/annotation/{}", base, name_of(damage)),
                                             {{"id", canvas}, {"type", "Canvas"}}));
    const json painting = {{"id", base + "/annotation/picture"},
                           {"type", "Annotation"},
                           {"motivation", "painting"},
                           {"target", canvas},
                           {"body",
                            {{"id", picture},
                             {"type", "Image"},
                             {"format", "image/jpeg"},
                             {"width", treatment.width()},
                             {"height", treatment.height()}}}};
    return {
        {"@context", "http://iiif.io/api/presentation/3/context.json"},
        {"id", base + "/manifest"},
        {"type", "Manifest"},
        {"label", {{"en", {treatment.folder().filename().string() + ": damage map"}}}},
        {"items",
         {{{"id", canvas},
           {"type", "Canvas"},
           {"width", treatment.width()},
           {"height", treatment.height()},
           {"items", {{{"id", base + "/page/picture"}, {"type", "AnnotationPage"}, {"items", {painting}}}}},
           {"annotations",
            {{{"id", base + "/page/damage"}, {"type", "AnnotationPage"}, {"items", annotations}}}}}}}};
}

}  // namespace tangi
