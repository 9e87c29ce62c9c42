#include "paint/retouch/treatment_report.h"

#include <algorithm>
#include <cmath>

#include "paint/appearance.h"
#include "paint/retouch/damage_suggestion.h"
#include "paint/retouch/treatment_picture.h"
#include "surface/atomic_file.h"
#include "surface/error.h"
#include "surface/html_text.h"
#include "surface/page_parts.h"
#include "surface/picture_file.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int kPicture_px = 900;
const Vec3 kNormalLight{0.35f, 0.35f, 0.87f}, kRakingLeft{-1, 0.15f, 0.22f}, kRakingTop{0.1f, 1, 0.22f};

constexpr const char* kPrintStyle =
    "<style>@page{size:A4;margin:16mm}@media print{:root{--paper:#fff;--card:#fff;--ink:#000;--soft:#444;"
    "--line:#bbb}body{font-size:10pt}main{padding:0;max-width:none}h2{break-after:avoid}figure,tr{"
    "break-inside:avoid}.wide{overflow:visible}td{white-space:normal;overflow-wrap:anywhere}}figure img{"
    "max-width:100%;height:auto}code{font-size:11px;overflow-wrap:anywhere}td.text,th.text{text-align:left;"
    "white-space:normal;overflow-wrap:anywhere;vertical-align:top}</style>";

std::string figure(const Image<Rgb>& picture, const std::string& caption, const fs::path& scratch) {
    return fmt::format(
        "<figure class=\"card\"><img alt=\"{0}\" width=\"{1}\" src=\"{2}\"><figcaption>{0}"
        "</figcaption></figure>",
        escaped(caption), std::min(picture.width(), 520), picture_url(picture, scratch));
}

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
    std::string text = "<tr>";
    for (const std::string& cell : cells) text += fmt::format("<{0} class=\"text\">{1}</{0}>", tag, cell);
    return text + "</tr>";
}

std::string code(const std::string& text) { return "<code>" + escaped(text) + "</code>"; }

// "texture: surroundings; options: …" of a log's parameters.
std::string in_words(const json& value) {
    if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
    if (!value.is_object()) return value.is_string() ? value.get<std::string>() : value.dump();
    std::string text;
    for (const auto& [key, part] : value.items()) {
        if (part.is_null() || ((part.is_object() || part.is_array()) && part.empty())) continue;
        text += (text.empty() ? "" : "; ") + key + ": " +
                (part.is_object() ? "(" + in_words(part) + ")" : in_words(part));
    }
    return text;
}

std::string identification(const Treatment& t, const std::string& tool) {
    const json& first = t.log().entries().front().content;
    std::string html = "<h2>1. Identification</h2><div class=\"wide\"><table>";
    const auto line = [&](const char* name, const std::string& value) {
        html += row({name, escaped(value)});
    };
    line("Painting", first.value("painting", ""));
    line("Size",
         t.scale_known()
             ? fmt::format("{:.1f} × {:.1f} mm, {} × {} pixels of {:.4g} mm", t.width() * t.mm_per_pixel(),
                           t.height() * t.mm_per_pixel(), t.width(), t.height(), t.mm_per_pixel())
             : fmt::format("{} × {} pixels; the scale is unknown, a pixel counts as one mm", t.width(),
                           t.height()));
    line("Treatment begun", first.value("time", "") + ", " + first.value("who", ""));
    line("Report", utc_now() + ", " + tool);
    line("Dry layer, SHA-256", t.dry_sha256());
    line("Head of the log, SHA-256", fmt::format("{} (line {})", t.log().head(), t.log().entries().size()));
    return html + "</table></div>";
}

std::string condition(const Treatment& t, const Surface& original, const fs::path& scratch) {
    std::string html = "<h2>2. Condition</h2><div class=\"row\">";
    html += figure(damage_picture(t, original), "Map of damage", scratch);
    html +=
        "</div><div class=\"wide\"><table>" + row({"Class", "Count", "Area", "Part of the painting"}, "th");
    for (const json& entry : damage_table(t)) {
        std::string name = entry["class"].get<std::string>();
        std::replace(name.begin(), name.end(), '_', ' ');
        html += row({name, entry["count"].dump(), fmt::format("{:.2f} cm²", entry["area_cm2"].get<double>()),
                     fmt::format("{:.2f} %", entry["percent"].get<double>())});
    }
    html += "</table></div>";
    if (t.has_mask(DamageClass::craquelure)) {
        const CraquelureMeasure m = measure_lines(t.mask(DamageClass::craquelure), t.mm_per_pixel());
        html += fmt::format(
            "<p>Craquelure: {:.0f} mm long in all, {:.2f} mm wide on average, {:.2f} cm on "
            "each cm².</p>",
            m.length_mm, m.width_mm, m.density_per_cm);
    }
    return html;
}

