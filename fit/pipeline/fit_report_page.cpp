#include "fit/pipeline/fit_report_page.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "surface/base/html_escape.h"
#include "surface/report/false_colour.h"
#include "surface/report/html_report.h"

namespace tangi {

namespace {

constexpr double kMisfitRange = 0.3;  // [1] ln(measured / predicted) at both ends of the maps' colours
constexpr int kMisfitSize = 110, kMapSize = 320;  // [pixels] of the maps' longer sides

std::string figure(const Image<Rgb>& picture, const std::string& caption,
                   const std::filesystem::path& scratch) {
    return fmt::format(
        "<figure class=\"card\"><img src=\"{}\" width=\"{}\" alt=\"\"><figcaption>{}</figcaption></figure>",
        picture_url(picture, scratch), picture.width(), caption);
}

// Light by stored value, 0..1 both ways.
std::string transfer_plot(const Transfer& transfer) {
    constexpr double size = 180;
    std::string points;
    for (int i = 0; i <= 60; ++i) {
        const double stored = i / 60.0;
        points += fmt::format("{:.1f},{:.1f} ", 10 + size * stored,
                              10 + size * (1 - transfer.decode(static_cast<float>(stored))));
    }
    return fmt::format(
        "<svg width=\"200\" height=\"215\" role=\"img\" aria-label=\"light by stored value\"><rect x=\"10\" "
        "y=\"10\" "
        "width=\"{0}\" height=\"{0}\" fill=\"none\" stroke=\"var(--line)\"/><polyline fill=\"none\" "
        "stroke=\"var(--accent)\" stroke-width=\"2\" points=\"{1}\"/><text x=\"100\" y=\"207\" "
        "text-anchor=\"middle\">stored value → light</text></svg>",
        size, points);
}

std::string transfer_section(const TransferEstimate& transfer) {
    std::string html = fmt::format(
        "<h2>Transfer curve</h2><div class=\"row\"><div class=\"card\">{}</div><div class=\"card\"><p>Stored "
        "as <b>{}</b> "
        "({}).</p>",
        transfer_plot(transfer.transfer), escaped(transfer.transfer.name()), escaped(transfer.source));
    if (!transfer.candidates.empty()) {
        html +=
            "<table><tr><th>tried</th><th>median misfit, codes of 8 bits</th><th>probability</th><th>slopes "
            "change by</th></tr>";
        for (const TransferEstimate::Candidate& c : transfer.candidates)
            html += fmt::format("<tr><td>{}</td><td>{:.2f}</td><td>{:.1f} %</td><td>{:.1f}°</td></tr>",
                                escaped(c.transfer.name()), 255 * c.residual, 100 * c.probability,
                                c.slopes_change_deg);
        html += "</table>";
    }
    return html + "</div></div>";
}

std::string distance(const std::optional<float>& mm, double relative, const Surface& surface) {
    if (!mm) return "too far away to tell";
    const double widths = *mm / (std::max(surface.width(), surface.height()) * surface.mm_per_pixel);
    const std::string in_widths =
        (relative > 0 ? with_error(widths, widths * relative) : fmt::format("{:.2f}", widths)) +
        " picture widths";
    return surface.scale_known ? fmt::format("{:.0f} mm, {}", *mm, in_widths) : in_widths;
}

std::string surface_above(const Rig& rig, double sigma_mm, const Surface& surface) {
    if (!rig.light_distance_mm || !(sigma_mm > 0)) return "as given";
    const double width_mm = std::max(surface.width(), surface.height()) * surface.mm_per_pixel;
    const std::string in_widths =
        with_error(rig.surface_above_mm / width_mm, sigma_mm / width_mm) + " picture widths";
    return surface.scale_known ? fmt::format("{:.2f} mm, {}", rig.surface_above_mm, in_widths) : in_widths;
}

std::string light_angular_radius(const FitResult& fit) {
    const LightAngularRadius& found = fit.report.light_angular_radius;
    const float deg = fit.surface.photography.rig.light_radius_deg;
    if (found.tried.empty()) return fmt::format("{:.2g}°, given or not looked for", deg);
    if (deg == Rig::kPointLight_deg) return fmt::format("{:.2g}°: no shadows tell another", deg);
    return fmt::format("{:.1f}°, by the softness of shadows", deg);
}

std::string rig_section(const FitResult& fit) {
    const LightCalibration& lights = fit.report.lights;
    const Rig& rig = lights.lighting.rig;
    std::string html = fmt::format("<div class=\"card\"><p>What is used of the lights: <b>{}</b>.</p>",
                                   name_of(lights.model));
    if (lights.trials.empty())
        html +=
            "<p>Nothing else was tried: too few photographs, or the lights were to be taken as given.</p>";
    else {
        html += "<table><tr><th>tried</th><th>validation photographs, dB</th></tr>";
        for (const LightCalibration::Trial& trial : lights.trials)
            html +=
                fmt::format("<tr><td>{}</td><td>{:.2f}</td></tr>", name_of(trial.model), trial.cv_psnr_db);
        html += "</table>";
        if (lights.model.directions == DirectionFreedom::measured)
            html +=
                "<p>Directions that mirror or diffuse spheres measured are corrected within their standard "
                "errors, "
                "whatever validation photographs say: the light that is left out has no part in that.</p>";
    }
    html += fmt::format(
        "<table><tr><td>light from all around</td><td>{}</td></tr><tr><td>distance of the "
        "lights</td><td>{}</td></tr><tr><td>height of the surface above the point that their directions are "
        "from</td><td>{}</td></tr><tr>"
        "<td>distance of the camera</td><td>{}</td></tr><tr><td>angular radius of the "
        "lights</td><td>{}</td></tr><tr><td>tilt of the "
        "support</td><td>{:.1f}°</td></tr><tr><td>its bulge, middle to "
        "corners</td><td>{:.1f}°</td></tr></table></div>",
        lights.rig_sigma.ambient > 0 ? with_error(rig.ambient, lights.rig_sigma.ambient)
                                     : fmt::format("{:.3f}", rig.ambient),
        distance(rig.light_distance_mm, lights.rig_sigma.light_distance, fit.surface),
        surface_above(rig, lights.rig_sigma.surface_above_mm, fit.surface),
        distance(rig.camera_distance_mm, lights.rig_sigma.camera_distance, fit.surface),
        light_angular_radius(fit), fit.report.support_tilt_deg, fit.report.support_bulge_deg);
    return html;
}

std::string height_note(const HeightChoice& choice) {
    if (choice.trials.empty()) return {};
    if (choice.before_refining)
        return fmt::format(
            "<p class=\"soft\">The height is the one of {} whose cast shadows agree best with the "
            "photographs: that of slopes before shadows were taken for shadows, which leads up to cliffs "
            "that no slope shows.</p>",
            choice.trials.size());
    return fmt::format(
        "<p class=\"soft\">The height is the one of {} whose cast shadows agree best with the photographs: "
        "{} "
        "cliffs, {}.</p>",
        choice.trials.size(), choice.cliffs ? "with" : "without",
        choice.mixing > 0 ? fmt::format("slopes made steeper by what pixels mix ({:g})", choice.mixing)
                          : "slopes as they are");
}

// Where lights were listed, by name, of those that turned.
std::map<std::string, Vec3> listed_directions(const Photography& photography) {
    std::map<std::string, Vec3> listed;
    for (const Photography::Photo& photo : photography.photos)
        if (photo.fitted && photo.listed_direction) listed[photo.light.name] = *photo.listed_direction;
    return listed;
}

std::string drift_cells(const PhotoDrift* drift) {
    if (!drift) return "<td colspan=\"2\">–</td>";
    if (!drift->registered) return "<td class=\"why\" colspan=\"2\">nothing of it was found again</td>";
    return fmt::format("<td>{}</td><td>{}</td>", with_error(drift->drift_px, drift->error_px),
                       drift->warped ? "undone" : "left");
}

// The photograph's red and blue against those of most.
std::string white_cells(const WhiteBalance& white) {
    const glm::dvec2 gain = glm::exp(white.log_gain);
    return fmt::format("<td>{}</td><td>{}</td><td>{}</td>", with_error(gain.x, gain.x * white.sigma.x),
                       with_error(gain.y, gain.y * white.sigma.y),
                       white.differs   ? "undone"
                       : white.unclear ? "left"
                                       : "");
}

// One line a photograph that was fitted.
std::string table(const FitResult& fit) {
    const LightCalibration& c = fit.report.lights;
    const bool gains = !c.gain_sigma.empty() || c.light_model.has_value(), turns = !c.turns.empty();
    const bool drifts = !fit.report.registration.photos.empty();
    std::map<std::string, const PhotoDrift*> drift_of;
    for (const PhotoDrift& drift : fit.report.registration.photos) drift_of[drift.name] = &drift;
    std::string html =
        "<div class=\"wide\"><table><tr><th>photograph</th><th>azimuth °</th><th>elevation °</th>";
    if (turns) html += "<th>turned °</th>";
    if (gains) html += "<th>strength</th>";
    const WhiteBalances& balances = fit.report.white_balances;
    const bool whites = balances.differing() + balances.unclear() > 0;
    if (whites) html += "<th>red</th><th>blue</th><th></th>";
    if (!c.unevenness.empty()) html += "<th>uneven %</th>";
    if (drifts) html += "<th>drift px</th><th></th>";
    html += "<th>misfit, typical %</th><th>as a whole %</th></tr>";
    for (std::size_t i = 0; i < c.lighting.lights.size(); ++i) {
        const Light& light = c.lighting.lights[i];
        const double degrees = 180 / std::numbers::pi;
        html += fmt::format("<tr><td>{}&ensp;{}</td><td>{:.1f}</td><td>{:.1f}</td>", i + 1,
                            escaped(light.name), std::atan2(light.direction.y, light.direction.x) * degrees,
                            std::asin(std::clamp(light.direction.z, -1.0f, 1.0f)) * degrees);
        if (turns)
            html += fmt::format("<td>{}</td>", with_error(c.turns[i].changed_deg, c.turns[i].sigma_deg));
        if (gains)
            html +=
                fmt::format("<td>{}</td>", c.gain_sigma.empty()
                                               ? fmt::format("{:.3f}", light.gain.g)
                                               : with_error(light.gain.g, light.gain.g * c.gain_sigma[i]));
        if (whites) html += white_cells(balances.photos[i]);
        if (!c.unevenness.empty())
            html += fmt::format("<td>{}</td>",
                                with_error(100 * c.unevenness[i].rms, 100 * c.unevenness[i].sigma));
        if (drifts) {
            const auto found = drift_of.find(light.name);
            html += drift_cells(found == drift_of.end() ? nullptr : found->second);
        }
        const LightMisfit::Typical misfit =
            i < fit.report.misfit.log_ratios.size() ? fit.report.misfit.typical(i) : LightMisfit::Typical{};
        html += fmt::format("<td>{:.1f}</td><td>{:+.1f}</td></tr>", 100 * std::expm1(misfit.scatter),
                            100 * std::expm1(misfit.offset));
    }
    return html + "</table></div>";
}

std::string misfit_section(const FitResult& fit, const std::filesystem::path& scratch) {
    const LightMisfit& misfit = fit.report.misfit;
    std::string html = fmt::format(
        "<h2>Misfit</h2><p class=\"soft\">Measured against predicted light in {} places, the nearest of "
        "which each pixel "
        "shows: red is brighter than predicted, blue darker, {:.0f} % or more at the ends; grey is clipped "
        "or in the dark. "
        "Patches that go with the relief are shadows or gloss; slopes across the picture are lights that are "
        "nearer than "
        "thought.</p><div class=\"row\">",
        misfit.places.size(), 100 * std::expm1(kMisfitRange));
    for (std::size_t i = 0; i < misfit.log_ratios.size(); ++i)
        html += figure(
            map_picture(misfit.map(i, kMisfitSize), -kMisfitRange, kMisfitRange, ColourMap::diverging),
            fmt::format("{}&ensp;{}", i + 1, escaped(fit.report.lights.lighting.lights[i].name)), scratch);
    return html + "</div>";
}

std::string size_note(const FitResult& fit) {
    const FitReport& report = fit.report;
    return fmt::format(
        "<p class=\"soft\">{} × {} pixels{}, {} photographs; {:.1f} % of the pixels measured, median "
        "confidence {:.2f}.</p>",
        fit.surface.width(), fit.surface.height(),
        fit.surface.scale_known ? fmt::format(", {:.4g} mm each", fit.surface.mm_per_pixel)
                                : ", scale not known",
        report.lights.lighting.lights.size(),
        100 * static_cast<double>(report.fitted) / static_cast<double>(std::max(report.pixels, 1L)),
        report.median_confidence);
}

// Empty where there is nothing to note.
std::string warnings_section(const FitReport& report) {
    if (report.warnings.empty()) return {};
    std::string html = "<h2>To note</h2><ul class=\"notes\">";
    for (const std::string& warning : report.warnings) html += "<li>" + escaped(warning) + "</li>";
    return html + "</ul>";
}

std::string maps_section(const Surface& surface, const std::filesystem::path& scratch) {
    std::string html = "<h2>Maps</h2><div class=\"row\">";
    for (const MapPicture& map : map_pictures(surface, kMapSize))
        html +=
            figure(map.picture,
                   fmt::format("<b>{}</b>{}{}: {}", escaped(map.title),
                               map.symbol.empty() ? "" : " " + escaped(map.symbol),
                               map.range ? fmt::format(", {:.3g} to {:.3g}{}", map.range->lo, map.range->hi,
                                                       map.unit == "1" ? "" : " " + map.unit)
                                         : "",
                               escaped(map.meaning)),
                   scratch);
    return html + "</div>";
}

std::string lights_section(const FitResult& fit) {
    const LightCalibration& c = fit.report.lights;
    const std::map<std::string, Vec3> listed = listed_directions(fit.surface.photography);
    std::vector<HemisphereLight> shown;
    for (std::size_t i = 0; i < c.lighting.lights.size(); ++i) {
        const Light& light = c.lighting.lights[i];
        HemisphereLight& on =
            shown.emplace_back(HemisphereLight{light.name, glm::dvec3(light.direction), 0, {}});
        if (i < c.turns.size()) on.sigma_deg = c.turns[i].sigma_deg;
        if (const auto was = listed.find(light.name); was != listed.end())
            on.listed = glm::dvec3(was->second);
    }
    return "<h2>Lights</h2><div class=\"row\"><figure class=\"card\">" + hemisphere(shown) +
           "<figcaption>Directions as the camera sees them: the middle is straight above, the rim is the "
           "painting's "
           "plane. Lines lead from where a light was listed to where it is taken to be. Numbers as in the "
           "table."
           "</figcaption></figure>" +
           rig_section(fit) + "</div>";
}

std::string photographs_section(const FitResult& fit) {
    return "<h2>Photographs</h2><p class=\"soft\">Errors are standard errors (68 %). Strengths are relative "
           "to their median. Misfit is that of measured against predicted light.</p>" +
           table(fit);
}

}  // namespace

std::string fit_page(const FitResult& fit, const std::string& title, const std::filesystem::path& scratch) {
    const FitReport& report = fit.report;
    std::string html = page_head(title) + size_note(fit) + warnings_section(report) +
                       maps_section(fit.surface, scratch) + height_note(report.height_choice) +
                       lights_section(fit) + transfer_section(report.transfer) + photographs_section(fit);
    if (!report.misfit.log_ratios.empty()) html += misfit_section(fit, scratch);
    return html + "</main></body></html>\n";
}

}  // namespace tangi
