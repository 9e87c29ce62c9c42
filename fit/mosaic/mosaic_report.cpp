#include "fit/mosaic/mosaic_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/base/html_escape.h"
#include "surface/file/version.h"
#include "surface/maps/photography_json.h"
#include "surface/report/html_report.h"

namespace tangi {

namespace {

using nlohmann::json;

constexpr double kPictureSize = 760;  // [pixels] longest side of the layout's picture

// [µm], or [pixels] where the scale is not known.
struct HeightUnit {
    double per_pixel;
    const char* name;
};
HeightUnit height_unit(const MosaicReport& report) {
    return report.scale_known ? HeightUnit{1000 * report.mm_per_pixel, "µm"} : HeightUnit{1, "px"};
}

json positions_json(const std::vector<MosaicPosition>& positions, const MosaicReport& report) {
    json list = json::array();
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const PlacedPosition& placed = report.layout.positions[i];
        json entry = {{"name", positions[i].name},
                      {"width", positions[i].width},
                      {"height", positions[i].height},
                      {"joined", placed.joined}};
        if (placed.joined) {
            const PositionScale& scale = report.scales.positions[i];
            entry["to_wall"] = to_json(placed.to_wall);
            entry["sigma_px"] = placed.sigma_px;
            entry["turn_deg"] = placed.turn_rad * 180 / std::numbers::pi;
            entry["scale"] = placed.pixel;
            entry["tilt_deg"] = scale.tilt_deg;
            entry["diffuse_gain"] = {scale.diffuse.r, scale.diffuse.g, scale.diffuse.b};
            entry["specular_gain"] = scale.specular;
            entry["roughness_gain"] = scale.roughness;
        }
        list.push_back(std::move(entry));
    }
    return list;
}

const PairDifference* difference_of(const MosaicReport& report, const PlacedPair& pair) {
    const auto& all = report.scales.pairs;
    const auto found = std::ranges::find_if(
        all, [&](const PairDifference& d) { return d.first == pair.first && d.second == pair.second; });
    return found == all.end() ? nullptr : &*found;
}

json overlaps_json(const std::vector<MosaicPosition>& positions, const MosaicReport& report) {
    json list = json::array();
    for (const PlacedPair& pair : report.layout.pairs) {
        json entry = {{"first", positions[pair.first].name},
                      {"second", positions[pair.second].name},
                      {"ties", pair.ties},
                      {"residual_px", pair.rms_px}};
        if (const PairDifference* d = difference_of(report, pair)) {
            entry["delta_e_2000"] = d->delta_e_2000;
            entry["delta_e_2000_p95"] = d->delta_e_2000_p95;
            entry["tilt_deg"] = d->tilt_before_deg;
            entry["slope_rms"] = d->slope_rms;
        }
        list.push_back(std::move(entry));
    }
    return list;
}

json seams_json(const std::vector<MosaicPosition>& positions, const MosaicReport& report) {
    const double um = report.scale_known ? 1000 * report.mm_per_pixel : 0;
    json list = json::array();
    for (const SeamSteps& seam : report.seams) {
        json entry = {{"first", positions[seam.first].name},
                      {"second", positions[seam.second].name},
                      {"pieces", seam.pieces},
                      {"delta_e_2000", seam.delta_e_2000},
                      {"height_step_px", seam.height_rms},
                      {"height_sigma_px", seam.height_error}};
        entry["height_step_um"] = um > 0 ? json(um * seam.height_rms) : json(nullptr);
        entry["height_sigma_um"] = um > 0 ? json(um * seam.height_error) : json(nullptr);
        list.push_back(std::move(entry));
    }
    return list;
}

glm::dvec2 centre_on_wall(const MosaicPosition& position, const PlacedPosition& placed) {
    return mapped(placed.to_wall, glm::dvec2(position.width - 1, position.height - 1) / 2.0);
}

std::string outline(const MosaicPosition& position, const PlacedPosition& placed, double zoom) {
    const double right = position.width - 0.5, bottom = position.height - 0.5;
    std::string points;
    for (const glm::dvec2& corner :
         Corners{glm::dvec2(-0.5), {right, -0.5}, {right, bottom}, {-0.5, bottom}}) {
        const glm::dvec2 p = zoom * (mapped(placed.to_wall, corner) + 0.5);
        points += fmt::format("{:.1f},{:.1f} ", p.x, p.y);
    }
    return points;
}

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
    std::string html = "<tr>";
    for (const std::string& cell : cells) html += fmt::format("<{0}>{1}</{0}>", tag, cell);
    return html + "</tr>";
}

