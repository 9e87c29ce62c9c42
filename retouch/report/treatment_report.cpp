#include "retouch/report/treatment_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "paint/canvas/appearance.h"
#include "paint/canvas/appearance_part.h"
#include "retouch/damage/damage_suggestion.h"
#include "retouch/report/report_content.h"
#include "retouch/treatment/treatment_area.h"
#include "retouch/treatment/treatment_picture.h"
#include "surface/base/error.h"
#include "surface/base/json_text.h"
#include "surface/file/atomic_file.h"
#include "surface/file/atomic_folder.h"
#include "surface/image_file/image_io.h"

namespace tangi {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

const std::pair<const char*, Vec3> kLights[] = {{"normal light", {0.35f, 0.35f, 0.87f}},
                                                {"raking from the left", {-1, 0.15f, 0.22f}},
                                                {"raking from above", {0.1f, 1, 0.22f}}};
constexpr double kPlan_dpi = 300;
constexpr int kPlan_px = 16000;  // of its longer side, at most

// "texture: surroundings; options: …" of a log's parameters; of long lists, how long they are.
std::string in_words(const json& value) {
    if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
    if (value.is_array()) {
        if (value.size() > 12 ||
            std::any_of(value.begin(), value.end(), [](const json& v) { return v.is_structured(); }))
            return fmt::format("{} (see log.jsonl)", value.size());
        std::string text;
        for (const json& v : value) text += (text.empty() ? "" : ", ") + in_words(v);
        return text;
    }
    if (!value.is_object()) return value.is_string() ? value.get<std::string>() : json_line(value);
    std::string text;
    for (const auto& [key, part] : value.items()) {
        if (part.is_null() || (part.is_structured() && part.empty())) continue;
        text += (text.empty() ? "" : "; ") + key + ": " +
                (part.is_object() ? "(" + in_words(part) + ")" : in_words(part));
    }
    return text;
}

void identification(ReportMatter& m, const std::string& tool) {
    const Treatment& t = m.t;
    const json& first = m.log().front().content;
    const std::string size =
        t.scale_known()
            ? fmt::format("{:.1f} × {:.1f} mm, {} × {} pixels of {:.4g} mm", t.width() * t.mm_per_pixel(),
                          t.height() * t.mm_per_pixel(), t.width(), t.height(), t.mm_per_pixel())
            : fmt::format("{} × {} pixels; the scale is unknown", t.width(), t.height());
    m.add(ReportHeading{"1. Identification"});
    m.add(ReportTable{
        {},
        {{"Painting", first.value("painting", "")},
         {"Size", size},
         {"Treatment begun", first.value("time", "") + ", " + first.value("who", "")},
         {"Report", utc_now() + ", " + tool},
         {"Dry layer, SHA-256", t.dry_sha256()},
         {"Head of the log, SHA-256", fmt::format("{} (line {})", t.log().head(), m.log().size())}},
        {1, 3}});
}

// The photographs that the maps come from, by their lights.
void examination(ReportMatter& m) {
    ReportLights lights;
    int held_out = 0;
    for (const Photography::Photo& photo : m.canvas.dry().photography.photos) {
        lights.lights.push_back({photo.light.name, glm::dvec3(photo.light.direction), 0, {}, !photo.fitted});
        held_out += photo.fitted ? 0 : 1;
    }
    if (lights.lights.empty()) return;
    lights.caption = fmt::format(
        "Light directions of the {} photographs that the maps were fitted from{}; the middle is straight "
        "above the painting.",
        static_cast<int>(lights.lights.size()) - held_out,
        held_out > 0 ? fmt::format(", and, as rings, of {} more that were held out", held_out) : "");
    m.add(ReportHeading{"2. Examination"});
    m.add(std::move(lights));
}

void condition(ReportMatter& m) {
    m.add(ReportHeading{"3. Condition"});
    m.add(ReportPictures{{{fitting(damage_map(m.t, m.canvas.dry()), 1), "Map of damage"}}});
    ReportTable table{{"Class", "Count", "Area", "Part of the painting"}, {}, {3, 1, 1.4, 2}};
    for (const json& entry : damage_table(m.t)) {
        const auto name = entry["class"].get<std::string>();
        table.rows.push_back({spaced(name), json_line(entry["count"]), area_in_words(entry),
                              fmt::format("{:.2f} %", entry["percent"].get<double>())});
        table.keys.push_back(legend_colour_srgb(*damage_class_named(name)));
    }
    if (table.rows.empty()) m.add(ReportText{"No damage is mapped."});
    m.add(std::move(table));
    if (!m.t.has_mask(DamageClass::craquelure)) return;
    const CraquelureMeasure lines = measure_lines(m.t.mask(DamageClass::craquelure), m.t.mm_per_pixel());
    m.add(ReportText{fmt::format("Craquelure: {}.", in_words(lines, m.t.mm_per_pixel(), m.t.scale_known()))});
}

std::string remedy_of(const json& gloss) {
    const std::string remedy = gloss.value("remedy", "none");
    return remedy == "none" ? "the paints' own" : "by " + remedy;
}

bool is_there(const ReportMatter& m, const std::string& layer) {
    return std::any_of(m.layers.begin(), m.layers.end(), [&](const auto& l) { return l.name == layer; });
}

// "at 12, 40; 310, 22 and 3 more": corners of the largest parts.
std::string places_in_words(const json& gloss) {
    std::string text;
    const json boxes = gloss.value("boxes_px", json::array());
    const std::size_t named = std::min(boxes.size(), std::size_t(4));
    for (std::size_t i = 0; i < named; ++i)
        text += fmt::format("{}{}, {}", i == 0 ? "at " : "; ", json_line(boxes[i].at(0)),
                            json_line(boxes[i].at(1)));
    if (const std::size_t parts = gloss.value("parts", boxes.size()); parts > named)
        text += fmt::format(" and {} more", parts - named);
    return text;
}

// What gloss each part of a retouch was brought to, and how that is done.
void glosses(ReportMatter& m) {
    ReportTable table{
        {"Retouch", "Parts, at pixel", "Area", "ρs", "α", "Of the paints: ρs, α", "Brought to it"},
        {},
        {2, 3.4, 1.4, 1, 1, 2, 3}};
    for (const LogEntry& entry : m.log()) {
        const json results = entry.content.value("results", json::object());
        if (!results.contains("gloss") || !is_there(m, results.value("layer", ""))) continue;
        for (const json& gloss : results["gloss"]) {
            const json own = gloss.value("of_paints", json::object());
            const StatedLength area = stated_length(gloss, "area", "_mm2");
            table.rows.push_back(
                {results.value("layer", ""), places_in_words(gloss),
                 fmt::format("{:.4g}{}", area.value.get<double>(), area.unit),
                 fmt::format("{:.3f}", gloss.value("specular", 0.0)),
                 fmt::format("{:.2f}", gloss.value("roughness", 0.0)),
                 fmt::format("{:.3f}, {:.2f}", own.value("specular", 0.0), own.value("roughness", 0.0)),
                 remedy_of(gloss)});
        }
    }
    if (table.rows.empty()) return;
    m.add(ReportText{"Gloss"});
    m.add(std::move(table));
}

// Recipes that were searched for, and those of retouches that are still there, as the log has them.
void recipes(ReportMatter& m) {
    ReportTable table{{"For", "Recipe, in measures", "Amount", "ΔE2000 from what was wanted", "Remarks"},
                      {},
                      {2, 5, 1.6, 3, 4}};
    for (const LogEntry& entry : m.log()) {
        const json results = entry.content.value("results", json::object());
        const bool retouch = results.contains("piles");
        if (retouch ? !is_there(m, results.value("layer", "")) : !results.contains("recipes")) continue;
        for (const json& recipe : results[retouch ? "piles" : "recipes"]) {
            const auto warnings = recipe.value("warnings", std::vector<std::string>());
            table.rows.push_back(
                {retouch ? results.value("layer", "") : fmt::format("match, line {}", entry.line),
                 recipe.value("recipe", ""),
                 retouch && m.t.scale_known() ? fmt::format("{:.3g} mm³", recipe.value("volume_mm3", 0.0))
                                              : "",
                 by_each_light(retouch ? results.value("delta_e_2000_from_target", json::object())
                                       : recipe.value("delta_e_2000", json::object())) +
                     (retouch ? ", in all" : ""),
                 fmt::format("{}", fmt::join(warnings, "; "))});
        }
    }
    if (table.rows.empty()) return;
    m.add(ReportText{"Recipes"});
    m.add(std::move(table));
}

// Where a layer was to lie: pixels at its rim are covered in part.
Mask mask_of(const Treatment& t, const DriedLayer& layer) {
    const std::vector<std::string> masks = t.mask_names();
    const bool has = std::find(masks.begin(), masks.end(), layer.name) != masks.end();
    return has ? t.mask(layer.name) : additions(layer.paint);
}

std::string in_words(const OnOriginal& paint, bool scale_known) {
    std::string words = fmt::format("{} pixels", paint.whole_pixels);
    const int rim = paint.pixels - paint.whole_pixels;
    if (rim > 0) words += fmt::format(", and {} at the rim in part", rim);
    if (paint.pixels > 0 && scale_known) words += fmt::format("; {:.2f} mm²", paint.area_mm2);
    return words;
}

void measures(ReportMatter& m) {
    const Treatment& t = m.t;
    m.add(ReportHeading{"4. Measures"});
    ReportTable table{
        {"Layer, bottom up", "Role", "Area", "On original", "Paints", "SHA-256"}, {}, {2.2, 2, 1.6, 2, 4, 4}};
    for (const TreatmentLayer& layer : m.layers)
        for (const DriedLayer& dried : m.canvas.dried()) {
            if (dried.name != layer.name) continue;
            const auto volumes = volumes_mm3(dried.paint, m.canvas.ingredients().size(), t.mm_per_pixel());
            const auto by_name = volumes_by_name(m.canvas.ingredients(), volumes);
            const OnOriginal beside = on_original(dried.paint, m.belongs, t.mm_per_pixel());
            const bool varnish =
                layer.role == LayerRole::varnish || layer.role == LayerRole::isolating_varnish;
            table.rows.push_back(
                {layer.name, spaced(std::string(name_of(layer.role))),
                 area_in_words(area_of_step(t, area_of(mask_of(t, dried), t.mm_per_pixel()).mm2)),
                 varnish ? "–" : in_words(beside, t.scale_known()), paints_in_words(by_name, t.scale_known()),
                 layer.sha256});
        }
    m.add(std::move(table));
    m.add(ReportPictures{{{fitting(additions_picture(m.canvas, m.layers, m.belongs), 1),
                           "Additions: fills green, varnish yellow, retouches blue; red: on original"}}});
    recipes(m);
    glosses(m);
}

// States that differ from the one before: those that add layers, and what was photographed.
std::vector<TreatmentStage> shown_states(const ReportMatter& m) {
    std::vector<TreatmentStage> shown;
    for (const TreatmentStage state :
         {TreatmentStage::before, TreatmentStage::cleaned, TreatmentStage::filled, TreatmentStage::retouched,
          TreatmentStage::varnished}) {
        const bool adds = std::any_of(m.layers.begin(), m.layers.end(),
                                      [&](const TreatmentLayer& l) { return shown_from(l.role) == state; });
        const bool photographed =
            state == TreatmentStage::before || (state == TreatmentStage::cleaned && m.t.has_earlier());
        if (adds || photographed) shown.push_back(state);
    }
    return shown;
}

// Every illuminant shows all states side by side. The maps of one state at a time are held: they are as large
// as the painting.
void states(ReportMatter& m, const Progress& progress) {
    const std::vector<TreatmentStage> shown = shown_states(m);
    const int side_px = std::max(report_picture_px(static_cast<int>(shown.size())), 900);
    std::vector<ReportPictures> rows(std::size(kLights));
    for (const TreatmentStage state : shown) {
        report(progress, "report", static_cast<double>(state) / 5);
        const Surface surface = surface_in_state(m.t, m.canvas, state);
        for (std::size_t i = 0; i < rows.size(); ++i)
            rows[i].pictures.push_back({look_of(surface, distant_light(kLights[i].second), side_px),
                                        fmt::format("{}, {}", name_of(state), kLights[i].first)});
    }
    m.add(ReportHeading{"5. Result"});
    m.add(ReportText{
        "Computed from the fitted maps and the layers: normal light from the upper right at 60° above the "
        "painting's "
        "plane; raking light from the left and from above at 12°. Pictures in one light have one "
        "exposure.",
        true});
    for (ReportPictures& row : rows) m.add(std::move(row));
}

void log_table(ReportMatter& m) {
    m.add(ReportHeading{"6. Log"});
    m.add(ReportText{
        "Each line holds the hash of the one before; a line that was edited, removed or put in would break "
        "the chain. It was checked for this report.",
        true});
    ReportTable table{
        {"Line", "When", "Who", "What", "With", "Result", "SHA-256"}, {}, {0.8, 2, 1.9, 1.6, 4, 4, 2.6}};
    for (const LogEntry& entry : m.log()) {
        const json& c = entry.content;
        table.rows.push_back({std::to_string(entry.line), c.value("time", ""), c.value("who", ""),
                              c.value("action", ""), in_words(c.value("parameters", json::object())),
                              in_words(c.value("results", json::object())), entry.sha256});
    }
    m.add(std::move(table));
}

// What was added, to print at scale: in its colours, and as white areas. Varnish over all is no use to print.
std::pair<ReportPlan, ReportPlan> plans(const ReportMatter& m) {
    const Treatment& t = m.t;
    Mask added(t.width(), t.height());
    for (const DriedLayer& dried : m.canvas.dried())
        for (const TreatmentLayer& layer : m.layers)
            if (layer.name == dried.name &&
                (layer.role == LayerRole::fill || layer.role == LayerRole::retouch))
                added = united(added, additions(dried.paint));
    const double mm = t.mm_per_pixel();
    ReportPlan colour, white;
    colour.width_mm = white.width_mm = t.width() * mm;
    colour.height_mm = white.height_mm = t.height() * mm;
    colour.scale_known = white.scale_known = t.scale_known();
    const std::string of = fmt::format("fills and retouches of {}", t.folder().filename().string());
    colour.caption = "Mask in colour: " + of;
    white.caption = "Mask in white: " + of;
    colour.picture =
        encoded(diffuse_in(in_state(m.canvas, t.layers(), TreatmentStage::varnished), m.canvas.region()));
    for (std::size_t i = 0; i < added.size(); ++i)
        if (!(added.pixels()[i] > 0.5f)) colour.picture.pixels()[i] = Rgb(1);
    const double longer_mm = std::max(colour.width_mm, colour.height_mm);
    const int plan_px = t.scale_known()
                            ? static_cast<int>(std::min<double>(longer_mm / 25.4 * kPlan_dpi + 1, kPlan_px))
                            : report_picture_px(1);
    colour.picture = reduced(colour.picture, plan_px, plan_px);
    white.outlines = outlines_of(added, 0.25);
    for (Polygon& polygon : white.outlines)
        for (Corner& corner : polygon) corner.x *= mm, corner.y *= mm;
    return {std::move(colour), std::move(white)};
}

// Returns the names, in `folder`.
std::vector<fs::path> write_files(ReportMatter& m, const fs::path& folder, const std::string& stem,
                                  const fs::path& page, const std::string& published_at) {
    std::vector<fs::path> names = {
        stem + ".html",        stem + ".pdf",        stem + ".mask.colour.pdf",  stem + ".mask.white.pdf",
        stem + ".picture.jpg", stem + ".damage.png", stem + ".annotations.json", stem + ".manifest.json"};
    {
        auto [colour, white] = plans(m);
        write_pdf(folder / names[2], colour);
        write_pdf(folder / names[3], white);
        m.add(std::move(colour));  // as large as the painting: held once
        m.add(std::move(white));
    }
    write_text_file(folder / names[0], html_of(m.report, page));
    write_pdf(folder / names[1], m.report);
    m.report.blocks.clear();
    write_picture_8bit(folder / names[4], colour_of(m.canvas.dry()));
    write_picture_8bit(folder / names[5], damage_picture(m.t, m.canvas.dry()));
    write_text_file(folder / names[6], json_lines(web_annotations(m.t, stem, published_at), 1));
    write_text_file(folder / names[7], json_lines(iiif_manifest(m.t, stem, published_at), 1));
    return names;
}

}  // namespace