std::string states(const Canvas& canvas, const std::vector<TreatmentLayer>& layers, const fs::path& scratch,
                   const Progress& progress) {
    std::string html =
        "<h2>3. States</h2><p class=\"soft\">Computed from the fitted maps and the layers: normal light from "
        "the upper right at 60° above the painting's plane; raking light from the left and from above at "
        "12°.</p>";
    for (const TreatmentState state : {TreatmentState::before, TreatmentState::filled,
                                       TreatmentState::retouched, TreatmentState::varnished}) {
        const Canvas shown = in_state(canvas, layers, state);
        const bool adds = std::any_of(layers.begin(), layers.end(),
                                      [&](const TreatmentLayer& l) { return shown_from(l.role) == state; });
        if (state != TreatmentState::before && !adds) continue;
        report(progress, "report", static_cast<double>(state) / 5);
        const Surface surface = appearance(shown);
        html += "<div class=\"row\">";
        const std::pair<const char*, Vec3> lights[] = {{"normal light", kNormalLight},
                                                       {"raking from the left", kRakingLeft},
                                                       {"raking from above", kRakingTop}};
        for (const auto& [name, direction] : lights)
            html += figure(look_of(surface, distant_light(direction), kPicture_px),
                           fmt::format("{}, {}", name_of(state), name), scratch);
        html += "</div>";
    }
    return html;
}

// The photographs that the maps come from, by their lights.
std::string photographs(const Surface& original) {
    std::vector<HemisphereLight> lights;
    for (const Photography::Photo& photo : original.photography.photos)
        lights.push_back({photo.light.name, glm::dvec3(photo.light.direction), 0, {}});
    if (lights.empty()) return "";
    return fmt::format(
        "<div class=\"row\"><figure class=\"card\">{}<figcaption>Light directions of the {} "
        "photographs that the maps were fitted from; the middle is straight above the "
        "painting</figcaption></figure></div>",
        hemisphere(lights), lights.size());
}

std::string measures(const Treatment& t, const Canvas& canvas, const fs::path& scratch) {
    std::string html = "<h2>4. Measures</h2>";
    Mask belongs(t.width(), t.height());
    for (const DamageClass damage : kDamageClasses)
        if (t.has_mask(damage)) belongs = united(belongs, t.mask(damage));
    html += "<div class=\"row\">" +
            figure(additions_picture(canvas, t.layers(), belongs),
                   "Additions: fills green, varnish yellow, retouches blue; red: "
                   "retouch on original",
                   scratch) +
            "</div>";
    html += "<div class=\"wide\"><table>" +
            row({"Layer, bottom up", "Role", "Area", "On original", "Paints", "SHA-256"}, "th");
    for (const TreatmentLayer& layer : t.layers())
        for (const DriedLayer& dried : canvas.dried()) {
            if (dried.name != layer.name) continue;
            const auto volumes = volumes_mm3(dried.paint, canvas.ingredients().size(), t.mm_per_pixel());
            std::string paints;
            for (std::size_t i = 0; i < volumes.size(); ++i)
                if (volumes[i] > 0)
                    paints += fmt::format("{}{}: {:.3g} mm³", paints.empty() ? "" : ", ",
                                          escaped(canvas.ingredients()[i].name), volumes[i]);
            const OnOriginal beside = on_original(dried.paint, belongs, t.mm_per_pixel());
            const bool varnish =
                layer.role == LayerRole::varnish || layer.role == LayerRole::isolating_varnish;
            html +=
                row({escaped(layer.name), std::string(name_of(layer.role)),
                     fmt::format("{:.2f} cm²", area_of(additions(dried.paint), t.mm_per_pixel()).mm2 / 100),
                     varnish ? "–" : fmt::format("{} pixels, {:.2f} mm²", beside.pixels, beside.area_mm2),
                     paints, code(layer.sha256)});
        }
    return html + "</table></div>";
}

std::string log_table(const TreatmentLog& log) {
    std::string html =
        "<h2>5. Log</h2><p class=\"soft\">Each line holds the hash of the one before; a line that "
        "was edited, removed or put in would break the chain. It was checked for this report.</p>"
        "<div class=\"wide\"><table>" +
        row({"Line", "When", "Who", "What", "With", "Result", "SHA-256"}, "th");
    for (const LogEntry& entry : log.entries()) {
        const json& c = entry.content;
        html += row({std::to_string(entry.line), escaped(c.value("time", "")), escaped(c.value("who", "")),
                     escaped(c.value("action", "")), escaped(in_words(c.value("parameters", json::object()))),
                     escaped(in_words(c.value("results", json::object()))), code(entry.sha256)});
    }
    return html + "</table></div>";
}