std::string notes(const std::string& title, const std::vector<std::string>& lines) {
    if (lines.empty()) return "";
    std::string html = fmt::format("<h2>{}</h2><ul class=\"notes\">", title);
    for (const std::string& line : lines) html += "<li>" + escaped(line) + "</li>";
    return html + "</ul>";
}

std::string overlaps_table(const std::vector<MosaicPosition>& positions, const MosaicReport& report) {
    std::string html = "<h2>Overlaps</h2><div class=\"wide\"><table>" +
                       row({"positions", "patches", "residual, px", "ΔE2000", "ΔE2000, 95 %", "tilt between",
                            "slopes differ by"},
                           "th");
    for (const PlacedPair& pair : report.layout.pairs) {
        const PairDifference* d = difference_of(report, pair);
        html += row({escaped(positions[pair.first].name + " – " + positions[pair.second].name),
                     fmt::format("{}", pair.ties), fmt::format("{:.2f}", pair.rms_px),
                     d ? fmt::format("{:.2f}", d->delta_e_2000) : "",
                     d ? fmt::format("{:.2f}", d->delta_e_2000_p95) : "",
                     d ? fmt::format("{:.2f}°", d->tilt_before_deg) : "",
                     d ? fmt::format("{:.4f}", d->slope_rms) : ""});
    }
    return html + "</table></div>";
}

std::string seams_table(const std::vector<MosaicPosition>& positions, const MosaicReport& report) {
    const HeightUnit unit = height_unit(report);
    std::string html = "<h2>Seams</h2><div class=\"wide\"><table>" +
                       row({"positions", fmt::format("step of height, {}", unit.name), "its standard error",
                            "ΔE2000 across"},
                           "th");
    for (const SeamSteps& seam : report.seams)
        html += row({escaped(positions[seam.first].name + " – " + positions[seam.second].name),
                     fmt::format("{:.2f}", unit.per_pixel * seam.height_rms),
                     fmt::format("{:.2f}", unit.per_pixel * seam.height_error),
                     fmt::format("{:.2f}", seam.delta_e_2000)});
    return html + "</table></div>";
}

std::string positions_table(const std::vector<MosaicPosition>& positions, const MosaicReport& report) {
    std::string html =
        "<h2>Positions</h2><div class=\"wide\"><table>" +
        row({"position", "place known to, px", "turned by", "tilted by", "size", "gain of ρd (R, G, B)"},
            "th");
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const PlacedPosition& placed = report.layout.positions[i];
        if (!placed.joined) continue;
        const PositionScale& scale = report.scales.positions[i];
        html += row({escaped(positions[i].name), fmt::format("{:.2f}", placed.sigma_px),
                     fmt::format("{:.2f}°", placed.turn_rad * 180 / std::numbers::pi),
                     fmt::format("{:.2f}°", scale.tilt_deg), fmt::format("{:.4f}", placed.pixel),
                     fmt::format("{:.3f} {:.3f} {:.3f}", scale.diffuse.r, scale.diffuse.g, scale.diffuse.b)});
    }
    return html + "</table></div>";
}

}  // namespace