std::vector<fs::path> write_treatment_report(const Treatment& t, const fs::path& page,
                                             const std::string& tool, const Progress& progress,
                                             const std::string& published_at) {
    report(progress, "report", 0);
    const std::vector<std::string> faults = t.check(progress);
    if (!faults.empty()) fail("{}: no report is made of it: {}", t.folder().string(), faults.front());
    const Canvas canvas = t.read_canvas(progress);
    if (const std::vector<std::string> unlogged = t.unlogged(canvas); !unlogged.empty())
        fail("{}: {}, and a report would not tell of it; tangipaint treatment retouch {} takes it in",
             t.folder().string(), unlogged.front(), t.folder().string());
    { const AtomicFile writable(page); }  // its folder is there

    ReportMatter m{t, canvas, t.layers(), mapped_damage(t), {}};
    m.report.title = "Treatment of " + m.log().front().content.value("painting", "");
    try {
        identification(m, tool);
        examination(m);
        condition(m);
        measures(m);
        states(m, progress);
        add_quality(m);
        log_table(m);
    } catch (const json::exception& unlike) {  // results of a line that somebody wrote anew
        fail("{}: a line's results are not as this program writes them ({}); no report is made of it",
             t.log().path().string(), unlike.what());
    }
    const fs::path folder = page.has_parent_path() ? page.parent_path() : fs::path(".");
    FolderFiles written(folder);  // all of them, or none
    std::vector<fs::path> names;
    told_of(written.temporary(), folder,
            [&] { names = write_files(m, written.temporary(), page.stem().string(), page, published_at); });
    written.place();
    std::vector<fs::path> files;
    for (const fs::path& name : names) files.push_back(page.parent_path() / name);
    report(progress, "report", 1);
    return files;
}

}  // namespace tangi