// A page at scale: the painting's size in mm, additions as filled outlines.
std::string printable_mask(const Treatment& t, const Mask& mask, const Surface& look, bool in_colour) {
    const double mm = t.mm_per_pixel(), width = t.width() * mm, height = t.height() * mm;
    std::string inside;
    if (in_colour) {  // one run a row and colour: prints as it is, at any size
        const Image<Rgb> colour = colour_of(look);
        const auto hex = [&](int x, int y) {
            const auto byte = [](float v) {
                return static_cast<int>(std::lround(std::clamp(v, 0.0f, 1.0f) * 63) * 255 / 63);
            };
            const Rgb c = colour(x, y);
            return fmt::format("#{:02x}{:02x}{:02x}", byte(c.r), byte(c.g), byte(c.b));
        };
        for (int y = 0; y < t.height(); ++y)
            for (int x = 0; x < t.width();) {
                if (!(mask(x, y) > 0.5f)) {
                    ++x;
                    continue;
                }
                const std::string own = hex(x, y);
                int end = x + 1;
                while (end < t.width() && mask(end, y) > 0.5f && hex(end, y) == own) ++end;
                inside += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"1.02\" fill=\"{}\"/>", x,
                                      y, end - x, own);
                x = end;
            }
    } else {
        inside = fmt::format(
            "<rect width=\"{}\" height=\"{}\" fill=\"#000\"/><path fill=\"#fff\" fill-rule=\"evenodd\" "
            "d=\"{}\"/>",
            t.width(), t.height(), svg_path(outlines_of(mask, 0.25)));
    }
    return fmt::format(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Mask at scale: "
        "{0}</title><style>"
        "@page{{size:{1:.2f}mm "
        "{2:.2f}mm;margin:0}}body{{margin:0}}svg{{display:block;width:{1:.2f}mm;height:{3:.2f}mm}}"
        "p{{margin:2mm;font:3mm sans-serif}}</style></head><body><svg xmlns=\"http://www.w3.org/2000/svg\" "
        "viewBox=\"0 0 {4} {5}\">{6}</svg><p>{0}: 1:1, {1:.1f} × {3:.1f} mm; print without scaling. The bar "
        "is 20 mm "
        "long. <svg style=\"display:inline;width:20mm;height:2mm\" viewBox=\"0 0 20 2\"><rect width=\"20\" "
        "height=\"2\"/></svg></p></body></html>\n",
        escaped(t.folder().filename().string()), width, height + 9, height, t.width(), t.height(), inside);
}

}  // namespace

std::vector<fs::path> write_treatment_report(const Treatment& t, const fs::path& html,
                                             const std::string& tool, const Progress& progress) {
    report(progress, "report", 0);
    const std::vector<std::string> faults = t.check(progress);
    if (!faults.empty()) fail("{}: no report is made of it: {}", t.folder().string(), faults.front());
    const Canvas canvas = t.read_canvas(progress);
    fs::path stem = html;
    stem.replace_extension();
    const auto beside = [&](const char* ending) { return fs::path(stem.string() + ending); };

    std::string page = page_head("Treatment of " + t.log().entries().front().content.value("painting", ""));
    page += kPrintStyle;
    page += identification(t, tool) + condition(t, canvas.dry(), html) +
            states(canvas, t.layers(), html, progress) + photographs(canvas.dry()) +
            measures(t, canvas, html) + log_table(t.log());
    page += "</main></body></html>\n";
    write_text_file(html, page);

    write_picture_8bit(beside(".picture.jpg"), colour_of(canvas.dry()));
    write_picture_8bit(beside(".damage.png"), damage_picture(t, canvas.dry()));
    const std::string picture = beside(".picture.jpg").filename().string();
    write_text_file(beside(".annotations.json"), web_annotations(t, picture).dump(1) + "\n");
    write_text_file(beside(".manifest.json"), iiif_manifest(t, picture).dump(1) + "\n");
    Mask added(t.width(), t.height());  // varnish over all is no use to print
    const auto layers = t.layers();
    for (const DriedLayer& dried : canvas.dried())
        for (const TreatmentLayer& layer : layers)
            if (layer.name == dried.name &&
                (layer.role == LayerRole::fill || layer.role == LayerRole::retouch))
                added = united(added, additions(dried.paint));
    const Surface after = appearance(in_state(canvas, layers, TreatmentState::varnished));
    write_text_file(beside(".mask.colour.html"), printable_mask(t, added, after, true));
    write_text_file(beside(".mask.white.html"), printable_mask(t, added, after, false));
    report(progress, "report", 1);
    return {html,
            beside(".picture.jpg"),
            beside(".damage.png"),
            beside(".annotations.json"),
            beside(".manifest.json"),
            beside(".mask.colour.html"),
            beside(".mask.white.html")};
}

}  // namespace tangi