json to_json(const std::vector<MosaicPosition>& positions, const MosaicReport& report) {
    json left_out = json::array(), tried = json::array();
    for (const LeftOut& out : report.left_out)
        left_out.push_back({{"name", positions[out.position].name}, {"why", out.why}});
    for (const PairRegistration& pair : report.pairs)
        if (!pair.joined())
            tried.push_back({{"first", positions[pair.first].name},
                             {"second", positions[pair.second].name},
                             {"why", pair.why}});
    return {{"width", report.layout.width},
            {"height", report.layout.height},
            {"mm_per_pixel", report.mm_per_pixel},
            {"scale_known", report.scale_known},
            {"residual_px", report.layout.rms_px},
            {"positions", positions_json(positions, report)},
            {"overlaps", overlaps_json(positions, report)},
            {"not_overlapping", tried},
            {"seams", seams_json(positions, report)},
            {"left_out", left_out},
            {"height_cycles", report.height.cycles},
            {"height_converged", report.height.converged}};
}

std::string layout_picture(const std::vector<MosaicPosition>& positions, const MosaicReport& report,
                           const MosaicOptions& options) {
    const MosaicLayout& layout = report.layout;
    const double zoom = kPictureSize / std::max(layout.width, layout.height);
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"-4 -4 "
        "{2:.0f} {3:.0f}\" role=\"img\" aria-label=\"layout of the positions\" font-family=\"sans-serif\" "
        "font-size=\"12\"><metadata>{4}</metadata>",
        zoom * layout.width + 8, zoom * layout.height + 8, zoom * layout.width + 8, zoom * layout.height + 8,
        program_name());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!layout.positions[i].joined) continue;
        svg += fmt::format(
            "<polygon points=\"{}\" fill=\"#0b6b6b\" fill-opacity=\".12\" stroke=\"#0b6b6b\" "
            "stroke-width=\"1.5\"/>",
            outline(positions[i], layout.positions[i], zoom));
    }
    for (const PlacedPair& pair : layout.pairs) {
        const glm::dvec2 a = zoom * centre_on_wall(positions[pair.first], layout.positions[pair.first]),
                         b = zoom * centre_on_wall(positions[pair.second], layout.positions[pair.second]);
        const glm::dvec2 label = glm::mix(a, b, 0.38);  // not where the diagonals of four cross
        const char* colour = pair.rms_px > options.max_residual_px       ? "#c2410c"
                             : pair.rms_px > options.max_residual_px / 2 ? "#a16207"
                                                                         : "#15803d";
        svg += fmt::format(
            "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"2\"/>"
            "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.2f} px</text>",
            a.x, a.y, b.x, b.y, colour, label.x, label.y - 4, pair.rms_px);
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!layout.positions[i].joined) continue;
        const glm::dvec2 p = zoom * centre_on_wall(positions[i], layout.positions[i]);
        svg += fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" font-weight=\"bold\">{}</text>", p.x,
            p.y + 14, escaped(positions[i].name));
    }
    return svg + "</svg>";
}

std::string mosaic_page(const std::vector<MosaicPosition>& positions, const MosaicReport& report,
                        const MosaicOptions& options, const std::string& title) {
    std::vector<std::string> left_out;
    for (const LeftOut& out : report.left_out)
        left_out.push_back(fmt::format("{}: {}", positions[out.position].name, out.why));
    return page_head(title) +
           fmt::format("<p class=\"soft\">{} × {} pixels of {} positions; overlaps fit to {:.2f} pixels</p>",
                       report.layout.width, report.layout.height, positions.size() - report.left_out.size(),
                       report.layout.rms_px) +
           "<div class=\"row\"><div class=\"card\">" + layout_picture(positions, report, options) +
           "</div></div>" + notes("What makes it poor", report.poor) + notes("Left out", left_out) +
           notes("Warnings", report.warnings) + positions_table(positions, report) +
           overlaps_table(positions, report) + seams_table(positions, report) + "</main></body></html>\n";
}

}  // namespace tangi
