#include "capture/calibration/calibration_page.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "capture/formats/capture_file.h"
#include "capture/formats/lights_file.h"
#include "surface/base/error.h"
#include "surface/base/html_escape.h"
#include "surface/base/json_reading.h"
#include "surface/base/json_text.h"
#include "surface/base/median.h"
#include "surface/file/atomic_file.h"
#include "surface/file/output_set.h"
#include "surface/image_file/image_io.h"
#include "surface/report/html_report.h"

namespace tangi {

using glm::dvec2;
using glm::dvec3;

namespace {

constexpr const char* kTitle = "Calibration";

std::vector<HemisphereLight> shown(const SphereCalibration& c) {
    std::vector<HemisphereLight> lights;
    for (const CalibratedLight& light : c.lights)
        lights.push_back({light.name, light.direction, light.direction_sigma_deg, {}});
    return lights;
}

// A sphere with the outline and the highlights that were found, numbered as in the table.
std::string sphere_figure(const SphereCalibration& c, std::size_t number, const std::string& url) {
    const FoundSphere& sphere = c.spheres[number];
    const Region& r = sphere.crops.region;
    std::string svg = fmt::format(
        "<figure class=\"card\"><svg width=\"360\" height=\"{:.0f}\" viewBox=\"{} {} {} {}\">"
        "<image href=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\"/>",
        360.0 * r.height() / r.width(), r.x0 - 0.5, r.y0 - 0.5, r.width(), r.height(), url, r.x0 - 0.5,
        r.y0 - 0.5, r.width(), r.height());
    const double size = r.width() / 360.0;  // pixels for one of the page's
    svg += fmt::format("<polygon fill=\"none\" stroke=\"#22d3ee\" stroke-width=\"{:.3f}\" points=\"",
                       1.2 * size);
    for (int i = 0; i < 120; ++i) {
        const dvec2 p = outline_point(sphere.image, c.camera, 2 * std::numbers::pi * i / 120);
        svg += fmt::format("{:.2f},{:.2f} ", p.x, p.y);
    }
    svg += "\"/>";
    for (std::size_t i = 0; i < sphere.highlights.size(); ++i) {
        const Highlight& h = sphere.highlights[i];
        if (h.state != HighlightState::found) continue;
        svg += fmt::format(
            "<path d=\"M{:.2f} {:.2f}h{:.2f}m{:.2f} {:.2f}v{:.2f}\" stroke=\"#f43f5e\" "
            "stroke-width=\"{:.3f}\"/><text x=\"{:.2f}\" y=\"{:.2f}\" "
            "style=\"fill:#facc15;font-size:{:.2f}px\">{}</text>",
            h.place_px.x - 5 * size, h.place_px.y, 10 * size, -5 * size, -5 * size, 10 * size, 1.2 * size,
            h.place_px.x + 4 * size, h.place_px.y - 4 * size, 10 * size, i + 1);
    }
    const std::string outline =
        sphere.outline_coverage > 0
            ? fmt::format("outline seen on {:.0f} % of its length, edges ± {:.2f} px",
                          std::min(100.0, 100 * sphere.outline_coverage), sphere.outline_residual_px)
            : "outline taken as given";
    return svg +
           fmt::format(
               "</svg><figcaption><b>{}</b>: radius {:.2f} ± {:.2f} px, centre ± {:.2f} px; "
               "{}{}</figcaption></figure>",
               escaped(sphere.name), sphere.image.radius_px, sphere.image.radius_sigma_px,
               sphere.image.centre_sigma_px, outline,
               sphere.highlights.empty() ? "" : fmt::format("; {} highlights", sphere.highlights_found()));
}

// Strength of the light on the chart in each photograph, in units of their median; empty where not known.
std::map<std::string, double> strengths_of(const std::optional<ColourCalibration>& colours) {
    std::map<std::string, double> strengths;
    std::vector<double> all;
    for (std::size_t i = 0; colours && i < colours->correction.lights.lights.size(); ++i) {
        const ChartLight& light = colours->correction.lights.lights[i];
        if (!light.known || i >= colours->photos.size()) continue;
        strengths[colours->photos[i]] = std::exp(light.terms[0]);
        all.push_back(strengths[colours->photos[i]]);
    }
    if (all.empty()) return strengths;
    const double middle = median(all);
    for (auto& [name, strength] : strengths) strength /= middle;
    return strengths;
}

std::string direction_cells(const CalibratedLight& light, bool positions, bool spheres) {
    if (!light.direction)
        return fmt::format("<td class=\"why\" colspan=\"{}\">rejected: {}</td>",
                           4 + (positions ? 4 : 0) + (spheres ? 1 : 0), escaped(light.reason));
    const dvec3& d = *light.direction;
    std::string html = fmt::format("<td>{:.4f}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:.2f}</td>", d.x, d.y,
                                   d.z, light.direction_sigma_deg);
    if (light.position_mm)
        html +=
            fmt::format("<td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td>", light.position_mm->x,
                        light.position_mm->y, light.position_mm->z, glm::length(light.position_sigma_mm));
    else if (positions)
        html += "<td colspan=\"4\">distant</td>";
    return spheres ? html + fmt::format("<td>{}</td>", light.spheres_used) : html;
}

// One line a photograph: its light, how strong that was on the chart, and how the camera had moved.
std::string table(const Calibration& calibration) {
    const SphereCalibration& c = calibration.lights;
    const bool spheres = !c.spheres.empty(), lights = c.calibrated() > 0, moved = spheres && c.drifts.moved;
    const bool positions = std::any_of(c.lights.begin(), c.lights.end(),
                                       [](const auto& l) { return l.position_mm.has_value(); });
    const std::map<std::string, double> strengths = strengths_of(calibration.colours);
    std::string html = "<div class=\"wide\"><table><tr><th>photograph</th>";
    if (lights) html += "<th>x</th><th>y</th><th>z</th><th>± deg</th>";
    if (positions) html += "<th>x mm</th><th>y mm</th><th>z mm</th><th>± mm</th>";
    if (spheres) html += "<th>balls</th>";
    if (!strengths.empty()) html += "<th>light on the chart</th>";
    if (moved) html += "<th>drift px</th><th>± px</th><th>roll mrad</th><th>zoom ‰</th>";
    html += "</tr>";
    for (std::size_t i = 0; i < c.lights.size(); ++i) {
        const CalibratedLight& light = c.lights[i];
        html += fmt::format("<tr><td>{}&ensp;{}</td>", i + 1, escaped(light.name));
        if (lights) html += direction_cells(light, positions, spheres);
        if (!strengths.empty()) {
            const auto found = strengths.find(light.name);
            html += found == strengths.end()
                        ? "<td>–</td>"
                        : fmt::format(
                              "<td>{}</td>",
                              with_error(found->second,
                                         found->second * calibration.colours->correction.lights.residual));
        }
        if (moved) {
            const CameraMotion& drift = c.drifts.photos[i];
            html += fmt::format("<td>{:.2f}, {:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td>",
                                drift.shift_px.x, drift.shift_px.y, drift.sigma_px, 1000 * drift.roll_rad,
                                1000 * (drift.zoom - 1));
        }
        html += "</tr>";
    }
    return html + "</table></div>";
}

// Scale, markers, lens, rectification: what the picture that is fitted will be.
std::string plane_section(const PlaneCalibration& c) {
    std::string html = "<h2>Scale and plane</h2><div class=\"row\">";
    if (!c.scales.empty()) {
        html +=
            "<div class=\"card wide\"><table><tr><th>scale by</th><th>mm per pixel</th><th>± %</th><th>at "
            "pixel</th></tr>";
        for (const Scale& scale : c.scales)
            html += fmt::format(
                "<tr><td>{}{}</td><td>{}</td><td>{:.2f}</td><td>{}</td></tr>", escaped(scale.method),
                &scale == &c.scales.front() ? " (used)" : "", with_error(scale.mm_per_pixel, scale.sigma),
                100 * scale.sigma / scale.mm_per_pixel,
                scale.method == "ppi" ? "everywhere"
                                      : fmt::format("{:.0f}, {:.0f}", scale.place_px.x, scale.place_px.y));
        html += "</table></div>";
    }
    html += "<div class=\"card\">";
    if (!c.markers.markers.empty()) {
        std::string ids;
        for (const Marker& marker : c.markers.markers)
            ids += fmt::format("{}{}", ids.empty() ? "" : ", ", marker.id);
        html += fmt::format(
            "<p>{} markers of {} in {} (numbers {}); their corners fit one plane to {:.2f} px.</p>",
            c.markers.markers.size(), c.markers.dictionary, escaped(c.markers_in), ids, c.marker_residual_px);
    }
    if (c.geometry) {
        const PictureGeometry& g = *c.geometry;
        if (g.lens) html += "<p>The lens's distortion is undone, by its calibration file.</p>";
        html += c.rectified_by.empty() ? "<p>Not rectified.</p>"
                                       : fmt::format("<p>Rectified by the {}.</p>", c.rectified_by);
        if (c.tilt_deg)
            html +=
                fmt::format("<p>The camera looked on the painting's plane from {}° beside its normal.</p>",
                            with_error(*c.tilt_deg, c.tilt_sigma_deg));
        html += fmt::format(
            "<p>The picture is {} × {} pixels{}. {:.1f} % of the photographs lie outside it; {:.1f} % of it "
            "the "
            "photographs do not show.</p>",
            g.width, g.height, g.mm_per_pixel ? fmt::format(", {:.5f} mm each", *g.mm_per_pixel) : "",
            100 * c.photo_outside, 100 * c.picture_outside);
    } else {
        html += "<p>Photographs are taken as they are: neither rectified nor undistorted.</p>";
    }
    return html + "</div></div>";
}

}  // namespace

namespace {

bool is_capture_file(const std::filesystem::path& path) {
    const nlohmann::json root = json_or_discarded(read_text_file(path));
    return root.is_object() && root.contains("format") && root["format"].is_string() &&
           root["format"].get<std::string>().starts_with("tangipaint capture");
}

}  // namespace

std::vector<std::filesystem::path> not_ours(const CalibrationFiles& files) {
    std::vector<std::filesystem::path> others;
    const auto is_there = [](const std::filesystem::path& path) {
        return std::filesystem::is_regular_file(path);
    };
    if (is_there(files.lights) && !(is_there(files.json) && is_lights_file_of(files.lights, files.json)))
        others.push_back(files.lights);
    if (is_there(files.json) && !is_capture_file(files.json)) others.push_back(files.json);
    if (is_there(files.page) && !begins_as_page(read_text_file(files.page), kTitle))
        others.push_back(files.page);
    return others;
}

Image<Rgb> sphere_picture(const FoundSphere& sphere) {
    const Region& region = sphere.crops.region;
    Image<float> most(region.width(), region.height());
    for (std::size_t photo = 0; photo < sphere.crops.photos.size(); ++photo)
        for (int y = 0; y < region.height(); ++y)
            for (int x = 0; x < region.width(); ++x)
                most(x, y) = std::max(
                    most(x, y), sphere.crops.value(photo, sphere.crops.to_photo(
                                                              photo, dvec2(x + region.x0, y + region.y0))));
    Image<Rgb> picture(region.width(), region.height());
    // Strongly lightened: a sphere's outline is dark against a light.
    for (int y = 0; y < region.height(); ++y)
        for (int x = 0; x < region.width(); ++x)
            picture(x, y) = Rgb(std::pow(std::clamp(most(x, y), 0.0f, 1.0f), 0.35f));
    return picture;
}

namespace {

// How many lights there are, by what, and what is known of the camera.
std::string summary_of(const SphereCalibration& c) {
    std::string html =
        fmt::format("<p class=\"soft\">{} · camera: {}{}</p>",
                    c.calibrated() == 0 ? fmt::format("{} photographs, no lights", c.lights.size())
                                        : fmt::format("Lights of {} of {} photographs, from {}",
                                                      c.calibrated(), c.lights.size(),
                                                      c.spheres.empty() ? "the photographs alone" : c.method),
                    c.camera.focal_px ? fmt::format("focal length {:.0f} px", *c.camera.focal_px)
                                      : "taken to be far away",
                    c.drifts.moved ? fmt::format(" · it moved by {:.2f} px rms", c.drifts.rms_px) : "");
    if (c.residual_sigma > 0)
        html += fmt::format(
            "<p class=\"soft\">Highlights lie {:.3f} px (rms) from where the lights should show, {:.1f} "
            "times "
            "what was expected.</p>",
            c.residual_px, c.residual_sigma);
    return html;
}

// Empty where there is nothing to note.
std::string notes_of(const SphereCalibration& c) {
    std::vector<std::string> notes = c.poor;
    notes.insert(notes.end(), c.warnings.begin(), c.warnings.end());
    if (notes.empty()) return {};
    std::string html = "<h2>To note</h2><ul class=\"notes\">";
    for (const std::string& note : notes) html += "<li>" + escaped(note) + "</li>";
    return html + "</ul>";
}

std::string lights_and_spheres(const SphereCalibration& c, const std::vector<std::string>& sphere_urls) {
    if (c.spheres.empty() && c.calibrated() == 0) return {};
    std::string html = fmt::format("<h2>{}</h2>", c.spheres.empty() ? "Lights" : "Lights and spheres");
    html += "<div class=\"row\"><figure class=\"card\">" + hemisphere(shown(c)) +
            "<figcaption>Directions as the camera sees them: the middle is straight above, the rim is the "
            "painting's plane; circles are standard errors. Numbers as in the table.</figcaption></figure>";
    for (std::size_t i = 0; i < c.spheres.size(); ++i) html += sphere_figure(c, i, sphere_urls[i]);
    return html + "</div>";
}

// How to read the table of photographs.
std::string table_notes(const Calibration& calibration) {
    const SphereCalibration& c = calibration.lights;
    std::string html;
    if (const std::optional<ColourCalibration>& colours = calibration.colours)
        html += fmt::format(
            "<p class=\"soft\">Stored as {} ({}). The light on the chart is in units of its "
            "median; its error is the chart's misfit.</p>",
            colours->transfer.name(), colours->transfer_source);
    else if (c.matt_transfer)
        html += fmt::format("<p class=\"soft\">Taken as {}.</p>", c.matt_transfer->name());
    if (c.drifts.moved)
        html +=
            "<p class=\"soft\">Drift is from the first photograph; roll and zoom are around the picture's "
            "centre.</p>";
    return html;
}

}  // namespace

std::string calibration_page(const Calibration& calibration, const std::vector<std::string>& sphere_urls) {
    const SphereCalibration& c = calibration.lights;
    TP_REQUIRE(sphere_urls.size() == c.spheres.size(), "each sphere has a picture");
    std::string html = page_head(kTitle) + summary_of(c) + notes_of(c) + lights_and_spheres(c, sphere_urls) +
                       calibration.section;
    if (calibration.plane) html += plane_section(*calibration.plane);
    if (calibration.colours) html += colour_section(*calibration.colours);
    return html + "<h2>Photographs</h2>" + table_notes(calibration) + table(calibration) +
           "</main></body></html>\n";
}

nlohmann::json to_json(const Calibration& calibration) {
    nlohmann::json capture = to_json(calibration.lights);
    capture["colour"] = nullptr;
    if (calibration.colours) {
        capture["colour"] = to_json(*calibration.colours);
        capture["colour"]["raw_colour"] =
            calibration.raw_colour.empty() ? nlohmann::json(nullptr) : nlohmann::json(calibration.raw_colour);
    }
    for (const char* part : {"scale", "scales", "markers", "geometry"}) capture[part] = nullptr;
    if (calibration.plane) capture.update(to_json(*calibration.plane));
    capture["development"] = calibration.development;
    return capture;
}

CalibrationFiles write_calibration(const std::filesystem::path& out, const Calibration& calibration) {
    CalibrationFiles files = calibration_files(out);
    std::vector<std::string> urls;
    for (const FoundSphere& sphere : calibration.lights.spheres)
        urls.push_back(picture_url(sphere_picture(sphere), out));
    const nlohmann::json capture = to_json(calibration);
    AtomicFile record(files.json), page(files.page);
    record.write(json_lines(capture, 1));
    page.write(calibration_page(calibration, urls));
    const std::vector<Light> usable = calibration.lights.usable_lights();
    std::optional<AtomicFile> lights;
    if (!usable.empty()) lights.emplace(files.lights).write(lights_text(usable));
    OutputSet set;
    set.add(record);
    set.add(page);
    if (lights)
        set.add(*lights);
    else
        set.withdraw(files.lights.parent_path(),
                     files.lights.filename());  // those of a former run are not of this capture file
    set.commit();
    return files;
}

}  // namespace tangi
