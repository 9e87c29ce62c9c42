// treatment_annotations.cpp: damage maps for other programs: W3C Web Annotations, IIIF Presentation 3.
#include <algorithm>

#include "retouch/report/treatment_report.h"
#include "retouch/treatment/treatment_area.h"
#include "surface/file/version.h"

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
               {"value", fmt::format("{} area{}, {}, {:.3g} %", area.regions, area.regions == 1 ? "" : "s",
                                     area_in_words(area_of_step(treatment, area.mm2)), area.percent)}}}},
            {"target", {{"source", source}, {"selector", {{"type", "SvgSelector"}, {"value", svg}}}}}};
}

std::string urn_of(const Treatment& treatment) { return "urn:tangipaint:" + treatment.log().head(); }

// A file's name as part of an address (RFC 3986).
std::string in_address(const std::string& name) {
    std::string text;
    for (const char c : name) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           std::string_view("-._~").find(c) != std::string_view::npos;
        text += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return text;
}

json about_line(const std::string& label, const std::string& value) {
    return {{"label", {{"en", {label}}}}, {"value", {{"none", {value}}}}};
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

json web_annotations(const Treatment& treatment, const std::string& name, const std::string& published_at) {
    const std::string id =
        published_at.empty() ? urn_of(treatment) : published_at + in_address(name + ".annotations.json");
    const std::string picture = published_at + in_address(name + ".picture.jpg");
    json items = json::array();
    for (const DamageClass damage : kDamageClasses)
        if (treatment.has_mask(damage))
            items.push_back(
                annotation(treatment, damage, fmt::format("{}#{}", id, name_of(damage)), picture));
    return {{"@context", "http://www.w3.org/ns/anno.jsonld"},
            {"id", id},
            {"type", "AnnotationPage"},
            {"generator", {{"type", "Software"}, {"name", program_name()}}},
            {"items", items}};
}

json iiif_manifest(const Treatment& treatment, const std::string& name, const std::string& published_at) {
    const std::string base = published_at.empty() ? urn_of(treatment) : published_at + in_address(name);
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
                            {{"id", published_at + in_address(name + ".picture.jpg")},
                             {"type", "Image"},
                             {"format", "image/jpeg"},
                             {"width", treatment.width()},
                             {"height", treatment.height()}}}};
    const json& first = treatment.log().entries().front().content;
    json about = {about_line("Painting", first.value("painting", "")),
                  about_line("Treatment begun", first.value("time", "")),
                  about_line("Head of the log, SHA-256", treatment.log().head()),
                  about_line("Made by", program_name())};
    if (treatment.scale_known())
        about.push_back(
            about_line("Size", fmt::format("{:.1f} × {:.1f} mm", treatment.width() * treatment.mm_per_pixel(),
                                           treatment.height() * treatment.mm_per_pixel())));
    const json label = {{"en", {treatment.folder().filename().string() + ": damage map"}}};
    return {
        {"@context", "http://iiif.io/api/presentation/3/context.json"},
        {"id", published_at.empty() ? base + "/manifest" : base + ".manifest.json"},
        {"type", "Manifest"},
        {"label", label},
        {"metadata", about},
        {"items",
         {{{"id", canvas},
           {"type", "Canvas"},
           {"label", label},
           {"width", treatment.width()},
           {"height", treatment.height()},
           {"items", {{{"id", base + "/page/picture"}, {"type", "AnnotationPage"}, {"items", {painting}}}}},
           {"annotations",
            {{{"id", base + "/page/damage"}, {"type", "AnnotationPage"}, {"items", annotations}}}}}}}};
}

}  // namespace tangi
